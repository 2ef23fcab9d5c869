//! Drawing in points on a plotters area, with one check at the end and not one at each stroke.

use super::font::{CAP_HEIGHT_EM, FAMILY, Face, LINE_EM};
use super::page::{Head, Page, UNITS_PER_POINT, points_from_mm, script_size};
use super::style;
use super::theme::{INK, Marker, PAPER, stroke};
use crate::error::ReportError;
use crate::markup::{self, Level};
use plotters::coord::Shift;
use plotters::prelude::{
    Circle, DrawingArea, IntoDrawingArea, IntoFont, PathElement, Polygon, RGBColor, Rectangle,
};
use plotters::style::{
    Color, FontStyle, FontTransform, ShapeStyle, TextStyle, register_font,
    text_anchor::{HPos, Pos, VPos},
};

/// Draws one figure: opens the page, lets `paint` draw, closes it.
pub(crate) fn sketch(
    head: &Head,
    paint: impl FnOnce(&mut Canvas<'_>),
) -> Result<Sketch, ReportError> {
    let failed = |reason: String| ReportError::Drawing { figure: head.name.clone(), reason };
    for face in Face::ALL {
        register_font(FAMILY, font_style(face), face.ttf())
            .map_err(|_| failed(format!("the bundled font {face:?} cannot be used")))?;
    }
    let mut svg = String::new();
    let unknown_signs;
    {
        let area = Page::new(&mut svg, head).into_drawing_area();
        let (width_mm, height_mm) = head.size_mm;
        let mut canvas = Canvas {
            area,
            width: points_from_mm(width_mm),
            height: points_from_mm(height_mm),
            fault: None,
            unknown_signs: false,
            letter: None,
        };
        paint(&mut canvas);
        if let Some(reason) = canvas.fault {
            return Err(failed(reason));
        }
        canvas.area.present().map_err(|error| failed(error.to_string()))?;
        unknown_signs = canvas.unknown_signs;
    }
    Ok(Sketch { svg, unknown_signs })
}

/// A finished drawing.
#[derive(Debug)]
pub(crate) struct Sketch {
    pub(crate) svg: String,
    /// A text held a sign that the font lacks: a question mark stands for it.
    pub(crate) unknown_signs: bool,
}

/// A surface in points, x to the right, y down.
pub(crate) struct Canvas<'a> {
    area: DrawingArea<Page<'a>, Shift>,
    pub(crate) width: f64,
    pub(crate) height: f64,
    fault: Option<String>,
    unknown_signs: bool,
    /// The letter of the panel that is drawn next: whoever writes its title takes it.
    pub(crate) letter: Option<char>,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pen {
    colour: RGBColor,
    width: f64,
    alpha: f64,
    dash: Option<(f64, f64)>,
}

impl Pen {
    pub(crate) fn new(colour: RGBColor, width: f64) -> Self {
        Self { colour, width, alpha: 1.0, dash: None }
    }

    pub(crate) fn alpha(self, alpha: f64) -> Self {
        Self { alpha, ..self }
    }

    /// Drawn and skipped lengths, in points.
    pub(crate) fn dashed(self, on: f64, off: f64) -> Self {
        Self { dash: Some((on, off)), ..self }
    }

    fn style(self) -> ShapeStyle {
        ShapeStyle {
            color: self.colour.mix(self.alpha),
            filled: false,
            stroke_width: (self.width * UNITS_PER_POINT).round() as u32,
        }
    }
}

/// How a text is set.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    size: f64,
    face: Face,
    colour: RGBColor,
    h: HPos,
    v: VPos,
    turned: bool,
}

impl Look {
    /// Regular ink of a size in points, standing on its point, from the left.
    pub(crate) fn new(size: f64) -> Self {
        Self {
            size,
            face: Face::Regular,
            colour: INK,
            h: HPos::Left,
            v: VPos::Bottom,
            turned: false,
        }
    }

    pub(crate) fn semibold(mut self) -> Self {
        self.face = Face::Semibold;
        self
    }

    pub(crate) fn colour(self, colour: RGBColor) -> Self {
        Self { colour, ..self }
    }

    /// Centred on the point from left to right.
    pub(crate) fn middle(mut self) -> Self {
        self.h = HPos::Center;
        self
    }

    /// Ending at the point.
    pub(crate) fn end(mut self) -> Self {
        self.h = HPos::Right;
        self
    }

    /// Centred on the point from top to bottom.
    pub(crate) fn centred(mut self) -> Self {
        self.v = VPos::Center;
        self
    }

