//! A plotters backend that writes SVG for print: hundredths of a point, real text, nothing rounded
//! to whole pixels.
//!
//! The stock SVG backend rounds to pixels, cannot lower or slant a part of a text and has no title;
//! the stock bitmap backend does not smooth wide strokes.

use super::font::{CAP_HEIGHT_EM, FAMILY, Face, LINE_EM};
use super::theme::size;
use super::thin::straightened;
use crate::markup::{self, Level};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontStyle, FontTransform,
    text_anchor::{HPos, VPos},
};
use std::{convert::Infallible, fmt::Write as _};

/// Units of a [`Page`] in one point.
pub(crate) const UNITS_PER_POINT: f64 = 100.0;

const MM_PER_INCH: f64 = 25.4;
const POINTS_PER_INCH: f64 = 72.0;

/// Points in a length in millimetres.
pub(crate) fn points_from_mm(mm: f64) -> f64 {
    mm / MM_PER_INCH * POINTS_PER_INCH
}

/// What an SVG says about itself.
#[derive(Debug, Clone)]
pub(crate) struct Head {
    /// Prefix of every `id` in the file.
    pub(crate) name: String,
    /// Width and height on paper, in millimetres.
    pub(crate) shown_mm: (f64, f64),
    /// Width and height of the drawing, in millimetres, which is enlarged to that.
    pub(crate) size_mm: (f64, f64),
    /// `<title>`, plain text.
    pub(crate) title: String,
    /// `<desc>`: the finding in words.
    pub(crate) description: String,
    /// What stands in `<metadata>`, plain text: whether it is synthetic, and the seed.
    pub(crate) metadata: String,
}

/// The backend: draws into a string, closed by [`DrawingBackend::present`].
#[derive(Debug)]
pub(crate) struct Page<'a> {
    out: &'a mut String,
    units: (u32, u32),
    /// The polygon that was drawn last, and where its element ends.
    polygon: Option<(Vec<BackendCoord>, usize)>,
}

/// How an element ends.
const END: &str = "/>\n";
/// How far a drawn line may lie beside a point of its path, in hundredths of a point: a twentieth of the thinnest line.
const NOT_SEEN: f64 = 2.0;

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl<'a> Page<'a> {
    /// Opens an SVG with a white ground.
    pub(crate) fn new(out: &'a mut String, head: &Head) -> Self {
        let (width_mm, height_mm) = head.size_mm;
        let width = points_from_mm(width_mm) * UNITS_PER_POINT;
        let height = points_from_mm(height_mm) * UNITS_PER_POINT;
        let units = (width.round() as u32, height.round() as u32);
        let (width_mm, height_mm) = head.shown_mm;
        let (w, h) = (Hundredths(units.0.cast_signed()), Hundredths(units.1.cast_signed()));
        let name = markup::escape(&head.name);
        let _ = write!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width_mm}mm\" \
             height=\"{height_mm}mm\" viewBox=\"0 0 {w} {h}\" role=\"img\" \
             aria-labelledby=\"{name}-title {name}-desc\" \
             stroke-linejoin=\"round\" font-family=\"'{FAMILY}','Source Sans 3',sans-serif\">\n\
             <title id=\"{name}-title\">{}</title>\n<desc id=\"{name}-desc\">{}</desc>\n\
             <metadata>{}</metadata>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n",
            markup::escape(&head.title),
            markup::escape(&head.description),
            markup::escape(&head.metadata),
        );
        Self { out, units, polygon: None }
    }

    /// Fills with a colour, or draws a line with it and fills nothing.
    fn paint<S: BackendStyle>(&mut self, style: &S, fill: bool) {
        if !fill {
            self.out.push_str(" fill=\"none\"");
        }
        self.colour(style, fill);
    }

    fn colour<S: BackendStyle>(&mut self, style: &S, fill: bool) {
        let BackendColor { alpha, rgb: (r, g, b) } = style.color();
        let kind = if fill { "fill" } else { "stroke" };
        let _ = write!(self.out, " {kind}=\"#{r:02x}{g:02x}{b:02x}\"");
        if alpha < 1.0 {
            let _ = write!(
                self.out,
                " {kind}-opacity=\"{}\"",
                Hundredths((alpha * 100.0).round() as i32)
            );
        }
        if !fill {
            let width = style.stroke_width().cast_signed();
            let _ = write!(self.out, " stroke-width=\"{}\"", Hundredths(width));
        }
    }

    fn points(&mut self, points: &[BackendCoord]) {
        for (index, (x, y)) in straightened(points, NOT_SEEN).into_iter().enumerate() {
            let gap = if index == 0 { "" } else { " " };
            let _ = write!(self.out, "{gap}{},{}", Hundredths(x), Hundredths(y));
        }
    }
}

