//! Every outcome, condition by condition: rainclouds.

use super::axes::{Frame, Labels, Place, Scale};
use super::canvas::{Canvas, Look, Pen};
use super::check::Check;
use super::crowd::MOST_POINTS;
use super::fit;
use super::raincloud::{self, BOX, Cloud};
use super::theme::{GREY, INK, MUTED, PAPER, TWO_COLUMNS_MM, size, stroke};
use super::{Context, Figure, Plan, Shows, draw};
use crate::apa;
use crate::error::ReportError;
use maveric_domain::ConditionId;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// The panels of the figure, in reading order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DifferencePanels {
    /// Any number of panels; three to a row.
    pub panels: Vec<DifferencePanel>,
    /// The drive that the values are differences from; none where some are not.
    pub from: Option<ConditionId>,
}

/// One measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DifferencePanel {
    /// Such as `Mean velocity`.
    pub title: String,
    /// Title of the axis with the unit, such as `Difference from own drive (mph)`.
    pub axis: String,
    /// The conditions, in the order of the columns of `rows`.
    pub conditions: Vec<ConditionId>,
    /// One row a participant, one value a condition, in the axis's unit; `None` is missing.
    pub rows: Vec<Vec<Option<f64>>>,
    /// The omnibus test, with marks, as [`crate::apa`] writes it. Shown as the subtitle.
    pub omnibus: String,
    /// Post-hoc pairs to be shown as brackets.
    pub pairs: Vec<PairTest>,
    /// Value at which a line is drawn (0 for a difference, 4 for "as aggressive as I am").
    pub reference: Option<f64>,
}

/// A post-hoc comparison.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairTest {
    /// One condition.
    pub first: ConditionId,
    /// The other.
    pub second: ConditionId,
    /// Its p value, adjusted after Holm.
    pub p_holm: f64,
}

const NAME: &str = "difference-panels";

/// Draws the panels: half violin, box, points, each participant's line, mean with within-subject
/// interval, omnibus test in the subtitle, Holm brackets.
///
/// # Errors
/// [`ReportError`] if there is no panel, a value is not finite, or a row is of the wrong length.
///
/// # Source
/// The paper's figure of six panels; method, section 9.3.
pub fn difference_panels(
    input: &DifferencePanels,
    context: &Context,
) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.at_least(1, "conditions", panel.conditions.len())?;
        check.at_least(1, "participants", panel.rows.len())?;
        for row in &panel.rows {
            check.length("a participant's row", row.len(), panel.conditions.len())?;
        }
        check.finite(&panel.title, panel.rows.iter().flatten().flatten().copied())?;
        check.finite("a pair's p", panel.pairs.iter().map(|pair| pair.p_holm))?;
        check.at_least(1, "values", panel.rows.iter().flatten().flatten().count())?;
    }
    let columns = input.panels.len().min(3);
    let rows = input.panels.len().div_ceil(3);
    let width = TWO_COLUMNS_MM * columns as f64 / 3.0;
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (width.max(85.0), 64.0 * rows as f64 + 3.0),
        title: match input.from {
            Some(from) => format!(
                "Difference between each condition and {}",
                context.look(from).words()
            ),
            None => "The outcomes in each condition".to_owned(),
        },
        caption: caption(input, context),
        alt: alternative(input, context),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, whole| {
        for (index, panel) in input.panels.iter().enumerate() {
            let place = whole.cell((index % 3, index / 3), (columns, rows), (10.0, 11.0));
            paint_panel(canvas, place, panel, context);
        }
    })
}

fn complete(panel: &DifferencePanel) -> Vec<Vec<f64>> {
    panel
        .rows
        .iter()
        .filter_map(|row| row.iter().copied().collect())
        .collect()
}

/// Conditions in which nobody has a value.
fn empty(panel: &DifferencePanel) -> impl Iterator<Item = ConditionId> {
    let nobody = |index: usize| panel.rows.iter().all(|row| row[index].is_none());
    let conditions = panel.conditions.iter().enumerate();
    conditions.filter_map(move |(index, &condition)| nobody(index).then_some(condition))
}

