//! A panel of rainclouds side by side: half violin, box, points, mean with interval, and contrasts as brackets.

use super::crowd::MOST_POINTS;
use super::names::Names;
use super::prelude::*;
use super::raincloud::{self, BOX, Cloud};
use super::style;

/// One cloud's name, look and mean.
#[derive(Debug)]
pub(crate) struct Slot {
    pub(crate) name: String,
    pub(crate) look: (Marker, RGBColor),
    /// Mean, and the ends of its interval.
    pub(crate) mean: Option<[f64; 3]>,
}

/// What a panel shows.
#[derive(Debug)]
pub(crate) struct Panel<'a> {
    pub(crate) title: &'a str,
    pub(crate) subtitle: &'a str,
    pub(crate) axis: &'a str,
    pub(crate) slots: Vec<Slot>,
    /// One row a person, a value a slot.
    pub(crate) rows: &'a [Vec<Option<f64>>],
    /// Slots that are compared, and what is written above the bracket.
    pub(crate) contrasts: Vec<(usize, usize, String)>,
    /// Value at which a line is drawn.
    pub(crate) reference: Option<f64>,
    /// Lowest and highest value that there can be, where the scale has ends.
    pub(crate) range: Option<(f64, f64)>,
}

/// About what the axis of values takes, in points.
const AXIS: f64 = 28.0;

/// How the names of slots are set in a panel of about so many points' width.
pub(crate) fn names(names: &[String], width: f64) -> Names {
    Names::set(names, (width - AXIS) / (names.len() as f64 + 0.15))
}

/// Millimetres that titles and subtitles take, after the first line of each, of the panel where they take most; of a figure so wide.
pub(crate) fn further_mm<'a>(
    heads: impl Iterator<Item = [&'a str; 2]>,
    grid: Grid,
    width_mm: f64,
) -> f64 {
    let drawn_mm = style::drawn_width(width_mm);
    let width = grid.panel_width(drawn_mm);
    let further = heads.map(|[title, subtitle]| {
        let labels = Labels { title, subtitle, ..Labels::default() };
        labels.further_lines(width, grid.has_letters())
    });
    further.fold(0.0, f64::max) / 72.0 * 25.4 * width_mm / drawn_mm
}

/// Draws the panel into its place.
pub(crate) fn paint(canvas: &mut Canvas<'_>, place: Place, input: &Panel<'_>) {
    let k = input.slots.len();
    let brackets = brackets(&input.contrasts);
    let cloud = |index: usize| {
        let values = input.rows.iter().filter_map(|row| row[index]).collect();
        Cloud::new(values, input.range)
    };
    let clouds: Vec<Option<Cloud>> = (0..k).map(cloud).collect();
    let values = clouds.iter().flatten().flat_map(Cloud::ends);
    let data = Scale::over(values.chain(input.reference), 5);
    // The brackets need their room above the data.
    let levels = brackets.iter().map(|bracket| bracket.level + 1).max();
    let room = levels.map_or(0.0, |levels| levels as f64 * STEP + 3.0);
    let names: Vec<String> = input.slots.iter().map(|slot| slot.name.clone()).collect();
    let below = self::names(&names, place.right - place.left).height();
    let labels =
        Labels { title: input.title, subtitle: input.subtitle, y: input.axis, ..Labels::default() };
    let further = labels.further_lines(place.right - place.left, canvas.letter.is_some());
    let around = 42.0 - cap_height(size::TICK) + below + further;
    let plot = (place.bottom - place.top - around).max(40.0);
    let (low, top) = data.ends();
    let high = low + (top - low) * plot / (plot - room).max(plot / 3.0);
    // Ticks only where there are data: what lies above them is room for the brackets.
    let data = Scale::between(low, top, 4);
    let y = Scale::labelled(low, high, data.ticks.into_iter().zip(data.labels).collect());
    let x = Scale::of_names(-0.55, k as f64 - 0.4, names.into_iter());
    let mut panel = super::panel::Panel::open(canvas, place, &labels, (x, y));
    if let Some(reference) = input.reference {
        panel.rule(reference);
    }
    let frame = panel.frame;
    let slot = (frame.place.right - frame.place.left) / (k as f64 + 0.15);
    if input.rows.len() <= MOST_POINTS {
        paint_people(canvas, &frame, input, slot);
    }
    for (index, (of, cloud)) in input.slots.iter().zip(&clouds).enumerate() {
        let middle = frame.x.at(index as f64);
        let Some(cloud) = cloud else {
            let centre = f64::midpoint(frame.place.top + room, frame.place.bottom);
            let look = Look::new(size::SMALL).middle().centred().colour(MUTED);
            canvas.text("no values", (middle, centre), look.turned());
            continue;
        };
        raincloud::paint(canvas, &frame, cloud, (middle, slot), of.look.1);
        if let Some(ends) = of.mean {
            // An interval of very few people is cut where the panel ends.
            let inside = |end: f64| frame.y.at(end.clamp(low, top));
            let [mean, low, high] = ends.map(|end| (middle + BOX * slot, inside(end)));
            canvas.line(low, high, Pen::new(INK, stroke::STRONG));
            canvas.disc(mean, 1.7, INK, 1.0);
            canvas.ring(mean, 1.7, Pen::new(PAPER, stroke::THIN));
        }
    }
    for bracket in &brackets {
        bracket.paint(canvas, &frame, frame.place.top + room - 3.0);
    }
}