    /// Hanging from the point.
    pub(crate) fn hanging(mut self) -> Self {
        self.v = VPos::Top;
        self
    }

    /// Reading upwards.
    pub(crate) fn turned(mut self) -> Self {
        self.turned = true;
        self
    }

    fn lacks(self, run: &markup::Run) -> bool {
        let face = if run.italic { Face::Italic } else { self.face };
        run.text.chars().any(|sign| !face.has(sign))
    }

    /// Width in points, of several lines that of the widest.
    pub(crate) fn width(self, text: &str) -> f64 {
        let run_width = |run: &markup::Run| {
            let face = if run.italic { Face::Italic } else { self.face };
            let size = if run.level == Level::Line { self.size } else { script_size(self.size) };
            face.width_em(&run.text) * size
        };
        let line_width = |line: &str| markup::runs(line).iter().map(run_width).sum::<f64>();
        text.lines().map(line_width).fold(0.0, f64::max)
    }

    /// Width of the widest of several texts, in points.
    pub(crate) fn widest(self, texts: &[impl AsRef<str>]) -> f64 {
        let widths = texts.iter().map(|text| self.width(text.as_ref()));
        widths.fold(0.0, f64::max)
    }
}

/// A face as plotters names it.
fn font_style(face: Face) -> FontStyle {
    match face {
        Face::Regular => FontStyle::Normal,
        Face::Italic => FontStyle::Italic,
        Face::Semibold => FontStyle::Bold,
    }
}

/// Height of capitals at a size, in points.
pub(crate) fn cap_height(size: f64) -> f64 {
    CAP_HEIGHT_EM * size
}

type Point = (f64, f64);

