//! What names the series of a figure.

use super::axes::Place;
use super::canvas::{Canvas, Look, Pen, cap_height};
use super::theme::{Marker, size};
use plotters::style::RGBColor;

/// What stands before a label in a legend.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Key {
    Point(Marker, RGBColor),
    Line(Pen),
}

impl Key {
    fn width(self) -> f64 {
        match self {
            Self::Point(..) => 6.5,
            Self::Line(_) => 15.5,
        }
    }
}

const GAP: f64 = 9.0;
const ROW: f64 = 10.0;

impl Canvas<'_> {
    /// Names the series of a figure in one row: marker or line, then label. Returns where it ends.
    pub(crate) fn legend_row(
        &mut self,
        (x, y): (f64, f64),
        entries: &[(Key, impl AsRef<str>)],
    ) -> f64 {
        let look = Look::new(size::TICK).centred();
        let mut x = x;
        for (key, label) in entries {
            let label = label.as_ref();
            match *key {
                Key::Point(shape, colour) => self.marker((x + 2.5, y), 2.2, shape, colour),
                Key::Line(pen) => self.line((x, y), (x + 13.0, y), pen),
            }
            self.text(label, (x + key.width(), y), look);
            x += key.width() + look.width(label) + GAP;
        }
        x - GAP
    }

    /// Names the series at the top of a place, in as many rows as they need. Returns the place below.
    pub(crate) fn legend(&mut self, place: Place, entries: &[(Key, impl AsRef<str>)]) -> Place {
        let look = Look::new(size::TICK);
        let mut y = place.top + 4.0;
        let mut row: Vec<(Key, &str)> = Vec::new();
        let mut x = place.left;
        for (key, label) in entries {
            let (key, label) = (*key, label.as_ref());
            let width = key.width() + look.width(label);
            if x + width > place.right && !row.is_empty() {
                self.legend_row((place.left, y), &row);
                row.clear();
                x = place.left;
                y += ROW;
            }
            row.push((key, label));
            x += width + GAP;
        }
        self.legend_row((place.left, y), &row);
        Place { top: y + cap_height(size::TICK) + 4.0, ..place }
    }
}
