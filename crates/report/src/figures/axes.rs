//! Scales, ticks and the frame of a panel.

use super::canvas::{Canvas, Look, Pen, cap_height};
use super::names::{LINE, Names, fitted};
use super::style;
use super::theme::{GRID, INK, size, stroke};
pub(crate) use crate::apa::number;

/// A range of values, its ticks, and where it lies on the page.
#[derive(Debug, Clone)]
pub(crate) struct Scale {
    low: f64,
    high: f64,
    pub(crate) ticks: Vec<f64>,
    pub(crate) labels: Vec<String>,
    from: f64,
    to: f64,
    logarithmic: bool,
    /// The labels are names: each gets the room to its neighbour.
    named: bool,
}

impl Scale {
    /// A linear scale over `values` with some room at both ends and about `wanted` ticks.
    ///
    /// All values equal: the range is widened by 5 %, or by 1 around zero.
    pub(crate) fn over(values: impl IntoIterator<Item = f64>, wanted: usize) -> Self {
        let (low, high) = extent(values);
        let room = 0.04 * (high - low);
        Self::between(low - room, high + room, wanted)
    }

    /// A linear scale from `low` to `high`.
    pub(crate) fn between(low: f64, high: f64, wanted: usize) -> Self {
        let (low, high) = widened(low, high);
        let step = nice_step((high - low) / wanted.max(1) as f64);
        let first = (low / step).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        let ticks: Vec<f64> = (first..=last).map(|k| k as f64 * step).collect();
        let decimals = (-libm::log10(step) - 1e-9).ceil().clamp(0.0, 6.0) as usize;
        let labels = ticks.iter().map(|&tick| number(tick, decimals)).collect();
        Self::new((low, high), ticks, labels, false)
    }

    /// A logarithmic scale over positive values.
    pub(crate) fn log_over(values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = extent(values.into_iter().map(libm::log10));
        let room = 0.05 * (high - low);
        let (low, high) = widened(low - room, high + room);
        let steps: &[f64] = if high - low < 1.6 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let mut ticks = Vec::new();
        let mut labels = Vec::new();
        for power in (low.floor() as i32)..=(high.ceil() as i32) {
            for step in steps {
                let place = f64::from(power) + libm::log10(*step);
                if place >= low && place <= high {
                    ticks.push(place);
                    labels.push(number(step * 10f64.powi(power), (-power).max(0) as usize));
                }
            }
        }
        Self::new((low, high), ticks, labels, true)
    }

    /// A scale whose ticks are given: value and label.
    pub(crate) fn labelled(low: f64, high: f64, ticks: Vec<(f64, String)>) -> Self {
        let (low, high) = widened(low, high);
        let (ticks, labels) = ticks.into_iter().unzip();
        Self::new((low, high), ticks, labels, false)
    }

    /// A scale of names at 0, 1, 2 …: they are set so that none overlaps another.
    pub(crate) fn of_names(low: f64, high: f64, names: impl Iterator<Item = String>) -> Self {
        let ticks = names.enumerate().map(|(at, name)| (at as f64, name));
        Self { named: true, ..Self::labelled(low, high, ticks.collect()) }
    }

    /// How its names are set on so many points.
    fn names(&self, width: f64) -> Option<Names> {
        let space = width / (self.high - self.low);
        self.named.then(|| Names::set(&self.labels, space))
    }

    fn new(
        (low, high): (f64, f64),
        ticks: Vec<f64>,
        labels: Vec<String>,
        logarithmic: bool,
    ) -> Self {
        Self { low, high, ticks, labels, from: 0.0, to: 1.0, logarithmic, named: false }
    }

    /// The same scale laid from `from` to `to` on the page, in points.
    pub(crate) fn placed(mut self, from: f64, to: f64) -> Self {
        (self.from, self.to) = (from, to);
        self
    }

    /// Where a value lies on the page, in points.
    pub(crate) fn at(&self, value: f64) -> f64 {
        let value = if self.logarithmic { libm::log10(value) } else { value };
        self.place(value)
    }

