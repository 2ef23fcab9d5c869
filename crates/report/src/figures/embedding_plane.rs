//! The plane of the style gradient and of the direction across it in which drivers differ most.

use super::crowd::{self, MOST_POINTS};
use super::embedding_drives::{
    EmbeddingPoint, EmbeddingSpace, ExampleConditions, Palette, dot, norm, paint_condition,
    paint_point,
};
use super::prelude::*;

/// The unit direction across `unit` in which the points vary most, sign fixed by its largest part.
fn first_perpendicular(input: &EmbeddingSpace, unit: &[f64]) -> Vec<f64> {
    let d = unit.len();
    let mean = input.centre();
    let across = |point: &EmbeddingPoint| -> Vec<f64> {
        let pairs = point.embedding.iter().zip(&mean);
        let centred: Vec<f64> = pairs.map(|(w, m)| w - m).collect();
        let along = dot(&centred, unit);
        centred.iter().zip(unit).map(|(c, u)| c - along * u).collect()
    };
    let across: Vec<Vec<f64>> = input.points.iter().map(across).collect();
    let spread = |v: &[f64]| across.iter().map(|row| dot(row, v).powi(2)).sum::<f64>();
    let mut best = vec![0.0; d];
    // Power iteration from every axis: a start across the answer would never find it.
    for start in 0..d {
        let mut direction = vec![0.0; d];
        direction[start] = 1.0;
        let mut variance = 0.0;
        for _ in 0..200 {
            let mut next = vec![0.0; d];
            for row in &across {
                let weight = dot(row, &direction);
                for (cell, value) in next.iter_mut().zip(row) {
                    *cell += weight * value;
                }
            }
            variance = norm(&next);
            if variance < 1e-12 {
                break;
            }
            direction = next.iter().map(|x| x / variance).collect();
        }
        if variance >= 1e-12 && spread(&direction) > spread(&best) * (1.0 + 1e-9) {
            best = direction;
        }
    }
    let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    let sign = if best.iter().copied().fold(0.0, larger) < 0.0 { -1.0 } else { 1.0 };
    best.iter().map(|x| sign * x).collect()
}

/// Draws the plane of the gradient and of the axis across it, level with the solid drawing beside it if there is one.
pub(crate) fn paint(
    canvas: &mut Canvas<'_>,
    place: Place,
    input: &EmbeddingSpace,
    palette: Palette,
    context: &Context,
) {
    let unit = input.unit();
    let across = first_perpendicular(input, &unit);
    let projected = |w: &[f64]| (dot(w, &unit), dot(w, &across));
    let places: Vec<(f64, f64)> = input.everything().map(projected).collect();
    let x = Scale::over(places.iter().map(|place| place.0), 5);
    let y = Scale::over(places.iter().map(|place| place.1), 5);
    let labels =
        Labels { x: "Position on the style line", y: "First axis across it", ..Labels::default() };
    // Level with the box beside it.
    let (down, up) = if input.gradient.len() == 3 { (6.0, 4.0) } else { (0.0, 0.0) };
    let place = Place { top: place.top + down, bottom: place.bottom - up, ..place };
    let mut panel = Panel::open(canvas, place, &labels, (x, y));
    let drives = &places[..input.points.len()];
    let middle = drives.iter().map(|place| place.1).sum::<f64>() / drives.len() as f64;
    let (Place { left, right, .. }, y) = (panel.frame.place, panel.frame.y.at(middle));
    panel.canvas.arrow((left, y), (right, y), Pen::new(INK, 1.2), 6.0);
    if let Some(ExampleConditions { ellipse, .. }) = &input.example {
        let ring = ellipse.iter().chain(ellipse.first()).map(|w| projected(w));
        panel.line(ring, Pen::new(GREEN, stroke::STRONG));
    }
    let Panel { canvas, frame } = panel;
    if drives.len() <= MOST_POINTS {
        for (point, &(x, y)) in input.points.iter().zip(drives) {
            paint_point(canvas, frame.at(x, y), point, palette, input.score_range);
        }
    } else {
        let velocities = input.points.iter().map(|point| point.mean_velocity_mps);
        let drives = drives.iter().zip(velocities).map(|(&(x, y), v)| (x, y, v));
        crowd::paint_density(canvas, &frame, drives, |mps| palette.colour(mps));
    }
    for (condition, w) in input.example.iter().flat_map(|e| &e.conditions) {
        let (x, y) = projected(w);
        paint_condition(canvas, frame.at(x, y), &context.look(*condition));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_axis_is_across_the_gradient() {
        let point = |seed: usize| EmbeddingPoint {
            embedding: (0..5).map(|axis| ((seed * 13 + axis * 7) % 17) as f64).collect(),
            score_points: 20.0,
            mean_velocity_mps: 28.0,
        };
        let input = EmbeddingSpace {
            points: (0..20).map(point).collect(),
            gradient: vec![1.0; 5],
            score_range: (11.0, 55.0),
            score: "score".into(),
            example: None,
        };
        let unit = input.unit();
        let across = first_perpendicular(&input, &unit);
        assert!(dot(&across, &unit).abs() < 1e-9);
        assert!((norm(&across) - 1.0).abs() < 1e-9);
    }
}
