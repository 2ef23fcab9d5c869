//! A panel with its axes, in which everything is drawn at the values that it shows.

use super::prelude::*;
use super::thin::thinned;

/// Most points of a line: more are thinned to the lowest and the highest of each stretch.
pub(crate) const MOST_ON_A_LINE: usize = 1600;

/// How a mark looks: radius in points, shape, colour.
pub(crate) type Mark = (f64, Marker, RGBColor);

/// An open panel.
pub(crate) struct Panel<'p, 'c> {
    pub(crate) canvas: &'p mut Canvas<'c>,
    pub(crate) frame: Frame,
}

impl<'p, 'c> Panel<'p, 'c> {
    /// Draws title and axes.
    pub(crate) fn open(
        canvas: &'p mut Canvas<'c>,
        place: Place,
        labels: &Labels<'_>,
        (x, y): (Scale, Scale),
    ) -> Self {
        let frame = Frame::draw(canvas, place, labels, x, y);
        Self { canvas, frame }
    }

    /// A line through values; a single value is a dot.
    pub(crate) fn line(&mut self, values: impl IntoIterator<Item = (f64, f64)>, pen: Pen) {
        let values: Vec<(f64, f64)> = values.into_iter().collect();
        self.thin_line(&values, MOST_ON_A_LINE, pen);
    }

    /// A line through at most about so many of the values.
    pub(crate) fn thin_line(&mut self, values: &[(f64, f64)], most: usize, pen: Pen) {
        let values = thinned(values, most).into_iter();
        let path: Vec<(f64, f64)> = values.map(|(x, y)| self.frame.at(x, y)).collect();
        if let [alone] = path[..] {
            self.canvas.dot(alone, pen);
        }
        self.canvas.path(&path, pen);
    }

    /// A filled shape.
    pub(crate) fn area(&mut self, corners: &[(f64, f64)], colour: RGBColor, alpha: f64) {
        let corners: Vec<(f64, f64)> = corners.iter().map(|&(x, y)| self.frame.at(x, y)).collect();
        self.canvas.polygon(&corners, colour, alpha);
    }

    /// A filled rectangle between two values of x and two of y.
    pub(crate) fn shade(&mut self, x: [f64; 2], y: [f64; 2], colour: RGBColor, alpha: f64) {
        let corners = (self.frame.at(x[0], y[1]), self.frame.at(x[1], y[0]));
        self.canvas.fill_rect(corners.0, corners.1, colour, alpha);
    }

    /// A filled stripe between two values of x, from top to bottom.
    pub(crate) fn stripe(&mut self, [low, high]: [f64; 2], colour: RGBColor, alpha: f64) {
        let Place { top, bottom, .. } = self.frame.place;
        let (left, right) = (self.frame.x.at(low), self.frame.x.at(high));
        self.canvas.fill_rect((left, top), (right, bottom), colour, alpha);
    }

    /// Draws a marker at values of the axes.
    pub(crate) fn mark(&mut self, (x, y): (f64, f64), (radius, shape, colour): Mark) {
        let centre = self.frame.at(x, y);
        self.canvas.marker(centre, radius, shape, colour);
    }

    /// A line at a value of x, from top to bottom.
    pub(crate) fn upright(&mut self, x: f64, pen: Pen) {
        let (x, Place { top, bottom, .. }) = (self.frame.x.at(x), self.frame.place);
        self.canvas.line((x, top), (x, bottom), pen);
    }

    /// A line at a value of y, from side to side.
    pub(crate) fn level(&mut self, y: f64, pen: Pen) {
        let (y, Place { left, right, .. }) = (self.frame.y.at(y), self.frame.place);
        self.canvas.line((left, y), (right, y), pen);
    }

    /// A dashed line from side to side, where the panel reaches so far.
    pub(crate) fn rule(&mut self, y: f64) {
        let (least, most) = self.frame.y.ends();
        if (least..=most).contains(&y) {
            self.level(y, Pen::new(INK, stroke::AXIS).dashed(2.0, 1.5));
        }
    }