    fn place(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// The lowest and the highest value on it.
    pub(crate) fn ends(&self) -> (f64, f64) {
        (self.low, self.high)
    }
}

/// The least and the greatest; of none, infinity and its opposite.
pub(crate) fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values
        .into_iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

fn widened(low: f64, high: f64) -> (f64, f64) {
    if !(low.is_finite() && high.is_finite()) {
        return (0.0, 1.0);
    }
    let tiny = 1e-9 * low.abs().max(high.abs()).max(1e-9);
    if high - low > tiny {
        return (low, high);
    }
    let room = if low.abs() < 1e-9 { 1.0 } else { 0.05 * low.abs() };
    (low - room, high + room)
}

fn nice_step(rough: f64) -> f64 {
    let power = 10f64.powi(libm::log10(rough).floor() as i32);
    let share = rough / power;
    // The nearest of 1, 2, 5 and 10, so that the number of ticks is near the wanted one.
    let nice = match share {
        share if share < 1.5 => 1.0,
        share if share < 3.2 => 2.0,
        share if share < 7.1 => 5.0,
        _ => 10.0,
    };
    nice * power
}

/// A rectangle on the page, in points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Place {
    /// Left, top, width and height in whole units, with half of a gap to every side, not below `foot`.
    pub(crate) fn boxed(self, gap: (f64, f64), foot: f64) -> [i32; 4] {
        let (left, top) = (self.left - 0.5 * gap.0, self.top - 0.5 * gap.1);
        let (width, height) =
            (self.right + 0.5 * gap.0 - left, (self.bottom + 0.5 * gap.1).min(foot) - top);
        [left.floor(), top.floor(), width.ceil(), height.ceil()].map(|v| v as i32)
    }

    /// The `(column, row)`th of a grid of equal places.
    pub(crate) fn cell(
        self,
        (column, row): (usize, usize),
        (columns, rows): (usize, usize),
        gap: (f64, f64),
    ) -> Self {
        let width = (self.right - self.left - gap.0 * (columns - 1) as f64) / columns as f64;
        let height = (self.bottom - self.top - gap.1 * (rows - 1) as f64) / rows as f64;
        let left = self.left + column as f64 * (width + gap.0);
        let top = self.top + row as f64 * (height + gap.1);
        Self { left, top, right: left + width, bottom: top + height }
    }
}

/// A panel's axes, placed.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    pub(crate) x: Scale,
    pub(crate) y: Scale,
    pub(crate) place: Place,
}

/// What is written around a panel. Empty texts take no room.
#[derive(Debug, Clone, Default)]
pub(crate) struct Labels<'a> {
    pub(crate) title: &'a str,
    pub(crate) subtitle: &'a str,
    pub(crate) x: &'a str,
    pub(crate) y: &'a str,
    /// Room for the numbers at the y axis, in points, at least: aligns panels above each other.
    pub(crate) numbers: f64,
}

const TITLE_GAP: f64 = 4.0;
/// The widest letter of a panel.
const LETTER: &str = "m)";
const TICK_LENGTH: f64 = 2.0;

fn title_look() -> Look {
    Look::new(size::TITLE).semibold()
}

/// The lines of a text, each on as many as a width takes.
fn set(text: &str, look: Look, width: f64) -> Vec<String> {
    let set = |line: &str| {
        let shown = style::current().and_then(|style| style.label(line));
        let lines = fitted(shown.unwrap_or(line), look, width);
        // Whoever draws it looks up what it is to be called.
        if lines.len() > 1 { lines } else { vec![line.to_owned()] }
    };
    text.lines().flat_map(set).collect()
}

impl Labels<'_> {
    /// The lines of title and subtitle in a panel of so many points' width.
    fn head(&self, width: f64, has_letter: bool) -> [Vec<String>; 2] {
        let look = title_look();
        let letter = if has_letter { look.width(LETTER) } else { 0.0 };
        let mut title = set(self.title, look, width - letter);
        if has_letter && title.is_empty() {
            title.push(String::new());
        }
        let subtitle = set(self.subtitle, Look::new(size::SUBTITLE), width);
        [title, subtitle]
    }

    /// Points that the lines of title and subtitle take after the first of each.
    pub(crate) fn further_lines(&self, width: f64, has_letter: bool) -> f64 {
        let further = self.head(width, has_letter).map(|l| l.len().saturating_sub(1) as f64);
        let heights = [size::TITLE, size::SUBTITLE].map(|size| cap_height(size) + TITLE_GAP);
        further[0] * heights[0] + further[1] * heights[1]
    }
}