impl Canvas<'_> {
    fn unit(&mut self, value: f64) -> i32 {
        let units = (value * UNITS_PER_POINT).round();
        if units.is_finite() && units.abs() < 1e7 {
            return units as i32;
        }
        self.fault.get_or_insert_with(|| format!("a coordinate came out as {value} pt"));
        0
    }

    fn at(&mut self, (x, y): Point) -> (i32, i32) {
        (self.unit(x), self.unit(y))
    }

    fn all(&mut self, points: &[Point]) -> Vec<(i32, i32)> {
        points.iter().map(|&point| self.at(point)).collect()
    }

    fn note<E: std::fmt::Display>(&mut self, drawn: Result<(), E>) {
        if let Err(error) = drawn {
            self.fault.get_or_insert_with(|| error.to_string());
        }
    }

    /// A line through points.
    pub(crate) fn path(&mut self, points: &[Point], pen: Pen) {
        if points.len() < 2 {
            return;
        }
        if let Some((on, off)) = pen.dash {
            for piece in dashes(points, on, off) {
                self.path(&piece, Pen { dash: None, ..pen });
            }
            return;
        }
        let points = self.all(points);
        let drawn = self.area.draw(&PathElement::new(points, pen.style()));
        self.note(drawn);
    }

    /// A straight line.
    pub(crate) fn line(&mut self, from: Point, to: Point, pen: Pen) {
        self.path(&[from, to], pen);
    }

    /// A filled area.
    pub(crate) fn polygon(&mut self, corners: &[Point], colour: RGBColor, alpha: f64) {
        let corners = self.all(corners);
        let shape = Polygon::new(corners, filled(colour, alpha));
        let drawn = self.area.draw(&shape);
        self.note(drawn);
    }

    /// A filled rectangle between two corners.
    pub(crate) fn fill_rect(&mut self, a: Point, b: Point, colour: RGBColor, alpha: f64) {
        let corners = [self.at(a), self.at(b)];
        let shape = Rectangle::new(corners, filled(colour, alpha));
        let drawn = self.area.draw(&shape);
        self.note(drawn);
    }

    /// The outline of a rectangle.
    pub(crate) fn rect(&mut self, a: Point, b: Point, pen: Pen) {
        let corners = [self.at(a), self.at(b)];
        let drawn = self.area.draw(&Rectangle::new(corners, pen.style()));
        self.note(drawn);
    }

    /// A filled circle.
    pub(crate) fn disc(&mut self, centre: Point, radius: f64, colour: RGBColor, alpha: f64) {
        let (centre, radius) = (self.at(centre), self.unit(radius));
        let shape = Circle::new(centre, radius, filled(colour, alpha));
        let drawn = self.area.draw(&shape);
        self.note(drawn);
    }

    /// A line through one point: a dot.
    pub(crate) fn dot(&mut self, at: Point, pen: Pen) {
        self.disc(at, (0.8 * pen.width).max(0.6), pen.colour, pen.alpha);
    }

    /// The outline of a circle.
    pub(crate) fn ring(&mut self, centre: Point, radius: f64, pen: Pen) {
        let (centre, radius) = (self.at(centre), self.unit(radius));
        let drawn = self.area.draw(&Circle::new(centre, radius, pen.style()));
        self.note(drawn);
    }

    /// A marker with a white rim, of about the area of a circle of this radius.
    pub(crate) fn marker(&mut self, centre: Point, radius: f64, shape: Marker, colour: RGBColor) {
        let rim = Pen::new(PAPER, stroke::THIN);
        let (x, y) = centre;
        if shape == Marker::Circle {
            self.disc(centre, radius, colour, 1.0);
            self.ring(centre, radius, rim);
            return;
        }
        let corner = |(degrees, far): (f64, f64)| {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            (x + radius * far * cos, y + radius * far * sin)
        };
        let corners: Vec<Point> = shape.corners().into_iter().map(corner).collect();
        self.polygon(&corners, colour, 1.0);
        let mut outline = corners;
        outline.push(outline[0]);
        self.path(&outline, rim);
    }

    /// A line that ends in an arrow's head.
    pub(crate) fn arrow(&mut self, from: Point, to: Point, pen: Pen, head: f64) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = libm::hypot(dx, dy);
        if length <= f64::EPSILON {
            return;
        }
        let (ux, uy) = (dx / length, dy / length);
        let neck = (to.0 - 0.8 * head * ux, to.1 - 0.8 * head * uy);
        self.path(&[from, neck], pen);
        let base = (to.0 - head * ux, to.1 - head * uy);
        let (nx, ny) = (-uy * head * 0.38, ux * head * 0.38);
        let corners = [to, (base.0 + nx, base.1 + ny), (base.0 - nx, base.1 - ny)];
        self.polygon(&corners, pen.colour, pen.alpha);
    }

    /// A text with marks (see [`crate::markup`]).
    pub(crate) fn text(&mut self, text: &str, at: Point, look: Look) {
        let other = style::current().and_then(|style| style.label(text));
        let text = other.unwrap_or(text);
        self.unknown_signs |= markup::runs(text).iter().any(|run| look.lacks(run));
        let point = self.at(at);
        let em = look.size * UNITS_PER_POINT * LINE_EM;
        let turn = if look.turned { FontTransform::Rotate270 } else { FontTransform::None };
        let font = (FAMILY, em, font_style(look.face)).into_font();
        let style =
            TextStyle::from(font.transform(turn)).color(&look.colour).pos(Pos::new(look.h, look.v));
        let drawn = self.area.draw_text(text, &style, point);
        self.note(drawn);
    }
}

/// An area without a line around it.
fn filled(colour: RGBColor, alpha: f64) -> ShapeStyle {
    ShapeStyle { color: colour.mix(alpha), filled: true, stroke_width: 0 }
}

fn dashes(points: &[Point], on: f64, off: f64) -> Vec<Vec<Point>> {
    let mut pieces = Vec::new();
    let (mut drawing, mut left) = (true, on);
    let mut piece = vec![points[0]];
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        let mut length = libm::hypot(to.0 - from.0, to.1 - from.1);
        while length > left {
            let share = left / length;
            from = (from.0 + (to.0 - from.0) * share, from.1 + (to.1 - from.1) * share);
            length -= left;
            if drawing {
                piece.push(from);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![from];
            }
            drawing = !drawing;
            left = if drawing { on } else { off };
        }
        left -= length;
        if drawing {
            piece.push(to);
        }
    }
    if drawing && piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_keep_their_lengths_round_a_corner() {
        let pieces = dashes(&[(0.0, 0.0), (3.0, 0.0), (3.0, 5.0)], 2.0, 2.0);
        let expected = vec![vec![(0.0, 0.0), (2.0, 0.0)], vec![(3.0, 1.0), (3.0, 3.0)]];
        assert_eq!(pieces, expected);
    }

    #[test]
    fn a_coordinate_that_is_not_finite_is_an_error_and_not_a_picture() {
        let drawn = sketch(&Head::square(10.0), |canvas| {
            canvas.line((0.0, 0.0), (f64::NAN, 1.0), Pen::new(INK, 1.0));
        });
        assert!(matches!(drawn, Err(ReportError::Drawing { .. })));
    }
}