    /// A value of y with its interval, at x; what leaves the panel is cut there.
    pub(crate) fn upright_interval(
        &mut self,
        x: f64,
        [value, low, high]: [f64; 3],
        pen: Pen,
        mark: Mark,
    ) {
        let (least, most) = self.frame.y.ends();
        self.line([low, high].map(|end| (x, end.clamp(least, most))), pen);
        self.mark((x, value), mark);
    }

    /// A value of x with its interval, at y.
    pub(crate) fn level_interval(
        &mut self,
        [value, low, high]: [f64; 3],
        y: f64,
        pen: Pen,
        mark: Mark,
    ) {
        self.line([(low, y), (high, y)], pen);
        self.mark((value, y), mark);
    }

    /// A curve through values of y with their intervals: x, value, low end, high end.
    pub(crate) fn curve(&mut self, points: &[[f64; 4]], (radius, shape, colour): Mark) {
        let through = points.iter().map(|&[x, y, ..]| (x, y));
        self.line(through, Pen::new(colour, stroke::STRONG));
        for &[x, value, low, high] in points {
            let thin = Pen::new(colour, stroke::AXIS);
            self.upright_interval(x, [value, low, high], thin, (radius, shape, colour));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::{canvas::sketch, page::Head};

    fn drawn(paint: impl FnOnce(&mut Panel<'_, '_>)) -> String {
        let sketch = sketch(&Head::square(50.0), |canvas| {
            let place = Place { left: 10.0, top: 30.0, right: 110.0, bottom: 80.0 };
            let (x, y) = (Scale::between(0.0, 1.0, 2), Scale::between(0.0, 10.0, 5));
            let frame = Frame::laid(x, y, place);
            paint(&mut Panel { canvas, frame });
        });
        let svg = sketch.unwrap().svg;
        svg.lines().skip(5).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn a_rule_crosses_its_panel_at_its_value_and_none_is_drawn_beside_it() {
        let nothing = drawn(|_| {});
        for beside in [-0.1, 11.0] {
            assert_eq!(drawn(|panel| panel.rule(beside)), nothing);
        }
        for (value, y) in [(0.0, "10,80 "), (2.0, "10,70 "), (10.0, "10,30 ")] {
            assert!(drawn(|panel| panel.rule(value)).contains(y), "{value}");
        }
    }

    #[test]
    fn everything_is_drawn_at_its_values() {
        let pen = Pen::new(INK, 1.0);
        let mark = (2.0, Marker::Circle, INK);
        let holds = |paint: &dyn Fn(&mut Panel<'_, '_>), expected: &[&str]| {
            let svg = drawn(|panel| paint(panel));
            for piece in expected {
                assert!(svg.contains(piece), "{piece}: {svg}");
            }
        };
        holds(&|p| p.line([(0.0, 0.0), (1.0, 10.0)], pen), &["\"10,80 110,30\""]);
        holds(&|p| p.line([(0.5, 5.0)], pen), &["cx=\"60\" cy=\"55\" r=\"0.8\""]);
        holds(&|p| p.upright(0.25, pen), &["\"35,30 35,80\""]);
        holds(&|p| p.level(5.0, pen), &["\"10,55 110,55\""]);
        holds(
            &|p| p.shade([0.1, 0.2], [2.0, 4.0], INK, 1.0),
            &["x=\"20\" y=\"60\" width=\"10\" height=\"10\""],
        );
        holds(
            &|p| p.stripe([0.1, 0.2], INK, 1.0),
            &["x=\"20\" y=\"30\" width=\"10\" height=\"50\""],
        );
        // The end of an interval that leaves the panel lies on its border; the mark lies at the value.
        holds(
            &|p| p.upright_interval(0.5, [4.0, 2.0, 99.0], pen, mark),
            &["\"60,70 60,30\"", "cx=\"60\" cy=\"60\""],
        );
        holds(
            &|p| p.level_interval([0.5, 0.25, 0.75], 4.0, pen, mark),
            &["\"35,60 85,60\"", "cx=\"60\" cy=\"60\""],
        );
        holds(
            &|p| p.curve(&[[0.0, 1.0, 0.0, 2.0], [1.0, 3.0, 2.0, 4.0]], mark),
            &["\"10,75 110,65\"", "\"10,80 10,70\"", "cx=\"110\" cy=\"65\""],
        );
    }
}