fn paint_panel(canvas: &mut Canvas<'_>, place: Place, panel: &DifferencePanel, context: &Context) {
    let k = panel.conditions.len();
    let brackets = brackets(panel);
    let clouds: Vec<Option<Cloud>> = (0..k)
        .map(|index| Cloud::of(panel.rows.iter().filter_map(|row| row[index]).collect()))
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
    let names = panel
        .conditions
        .iter()
        .enumerate()
        .map(|(index, condition)| (index as f64, context.look(*condition).short()));
    let x = Scale::labelled(-0.55, k as f64 - 0.4, names.collect());
    let labels = Labels {
        title: &panel.title,
        subtitle: &panel.omnibus,
        x: "",
        y: &panel.axis,
        ..Labels::default()
    };
    let frame = Frame::draw(canvas, place, &labels, x, y);
    if let Some(reference) = panel.reference {
        frame.rule(canvas, reference);
    }
    let slot = (frame.place.right - frame.place.left) / (k as f64 + 0.15);
    if panel.rows.len() <= MOST_POINTS {
        paint_participants(canvas, &frame, panel, slot, context);
    }
    let rows = complete(panel);
    let half_widths = fit::within_subject_half_widths(&rows);
    for (index, &condition) in panel.conditions.iter().enumerate() {
        let middle = frame.x.at(index as f64);
        let Some(cloud) = &clouds[index] else {
            let centre = f64::midpoint(frame.place.top + room, frame.place.bottom);
            let look = Look::new(size::SMALL).middle().centred().colour(MUTED);
            canvas.text("no values", (middle, centre), look.turned());
            continue;
        };
        raincloud::paint(
            canvas,
            &frame,
            cloud,
            (middle, slot),
            context.look(condition).rgb(),
        );
        let kept: Vec<f64> = rows.iter().map(|row| row[index]).collect();
        if let (Some(mean), Some(widths)) = (fit::mean(&kept), &half_widths) {
            let x = middle + BOX * slot;
            let half = widths[index];
            let ends = [frame.y.at(mean - half), frame.y.at(mean + half)];
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
        canvas.text(&bracket.text, (f64::midpoint(from, to), y - 1.8), look);
    }
}

/// Offsets of the points within a condition's slot, as shares of its width.
const POINTS: f64 = -0.2;
const JITTER: f64 = 0.09;
/// Height of a level of brackets, in points.
const STEP: f64 = 1.6 * size::SMALL;

fn paint_participants(
    canvas: &mut Canvas<'_>,
    frame: &Frame,
    panel: &DifferencePanel,
    slot: f64,
    context: &Context,
) {
    let n = panel.rows.len();
    // Jitter by the participant's place in the list: the same on every run, no generator.
    let jitter = |index: usize| {
        let turn = (index as f64 * 0.618_034).fract();
        if n < 2 {
            0.0
        } else {
            (turn - 0.5) * 2.0 * JITTER * slot
        }
    };
    let at = |index: usize, condition: usize, value: f64| {
        (
            frame.x.at(condition as f64) + POINTS * slot + jitter(index),
            frame.y.at(value),
        )
    };
    let pen = Pen::new(GREY, stroke::THIN).alpha(0.35);
    for (index, row) in panel.rows.iter().enumerate() {
        let mut path = Vec::new();
        for (condition, value) in row.iter().enumerate() {
            match value {
                Some(value) => path.push(at(index, condition, *value)),
                None => canvas.path(&std::mem::take(&mut path), pen),
            }
        }
        canvas.path(&path, pen);
    }
    for (column, &condition) in panel.conditions.iter().enumerate() {
        let look = context.look(condition);
        for (index, row) in panel.rows.iter().enumerate() {
            if let Some(value) = row[column] {
                let place = at(index, column, value);
                canvas.marker(place, stroke::POINT, look.marker(), look.rgb());
            }
        }
    }
}

#[derive(Debug)]
struct Bracket {
    from: usize,
    to: usize,
    level: usize,
    text: String,
}

/// Shortest first, each on the lowest level where it meets no other.
fn brackets(panel: &DifferencePanel) -> Vec<Bracket> {
    let place = |wanted: ConditionId| panel.conditions.iter().position(|&c| c == wanted);
    let mut spans: Vec<(usize, usize, f64)> = panel
        .pairs
        .iter()
        .filter_map(|pair| {
            let (a, b) = (place(pair.first)?, place(pair.second)?);
            Some((a.min(b), a.max(b), pair.p_holm))
        })
        .collect();
    spans.sort_by_key(|(from, to, _)| (to - from, *from));
    let mut out: Vec<Bracket> = Vec::new();
    for (from, to, p) in spans {
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
            text: apa::p(p).markup().to_owned(),
        });
    }
    out
}

