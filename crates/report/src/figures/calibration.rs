//! Whether a predicted probability of a lane change means what it says.

use super::axes::{Frame, Labels, Scale};
use super::canvas::{Look, Pen};
use super::check::Check;
use super::theme::{GREY, INK, MUTED, Marker, ONE_COLUMN_MM, size, stroke};
use super::{Context, Figure, Plan, Shows, draw};
use crate::apa::number;
use crate::error::ReportError;
use maveric_stats::proportion;
use serde::{Deserialize, Serialize};

/// Predicted probabilities, binned, beside how often the event came.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// The bins, in order of the probability; empty ones left out.
    pub bins: Vec<CalibrationBin>,
    /// Expected calibration error: the mean distance of predicted and observed, weighted by rows.
    pub expected_error: f64,
    /// Drives whose rows these are.
    pub drives: usize,
    /// Whether the networks learned from these rows.
    pub held_out: bool,
}

/// Rows with about the same predicted probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CalibrationBin {
    /// Mean predicted probability, 0 to 1.
    pub predicted: f64,
    /// Rows in which a change was being started.
    pub events: usize,
    /// Rows.
    pub rows: usize,
}

const NAME: &str = "calibration";

/// Draws observed shares with Wilson intervals against predicted ones, and the line where both agree.
///
/// # Errors
/// [`ReportError`] if there is no bin, a bin has no rows or more events than rows, or a probability is not in
/// 0..=1.
pub fn calibration(input: &Calibration, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "bins", input.bins.len())?;
    for bin in &input.bins {
        check.at_least(1, "rows of a bin", bin.rows)?;
        check.that(
            (0.0..=1.0).contains(&bin.predicted),
            "predicted",
            bin.predicted,
            "a probability",
        )?;
        check.that(
            bin.events <= bin.rows,
            "events",
            bin.events as f64,
            "at most the bin's rows",
        )?;
    }
    check.finite("expected_error", [input.expected_error])?;
    let rows: usize = input.bins.iter().map(|bin| bin.rows).sum();
    let events: usize = input.bins.iter().map(|bin| bin.events).sum();
    let error = number(100.0 * input.expected_error, 2);
    let whose = if input.held_out {
        "that the networks did not learn from"
    } else {
        "that the networks learned from"
    };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (ONE_COLUMN_MM, 72.0),
        title: "Calibration of the lane-change probability".to_owned(),
        caption: format!(
            "Share of rows in which a lane change was being started against the predicted probability, in bins; \
             95% Wilson intervals; the line is where both agree. Rows {whose}. Expected calibration error: \
             {error} percentage points. *n* = {rows} rows ({events} with a change) of {} drives.",
            input.drives
        ),
        alt: format!(
            "Over {} bins the observed share differs from the predicted one by {error} percentage points on average.",
            input.bins.len()
        ),
        shows: Shows::Participants,
    };
    let observed: Vec<(f64, f64, f64, f64)> = input
        .bins
        .iter()
        .map(|bin| {
            let (low, high) = proportion(bin.events, bin.rows, 0.95)
                .map_or((0.0, 1.0), |share| (share.low, share.high));
            (
                bin.predicted,
                bin.events as f64 / bin.rows as f64,
                low,
                high,
            )
        })
        .collect();
    // A bin of few rows has an interval up to 1: points, not its end, set the axis.
    let most = observed
        .iter()
        .map(|(p, o, ..)| p.max(*o))
        .fold(0.02, f64::max);
    let top = (1.25 * most).min(1.0);
    draw(plan, context, |canvas, place| {
        let labels = Labels {
            x: "Predicted probability (%)",
            y: "Observed share (%)",
            ..Labels::default()
        };
        let x = Scale::between(0.0, 100.0 * top, 5);
        let frame = Frame::draw(canvas, place, &labels, x.clone(), x);
        canvas.line(
            frame.at(0.0, 0.0),
            frame.at(100.0 * top, 100.0 * top),
            Pen::new(GREY, stroke::AXIS).dashed(3.0, 2.0),
        );
        for (predicted, share, low, high) in observed {
            let (low, high) = (100.0 * low.min(top), 100.0 * high.min(top));
            let at = 100.0 * predicted;
            canvas.line(
                frame.at(at, low),
                frame.at(at, high),
                Pen::new(MUTED, stroke::BOX),
            );
            canvas.marker(frame.at(at, 100.0 * share), 2.2, Marker::Circle, INK);
        }
        let look = Look::new(size::SMALL).end().colour(MUTED);
        let (right, bottom) = (frame.place.right - 2.0, frame.place.bottom - 4.0);
        canvas.text(
            &format!("calibration error {error} points"),
            (right, bottom),
            look,
        );
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_events_than_rows_are_refused() {
        let bin = CalibrationBin {
            predicted: 0.1,
            events: 3,
            rows: 2,
        };
        let input = Calibration {
            bins: vec![bin],
            expected_error: 0.0,
            drives: 1,
            held_out: true,
        };
        let refused = calibration(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}