/// A length written as points, two decimals, trailing zeros gone.
struct Hundredths(i32);

impl std::fmt::Display for Hundredths {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self(value) = *self;
        let sign = if value < 0 { "-" } else { "" };
        let (whole, part) = (value.unsigned_abs() / 100, value.unsigned_abs() % 100);
        match part {
            0 => write!(f, "{sign}{whole}"),
            _ if part % 10 == 0 => write!(f, "{sign}{whole}.{}", part / 10),
            _ => write!(f, "{sign}{whole}.{part:02}"),
        }
    }
}

impl DrawingBackend for Page<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.units
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        self.out.push_str("</svg>\n");
        Ok(())
    }

    fn draw_pixel(&mut self, point: BackendCoord, color: BackendColor) -> Drawn {
        self.draw_rect(point, (point.0 + 1, point.1 + 1), &color, true)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (x0, y0): BackendCoord,
        (x1, y1): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let (x, y) = (Hundredths(x0.min(x1)), Hundredths(y0.min(y1)));
        let (w, h) = (Hundredths((x1 - x0).abs()), Hundredths((y1 - y0).abs()));
        let _ = write!(self.out, "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"");
        self.paint(style, fill);
        self.out.push_str(END);
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        let path: Vec<BackendCoord> = path.into_iter().collect();
        // The outline of what was filled last is drawn by the same element.
        let outlines = self.polygon.take_if(|(corners, end)| {
            let closed = path.split_last().filter(|(last, _)| path.first() == Some(last));
            *end == self.out.len() && closed.is_some_and(|(_, open)| open == corners)
        });
        if outlines.is_some() {
            self.out.truncate(self.out.len() - END.len());
            self.colour(style, false);
        } else {
            self.out.push_str("<polyline points=\"");
            self.points(&path);
            self.out.push('"');
            self.paint(style, false);
        }
        self.out.push_str(END);
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        (x, y): BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let (x, y, r) = (Hundredths(x), Hundredths(y), Hundredths(radius.cast_signed()));
        let _ = write!(self.out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"");
        self.paint(style, fill);
        self.out.push_str(END);
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        let corners: Vec<BackendCoord> = corners.into_iter().collect();
        self.out.push_str("<polygon points=\"");
        self.points(&corners);
        self.out.push('"');
        self.paint(style, true);
        self.out.push_str(END);
        self.polygon = Some((corners, self.out.len()));
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &T,
        (x, y): BackendCoord,
    ) -> Drawn {
        let em = style.size() / LINE_EM;
        let down = match style.anchor().v_pos {
            VPos::Top => CAP_HEIGHT_EM * em,
            VPos::Center => CAP_HEIGHT_EM * em / 2.0,
            VPos::Bottom => 0.0,
        };
        let down = down.round() as i32;
        let size = Hundredths(em.round() as i32);
        self.out.push_str("<text");
        let _ = match style.transform() {
            FontTransform::None => {
                write!(self.out, " x=\"{}\" y=\"{}\"", Hundredths(x), Hundredths(y + down))
            }
            turned => {
                // Whole numbers, not degrees: whoever draws it would ask the system for their sine, which ends in other digits elsewhere.
                let axes = match turned {
                    FontTransform::Rotate90 => "0 1 -1 0",
                    FontTransform::Rotate180 => "-1 0 0 -1",
                    _ => "0 -1 1 0",
                };
                let (x, y, down) = (Hundredths(x), Hundredths(y), Hundredths(down));
                write!(self.out, " transform=\"matrix({axes} {x} {y})\" y=\"{down}\"")
            }
        };
        let _ = write!(self.out, " font-size=\"{size}\"");
        match style.anchor().h_pos {
            HPos::Left => {}
            HPos::Center => self.out.push_str(" text-anchor=\"middle\""),
            HPos::Right => self.out.push_str(" text-anchor=\"end\""),
        }
        let face = match style.style() {
            FontStyle::Bold => Face::Semibold,
            FontStyle::Italic | FontStyle::Oblique => Face::Italic,
            FontStyle::Normal => Face::Regular,
        };
        match face {
            Face::Regular => {}
            Face::Italic => self.out.push_str(" font-style=\"italic\""),
            Face::Semibold => self.out.push_str(" font-weight=\"600\""),
        }
        self.paint(&style.color(), true);
        self.out.push('>');
        write_runs(self.out, text, face, em);
        self.out.push_str("</text>\n");
        Ok(())
    }
}

