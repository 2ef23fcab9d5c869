//! A car from above.

use super::canvas::{Canvas, Pen};
use super::theme::{INK, LANE_LINE, PAPER, stroke};
use plotters::style::RGBColor;

/// Draws a car of a length and width in points; `turn` is in radians, counter-clockwise on the
/// page. It drives to the right.
pub(crate) fn paint_vehicle(
    canvas: &mut Canvas<'_>,
    centre: (f64, f64),
    (length, width): (f64, f64),
    turn: f64,
    colour: RGBColor,
) {
    let (sin, cos) = libm::sincos(turn);
    let place = |along: f64, across: f64| {
        let (x, y) = (along * length, across * width);
        (centre.0 + x * cos - y * sin, centre.1 - x * sin - y * cos)
    };
    let body = [
        (-0.5, -0.38),
        (-0.46, -0.5),
        (0.36, -0.5),
        (0.47, -0.4),
        (0.5, -0.2),
        (0.5, 0.2),
        (0.47, 0.4),
        (0.36, 0.5),
        (-0.46, 0.5),
        (-0.5, 0.38),
    ]
    .map(|(along, across)| place(along, across));
    canvas.polygon(&body, colour, 1.0);
    let mut outline = body.to_vec();
    outline.push(body[0]);
    canvas.path(&outline, Pen::new(INK, stroke::AXIS));
    let front = [(0.1, -0.34), (0.24, -0.4), (0.24, 0.4), (0.1, 0.34)].map(|(a, c)| place(a, c));
    let back =
        [(-0.3, -0.36), (-0.22, -0.32), (-0.22, 0.32), (-0.3, 0.36)].map(|(a, c)| place(a, c));
    let glass = if colour == PAPER { LANE_LINE } else { PAPER };
    canvas.polygon(&front, glass, 0.8);
    canvas.polygon(&back, glass, 0.8);
}