impl Frame {
    /// Draws title, axes, ticks, a grid across y, and gives the scales their places.
    pub(crate) fn draw(
        canvas: &mut Canvas<'_>,
        outer: Place,
        labels: &Labels<'_>,
        x: Scale,
        y: Scale,
    ) -> Self {
        let mut top = outer.top;
        let letter = canvas.letter.take();
        let [title, subtitle] = labels.head(outer.right - outer.left, letter.is_some());
        let mut left = outer.left;
        if let Some(letter) = letter {
            let first = top + cap_height(size::TITLE);
            canvas.text(&format!("{letter})"), (left, first), title_look());
            left += title_look().width(LETTER);
        }
        for line in &title {
            top += cap_height(size::TITLE);
            canvas.text(line, (left, top), title_look());
            top += TITLE_GAP;
        }
        if title.is_empty() && !subtitle.is_empty() {
            // A raised exponent reaches above the capitals.
            top += 2.0;
        }
        for line in &subtitle {
            top += cap_height(size::SUBTITLE);
            canvas.text(line, (outer.left, top), Look::new(size::SUBTITLE));
            top += TITLE_GAP;
        }
        top += if labels.title.is_empty() { cap_height(size::TICK) / 2.0 } else { 3.0 };
        let mut bottom = outer.bottom;
        if !labels.x.is_empty() {
            bottom -= cap_height(size::AXIS) + 6.5;
        }
        let mut left = outer.left;
        if !labels.y.is_empty() {
            left += cap_height(size::AXIS) + 5.0;
        }
        let widest = Look::new(size::TICK).widest(&y.labels);
        left += widest.max(labels.numbers) + TICK_LENGTH + 2.0;
        let names = x.names(outer.right - left);
        if x.labels.iter().any(|label| !label.is_empty()) {
            let height = names.as_ref().map_or(cap_height(size::TICK), Names::height);
            bottom -= height + TICK_LENGTH + 2.5;
        }
        let place = Place { left, top, right: outer.right, bottom };
        let frame = Self::laid(x, y, place);
        frame.axes(canvas, outer, labels, names.as_ref());
        frame
    }

    /// Axes of which x runs to the right and y upwards.
    pub(crate) fn laid(x: Scale, y: Scale, place: Place) -> Self {
        let x = x.placed(place.left, place.right);
        let y = y.placed(place.bottom, place.top);
        Self { x, y, place }
    }

    fn axes(
        &self,
        canvas: &mut Canvas<'_>,
        outer: Place,
        labels: &Labels<'_>,
        names: Option<&Names>,
    ) {
        let Place { left, top, right, bottom } = self.place;
        let axis = Pen::new(INK, stroke::AXIS);
        let tick_look = Look::new(size::TICK);
        for (&tick, label) in self.y.ticks.iter().zip(&self.y.labels) {
            let y = self.y.place(tick);
            canvas.line((left, y), (right, y), Pen::new(GRID, stroke::THIN));
            let lines: Vec<&str> = label.split('\n').collect();
            let first = y - LINE * (lines.len() - 1) as f64 / 2.0;
            for (at, line) in lines.into_iter().enumerate() {
                let end = (left - TICK_LENGTH - 2.0, first + LINE * at as f64);
                canvas.text(line, end, tick_look.end().centred());
            }
        }
        for (index, (&tick, label)) in self.x.ticks.iter().zip(&self.x.labels).enumerate() {
            let x = self.x.place(tick);
            canvas.line((x, bottom), (x, bottom + TICK_LENGTH), axis);
            if let Some(names) = names {
                names.draw(canvas, index, (x, bottom + TICK_LENGTH + 2.5));
                continue;
            }
            let half = tick_look.width(label) / 2.0;
            // The outermost labels stay inside the panel.
            let x = x.clamp(outer.left + half, (outer.right - half).max(outer.left + half));
            canvas.text(label, (x, bottom + TICK_LENGTH + 2.5), tick_look.middle().hanging());
        }
        canvas.line((left, top), (left, bottom), axis);
        canvas.line((left, bottom), (right, bottom), axis);
        let axis_look = Look::new(size::AXIS).middle();
        if !labels.x.is_empty() {
            // Below the middle of the axis, unless the words would end outside.
            let half = axis_look.width(labels.x) / 2.0;
            let x = f64::midpoint(left, right).min(outer.right - half).max(outer.left + half);
            canvas.text(labels.x, (x, outer.bottom - 2.0), axis_look);
        }
        if !labels.y.is_empty() {
            let half = axis_look.width(labels.y) / 2.0;
            let middle = f64::midpoint(top, bottom);
            let y = middle.max(outer.top + half).min((outer.bottom - half).max(middle - half));
            canvas.text(labels.y, (outer.left, y), axis_look.hanging().turned());
        }
    }

    /// Where a pair of values lies on the page.
    pub(crate) fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (self.x.at(x), self.y.at(y))
    }
}

#[cfg(test)]
mod tests;