fn caption(input: &DifferencePanels, context: &Context) -> String {
    let sizes: Vec<(usize, usize)> = input
        .panels
        .iter()
        .map(|panel| (complete(panel).len(), panel.rows.len()))
        .collect();
    let all = sizes.iter().map(|(_, all)| *all).max().unwrap_or(0);
    let low = sizes.iter().map(|(kept, _)| *kept).min().unwrap_or(0);
    let high = sizes.iter().map(|(kept, _)| *kept).max().unwrap_or(0);
    let complete = if low == high {
        format!("{low}")
    } else {
        format!("{low} to {high} (by panel)")
    };
    let points = if all > MOST_POINTS {
        "Points and lines of single participants are left out, there being too many."
    } else {
        "Each point is a participant, each thin line one participant across the conditions."
    };
    let what = match input.from {
        Some(from) => format!(
            "Difference from {}, where the axis says so",
            context.look(from).words()
        ),
        None => "What was measured and answered".to_owned(),
    };
    let mut shortened = String::new();
    for condition in input.panels.first().iter().flat_map(|p| &p.conditions) {
        let look = context.look(*condition);
        if look.short() != look.label {
            let _ = write!(shortened, " {}, {}.", look.short(), look.words());
        }
    }
    let nobody: Vec<String> = input
        .panels
        .iter()
        .flat_map(|panel| empty(panel).map(|c| (c, &panel.title)))
        .map(|(c, title)| {
            format!(
                " Nobody has a value of {title} in {}.",
                context.look(c).words()
            )
        })
        .collect();
    format!(
        "{what}. {points} Half violins are \
         kernel densities (to two bandwidths beyond the data), boxes quartiles with whiskers to 1.5 times their distance, black dots \
         means with within-subject 95% intervals (Cousineau–Morey). *n* = {all} participants, of \
         whom {complete} have a value in every condition and enter means, intervals and tests. \
         The omnibus test stands below each title; brackets carry *p* values after Holm.{shortened}{}",
        nobody.concat()
    )
}

fn alternative(input: &DifferencePanels, context: &Context) -> String {
    let mut words = Vec::new();
    for panel in &input.panels {
        let rows = complete(panel);
        let means: Vec<String> = panel
            .conditions
            .iter()
            .enumerate()
            .filter_map(|(index, condition)| {
                let values: Vec<f64> = rows.iter().map(|row| row[index]).collect();
                let mean = fit::mean(&values)?;
                Some(format!(
                    "{} {}",
                    context.look(*condition).label,
                    super::axes::number(mean, 2)
                ))
            })
            .collect();
        words.push(format!("{}: means {}.", panel.title, means.join(", ")));
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(rows: Vec<Vec<Option<f64>>>) -> DifferencePanels {
        let id = |text: &str| ConditionId::new(text).unwrap();
        let conditions = ["same", "faster", "slower", "sideways"].map(id);
        let pair = |second| PairTest {
            first: conditions[0],
            second,
            p_holm: 0.0004,
        };
        DifferencePanels {
            panels: vec![DifferencePanel {
                title: "Mean velocity".into(),
                axis: "Difference (mph)".into(),
                conditions: conditions.to_vec(),
                rows,
                omnibus: "*F*(3, 69) = 25.23".into(),
                pairs: conditions[1..].iter().copied().map(pair).collect(),
                reference: Some(0.0),
            }],
            from: Some(id("own")),
        }
    }

    fn rows(n: usize) -> Vec<Vec<Option<f64>>> {
        (0..n)
            .map(|i| {
                (0..4)
                    .map(|j| Some(((i * 7 + j * 3) % 11) as f64 - 5.0))
                    .collect()
            })
            .collect()
    }

    #[test]
    fn a_missing_cell_leaves_its_participant_out_of_the_means_and_says_so() {
        let mut rows = rows(6);
        rows[2][1] = None;
        let figure = difference_panels(&panel(rows), &Context::synthetic(1)).unwrap();
        assert!(figure.caption.contains("*n* = 6 participants, of whom 5"));
        assert!(figure.caption.ends_with("Synthetic participants."));
        assert!(figure.svg.contains("synthetic participants</text>"));
    }

    #[test]
    fn a_value_that_is_not_a_number_is_refused() {
        let mut rows = rows(6);
        rows[2][1] = Some(f64::NAN);
        let refused = difference_panels(&panel(rows), &Context::real());
        assert!(matches!(refused, Err(ReportError::NotFinite { .. })));
    }

    #[test]
    fn brackets_do_not_cross() {
        let input = panel(rows(6));
        let levels: Vec<usize> = brackets(&input.panels[0]).iter().map(|b| b.level).collect();
        assert_eq!(levels, [0, 1, 2]);
    }

    #[test]
    fn equal_values_and_a_single_participant_still_make_a_picture() {
        let same = panel(vec![vec![Some(0.0); 4]; 5]);
        assert!(difference_panels(&same, &Context::real()).is_ok());
        let one = panel(vec![vec![Some(1.0), Some(2.0), Some(3.0), Some(4.0)]]);
        assert!(difference_panels(&one, &Context::real()).is_ok());
    }

    #[test]
    fn a_condition_without_values_says_so_in_picture_and_caption() {
        let mut rows = rows(6);
        for row in &mut rows {
            row[2] = None;
        }
        let figure = difference_panels(&panel(rows), &Context::real()).unwrap();
        assert!(figure.svg.contains(">no values</text>"));
        let said = "Nobody has a value of Mean velocity in Slower.";
        assert!(figure.caption.contains(said), "{}", figure.caption);
    }

    #[test]
    fn ten_thousand_participants_make_no_ten_thousand_points() {
        let figure = difference_panels(&panel(rows(10_000)), &Context::real()).unwrap();
        assert!(figure.svg.len() < 60_000);
    }
}
