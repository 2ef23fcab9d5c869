//! A panel of rainclouds side by side: half violin, box, points, mean with interval, and contrasts as brackets.

use super::crowd::MOST_POINTS;
use super::prelude::*;
use super::raincloud::{self, BOX, Cloud};

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

/// Draws the panel into its place.
pub(crate) fn paint(canvas: &mut Canvas<'_>, place: Place, panel: &Panel<'_>) {
    let k = panel.slots.len();
    let brackets = brackets(&panel.contrasts);
    let clouds: Vec<Option<Cloud>> = (0..k)
        .map(|index| {
            let values = panel.rows.iter().filter_map(|row| row[index]).collect();
            Cloud::of(values, panel.range)
        })
        .collect();
    let values = clouds.iter().flatten().flat_map(Cloud::ends);
    let data = Scale::over(values.chain(panel.reference), 5);
    // The brackets need their room above the data.
    let levels = brackets
        .iter()
        .map(|bracket| bracket.level + 1)
        .max()
        .unwrap_or(0);
    let room = levels as f64 * STEP + if levels > 0 { 3.0 } else { 0.0 };
    let plot = (place.bottom - place.top - 42.0).max(40.0);
    let (low, top) = (data.low(), data.high());
    let high = low + (top - low) * plot / (plot - room).max(plot / 3.0);
    // Ticks only where there are data: what lies above them is room for the brackets.
    let data = Scale::between(low, top, 4);
    let y = Scale::labelled(low, high, data.ticks.into_iter().zip(data.labels).collect());
    let names = panel.slots.iter().enumerate();
    let names = names.map(|(index, slot)| (index as f64, slot.name.clone()));
    let x = Scale::labelled(-0.55, k as f64 - 0.4, names.collect());
    let labels = Labels {
        title: panel.title,
        subtitle: panel.subtitle,
        x: "",
        y: panel.axis,
        ..Labels::default()
    };
    let frame = Frame::draw(canvas, place, &labels, x, y);
    if let Some(reference) = panel.reference {
        frame.rule(canvas, reference);
    }
    let slot = (frame.place.right - frame.place.left) / (k as f64 + 0.15);
    if panel.rows.len() <= MOST_POINTS {
        paint_people(canvas, &frame, panel, slot);
    }
    for (index, (of, cloud)) in panel.slots.iter().zip(&clouds).enumerate() {
        let middle = frame.x.at(index as f64);
        let Some(cloud) = cloud else {
            let centre = f64::midpoint(frame.place.top + room, frame.place.bottom);
            let look = Look::new(size::SMALL).middle().centred().colour(MUTED);
            canvas.text("no values", (middle, centre), look.turned());
            continue;
        };
        raincloud::paint(canvas, &frame, cloud, (middle, slot), of.look.1);
        if let Some([mean, low, high]) = of.mean {
            let x = middle + BOX * slot;
            let ends = [frame.y.at(low), frame.y.at(high)];
            canvas.line((x, ends[0]), (x, ends[1]), Pen::new(INK, stroke::STRONG));
            canvas.disc((x, frame.y.at(mean)), 1.7, INK, 1.0);
            canvas.ring((x, frame.y.at(mean)), 1.7, Pen::new(PAPER, stroke::THIN));
        }
    }
    let base = frame.place.top + room - 3.0;
    for bracket in &brackets {
        let y = base - bracket.level as f64 * STEP;
        let (from, to) = (
            frame.x.at(bracket.from as f64),
            frame.x.at(bracket.to as f64),
        );
        let pen = Pen::new(INK, stroke::AXIS);
        canvas.path(
            &[
                (from + 1.0, y + 2.0),
                (from + 1.0, y),
                (to - 1.0, y),
                (to - 1.0, y + 2.0),
            ],
            pen,
        );
        let look = Look::new(size::SMALL).middle();
        canvas.text(bracket.text, (f64::midpoint(from, to), y - 1.8), look);
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
        if n < 2 {
            0.0
        } else {
            (turn - 0.5) * 2.0 * JITTER * slot
        }
    };
    let at = |index: usize, column: usize, value: f64| {
        (
            frame.x.at(column as f64) + POINTS * slot + jitter(index),
            frame.y.at(value),
        )
    };
    let pen = Pen::new(GREY, stroke::THIN).alpha(0.35);
    for (index, row) in panel.rows.iter().enumerate() {
        let mut path = Vec::new();
        for (column, value) in row.iter().enumerate() {
            match value {
                Some(value) => path.push(at(index, column, *value)),
                None => canvas.path(&std::mem::take(&mut path), pen),
            }
        }
        canvas.path(&path, pen);
    }
    for (column, of) in panel.slots.iter().enumerate() {
        for (index, row) in panel.rows.iter().enumerate() {
            if let Some(value) = row[column] {
                let place = at(index, column, value);
                canvas.marker(place, stroke::POINT, of.look.0, of.look.1);
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

/// Shortest first, each on the lowest level where it meets no other.
fn brackets(contrasts: &[(usize, usize, String)]) -> Vec<Bracket<'_>> {
    let mut spans: Vec<(usize, usize, &str)> = contrasts
        .iter()
        .map(|(a, b, text)| (*a.min(b), *a.max(b), text.as_str()))
        .collect();
    spans.sort_by_key(|(from, to, _)| (to - from, *from));
    let mut out: Vec<Bracket<'_>> = Vec::new();
    for (from, to, text) in spans {
        let mut level = 0;
        while out
            .iter()
            .any(|b| b.level == level && b.from < to && from < b.to)
        {
            level += 1;
        }
        out.push(Bracket {
            from,
            to,
            level,
            text,
        });
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
