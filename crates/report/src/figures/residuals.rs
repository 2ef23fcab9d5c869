//! What the networks' predictions leave over.

use super::axes::{Frame, Labels, Scale};
use super::canvas::Pen;
use super::check::Check;
use super::theme::{GREY, INK, TWO_COLUMNS_MM, stroke};
use super::{Context, Figure, Plan, Shows, draw};
use crate::apa::number;
use crate::error::ReportError;
use serde::{Deserialize, Serialize};

/// Histograms of residuals side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// A panel a network.
    pub panels: Vec<ResidualPanel>,
    /// Drives whose rows these are.
    pub drives: usize,
}

/// One network's residuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResidualPanel {
    /// Such as `Ego speed (V)`.
    pub title: String,
    /// Title of the axis with the unit: `Recorded − predicted (m/s)`.
    pub axis: String,
    /// Unit, for words: `m/s`.
    pub unit: String,
    /// Edges of the bins, ascending, one more than counts.
    pub edges: Vec<f64>,
    /// Rows in each bin.
    pub counts: Vec<usize>,
    /// Mean of the residuals, in the unit.
    pub mean: f64,
    /// Root-mean-square of the residuals, in the unit.
    pub rms: f64,
}

const NAME: &str = "residuals";

/// Draws a histogram a panel, with zero and the mean marked.
///
/// # Errors
/// [`ReportError`] if there is no panel, edges do not ascend or do not fit the counts, or a value is not finite.
pub fn residuals(input: &Residuals, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.at_least(1, "bins", panel.counts.len())?;
        check.length("edges", panel.edges.len(), panel.counts.len() + 1)?;
        check.finite("edges", panel.edges.iter().copied())?;
        check.finite("mean and root-mean-square", [panel.mean, panel.rms])?;
        for pair in panel.edges.windows(2) {
            check.that(pair[0] < pair[1], "edges", pair[1], "ascending edges")?;
        }
    }
    let rows: Vec<String> = input
        .panels
        .iter()
        .map(|panel| {
            format!(
                "{} rows ({})",
                panel.counts.iter().sum::<usize>(),
                panel.title
            )
        })
        .collect();
    let found: Vec<String> = input
        .panels
        .iter()
        .map(|panel| {
            format!(
                "{}: mean {} {unit}, root-mean-square {} {unit}.",
                panel.title,
                number(panel.mean, 2),
                number(panel.rms, 2),
                unit = panel.unit
            )
        })
        .collect();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, 58.0),
        title: "What the predictions leave over".to_owned(),
        caption: format!(
            "Residuals of the networks on recorded windows, own embedding. Dashed: no error; solid: the mean. \
             *n* = {}, {} drives.",
            rows.join(", "),
            input.drives
        ),
        alt: found.join(" "),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, whole| {
        let columns = input.panels.len().max(2);
        for (index, panel) in input.panels.iter().enumerate() {
            let place = whole.cell((index, 0), (columns, 1), (14.0, 0.0));
            let total = panel.counts.iter().sum::<usize>().max(1) as f64;
            let share = |count: usize| 100.0 * count as f64 / total;
            let most = panel.counts.iter().map(|&c| share(c)).fold(0.0, f64::max);
            let (low, high) = (panel.edges[0], panel.edges[panel.counts.len()]);
            let subtitle = format!(
                "mean {} {unit}, root-mean-square {} {unit}",
                number(panel.mean, 2),
                number(panel.rms, 2),
                unit = panel.unit
            );
            let labels = Labels {
                title: &panel.title,
                subtitle: &subtitle,
                x: &panel.axis,
                y: "Rows (%)",
                ..Labels::default()
            };
            let x = Scale::between(low, high, 6);
            let y = Scale::between(0.0, 1.05 * most.max(0.1), 4);
            let frame = Frame::draw(canvas, place, &labels, x, y);
            for (pair, &count) in panel.edges.windows(2).zip(&panel.counts) {
                let (left, base) = frame.at(pair[0], 0.0);
                let (right, top) = frame.at(pair[1], share(count));
                canvas.fill_rect((left, top), (right - 0.3, base), GREY, 0.55);
            }
            let (bottom, top) = (frame.place.bottom, frame.place.top);
            let marks = [
                (0.0, Pen::new(INK, stroke::AXIS).dashed(2.0, 2.0)),
                (panel.mean, Pen::new(INK, stroke::STRONG)),
            ];
            for (value, pen) in marks {
                if (low..=high).contains(&value) {
                    let x = frame.x.at(value);
                    canvas.line((x, bottom), (x, top), pen);
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_that_do_not_ascend_are_refused() {
        let panel = ResidualPanel {
            title: "Ego speed".into(),
            axis: "Recorded − predicted (m/s)".into(),
            unit: "m/s".into(),
            edges: vec![0.0, 1.0, 1.0],
            counts: vec![2, 3],
            mean: 0.5,
            rms: 0.7,
        };
        let input = Residuals {
            panels: vec![panel],
            drives: 1,
        };
        let refused = residuals(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}