/// Offsets of the points within a slot, as shares of its width.
const POINTS: f64 = -0.2;
const JITTER: f64 = 0.09;
/// Height of a level of brackets, in points.
const STEP: f64 = 1.6 * size::SMALL;

fn paint_people(canvas: &mut Canvas<'_>, frame: &Frame, panel: &Panel<'_>, slot: f64) {
    let n = panel.rows.len();
    // Jitter by the person's place in the list: the same on every run, no generator.
    let jitter = |index: usize| {
        let turn = (index as f64 * 0.618_034).fract();
        if n < 2 { 0.0 } else { (turn - 0.5) * 2.0 * JITTER * slot }
    };
    let place_of = |index: usize, column: usize, value: f64| {
        (frame.x.at(column as f64) + POINTS * slot + jitter(index), frame.y.at(value))
    };
    let pen = Pen::new(GREY, stroke::THIN).alpha(0.35);
    for (index, row) in panel.rows.iter().enumerate() {
        let mut path = Vec::new();
        for (column, value) in row.iter().enumerate() {
            match value {
                Some(value) => path.push(place_of(index, column, *value)),
                None => canvas.path(&std::mem::take(&mut path), pen),
            }
        }
        canvas.path(&path, pen);
    }
    for (column, cloud) in panel.slots.iter().enumerate() {
        for (index, row) in panel.rows.iter().enumerate() {
            if let Some(value) = row[column] {
                let place = place_of(index, column, value);
                canvas.marker(place, stroke::POINT, cloud.look.0, cloud.look.1);
            }
        }
    }
}

#[derive(Debug)]
struct Bracket<'a> {
    from: usize,
    to: usize,
    level: usize,
    text: &'a str,
}

impl Bracket<'_> {
    /// Draws it on its level above a base on the page.
    fn paint(&self, canvas: &mut Canvas<'_>, frame: &Frame, base: f64) {
        let y = base - self.level as f64 * STEP;
        let [from, to] = [self.from, self.to].map(|slot| frame.x.at(slot as f64));
        let (left, right) = (from + 1.0, to - 1.0);
        let feet = [(left, y + 2.0), (left, y), (right, y), (right, y + 2.0)];
        canvas.path(&feet, Pen::new(INK, stroke::AXIS));
        let look = Look::new(size::SMALL).middle();
        canvas.text(self.text, (f64::midpoint(from, to), y - 1.8), look);
    }
}

/// Shortest first, each on the lowest level where it meets no other.
fn brackets(contrasts: &[(usize, usize, String)]) -> Vec<Bracket<'_>> {
    let mut spans: Vec<(usize, usize, &str)> =
        contrasts.iter().map(|(a, b, text)| (*a.min(b), *a.max(b), text.as_str())).collect();
    spans.sort_by_key(|(from, to, _)| (to - from, *from));
    let mut out: Vec<Bracket<'_>> = Vec::new();
    for (from, to, text) in spans {
        let mut level = 0;
        while out.iter().any(|b| b.level == level && b.from < to && from < b.to) {
            level += 1;
        }
        out.push(Bracket { from, to, level, text });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_do_not_cross() {
        let contrasts = [(0, 1), (2, 0), (0, 3)].map(|(a, b)| (a, b, String::new()));
        let levels: Vec<usize> = brackets(&contrasts).iter().map(|b| b.level).collect();
        assert_eq!(levels, [0, 1, 2]);
    }
}
