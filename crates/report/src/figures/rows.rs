//! Named rows under each other, on one axis of x.

use super::prelude::*;

/// The names, from top to bottom, each at its own value of y.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    names: Vec<String>,
    rim: f64,
}

impl Rows {
    /// Rows by their names, which are plain text, with room above the first and below the last as a share of a row.
    pub(crate) fn new<N: AsRef<str>>(names: impl IntoIterator<Item = N>, rim: f64) -> Self {
        let names = names.into_iter().map(|name| markup::literal(name.as_ref()));
        Self { names: names.collect(), rim }
    }

    /// The value of y of a row.
    pub(crate) fn y(&self, row: usize) -> f64 {
        self.names.len() as f64 - 1.0 - row as f64
    }

    /// The axis with the names at it.
    pub(crate) fn axis(&self) -> Scale {
        self.labelled(String::clone)
    }

    /// The same axis without names, for a panel beside one that has them.
    pub(crate) fn unnamed(&self) -> Scale {
        self.labelled(|_| String::new())
    }

    fn labelled(&self, label: fn(&String) -> String) -> Scale {
        let ticks = self.names.iter().enumerate();
        let ticks = ticks.map(|(row, name)| (self.y(row), label(name)));
        Scale::labelled(-self.rim, self.y(0) + self.rim, ticks.collect())
    }

    /// Width of the widest name, in points.
    pub(crate) fn width(&self) -> f64 {
        Look::new(size::TICK).widest(&self.names)
    }
}

impl Panel<'_, '_> {
    /// The dashed line at which nothing differs.
    pub(crate) fn nothing(&mut self, x: f64) {
        self.upright(x, Pen::new(GREY, stroke::AXIS).dashed(2.0, 1.5));
    }

    /// The sign of a row without a value, at a place on the page.
    pub(crate) fn dash(&mut self, x: f64, row: f64) {
        let look = Look::new(size::TICK).middle().centred();
        self.canvas.text("–", (x, self.frame.y.at(row)), look);
    }
}