/// Size of lowered and raised text where the line has this size, both in points: smaller, but never below what can be read.
pub(crate) fn script_size(line: f64) -> f64 {
    (SCRIPT_SIZE * line).max(size::SMALL).min(line)
}

const SCRIPT_SIZE: f64 = 0.7;
/// How far lowered and raised text moves, in em of the line.
const LOWERED_EM: f64 = 0.18;
const RAISED_EM: f64 = -0.34;

fn write_runs(out: &mut String, text: &str, face: Face, em: f64) {
    let mut shift = 0;
    for run in markup::runs(text) {
        let face = if run.italic { Face::Italic } else { face };
        // A sign that the font lacks would be a box in the PNG and something else elsewhere.
        let known: String =
            run.text.chars().map(|sign| if face.has(sign) { sign } else { '?' }).collect();
        let wanted = match run.level {
            Level::Line => 0.0,
            Level::Lowered => LOWERED_EM,
            Level::Raised => RAISED_EM,
        };
        let wanted = (wanted * em).round() as i32;
        if !run.italic && run.level == Level::Line && shift == 0 {
            out.push_str(&markup::escape(&known));
            continue;
        }
        out.push_str("<tspan");
        if run.italic {
            out.push_str(" font-style=\"italic\"");
        }
        if run.level != Level::Line {
            let _ = write!(
                out,
                " font-size=\"{}\"",
                Hundredths((script_size(em / UNITS_PER_POINT) * UNITS_PER_POINT).round() as i32)
            );
        }
        if wanted != shift {
            let _ = write!(out, " dy=\"{}\"", Hundredths(wanted - shift));
            shift = wanted;
        }
        let _ = write!(out, ">{}</tspan>", markup::escape(&known));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Head {
        /// Of a drawing of no interest, of so many millimetres a side.
        pub(crate) fn square(side_mm: f64) -> Self {
            Self {
                name: "x".into(),
                shown_mm: (side_mm, side_mm),
                size_mm: (side_mm, side_mm),
                title: String::new(),
                description: String::new(),
                metadata: String::new(),
            }
        }
    }

    #[test]
    fn lengths_are_short_and_exact() {
        let written = [0, 5, 50, 123, -7, -1200].map(|v| Hundredths(v).to_string());
        assert_eq!(written, ["0", "0.05", "0.5", "1.23", "-0.07", "-12"]);
    }

    #[test]
    fn a_lowered_run_moves_down_and_the_next_moves_back() {
        let mut out = String::new();
        write_runs(&mut out, "a_{b}c", Face::Regular, 1000.0);
        assert_eq!(out, "a<tspan font-size=\"7\" dy=\"1.8\">b</tspan><tspan dy=\"-1.8\">c</tspan>");
    }

    #[test]
    fn what_is_only_outlined_is_not_filled_and_what_was_filled_is_outlined_in_place() {
        let mut out = String::new();
        let mut page = Page { out: &mut out, units: (1000, 1000), polygon: None };
        let corners = [(0, 0), (900, 0), (900, 900)];
        let closed = [corners[0], corners[1], corners[2], corners[0]];
        let (ink, white) = (plotters::style::BLACK, plotters::style::WHITE);
        page.draw_rect((0, 0), (500, 500), &ink, false).unwrap();
        page.draw_circle((0, 0), 100, &ink, false).unwrap();
        page.draw_path(closed, &ink).unwrap();
        page.fill_polygon(corners, &white).unwrap();
        page.draw_path(closed, &ink).unwrap();
        page.draw_path(closed, &ink).unwrap();
        let elements: Vec<&str> = out.lines().collect();
        assert_eq!(elements.len(), 5, "{out}");
        for outline in [0, 1, 2, 4] {
            assert!(elements[outline].contains(" fill=\"none\" stroke=\"#000000\""), "{out}");
        }
        assert!(elements[3].contains(" fill=\"#ffffff\" stroke=\"#000000\""), "{out}");
    }

    #[test]
    fn nothing_is_smaller_than_six_and_a_half_points() {
        for line in [size::SMALL, size::TICK, size::SUBTITLE, size::AXIS, size::TITLE] {
            assert!(script_size(line) >= 6.5 && script_size(line) <= line);
        }
        let mut out = String::new();
        write_runs(&mut out, "*η*_{p}", Face::Regular, 700.0);
        assert!(out.contains("font-size=\"6.5\""), "{out}");
    }

    #[test]
    fn a_sign_that_the_font_lacks_is_a_question_mark() {
        let mut out = String::new();
        write_runs(&mut out, "a∥😀", Face::Regular, 700.0);
        assert_eq!(out, "a??");
    }
}
