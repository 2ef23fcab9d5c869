//! Whether a predicted probability of a lane change means what it says.

use super::prelude::*;
use maveric_stats::proportion;

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

/// Moments with about the same predicted probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CalibrationBin {
    /// Mean predicted probability, 0 to 1.
    pub predicted: f64,
    /// Share of the time in which a change was being started, 0 to 1.
    pub observed: f64,
    /// Time in the bin, in s.
    pub seconds: f64,
}

const NAME: &str = "calibration";

/// Draws observed shares with Wilson intervals against predicted ones, and the line where both agree.
///
/// # Errors
/// [`ReportError`] if there is no bin, a bin lasts no second, or a share is not in 0..=1.
///
/// # Source
/// Wilson intervals take each second for one trial: the second before a change is one event (method section 2),
/// however many samples it has.
pub fn calibration(input: &Calibration, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "bins", input.bins.len())?;
    for bin in &input.bins {
        for (field, share) in [("predicted", bin.predicted), ("observed", bin.observed)] {
            check.that(
                (0.0..=1.0).contains(&share),
                field,
                share,
                "a share, 0 to 1",
            )?;
        }
        check.that(
            bin.seconds >= 1.0,
            "seconds",
            bin.seconds,
            "a second at least",
        )?;
    }
    check.finite(
        "expected_error and seconds",
        input
            .bins
            .iter()
            .map(|b| b.seconds)
            .chain([input.expected_error]),
    )?;
    let seconds: f64 = input.bins.iter().map(|bin| bin.seconds).sum();
    let changing: f64 = input
        .bins
        .iter()
        .map(|bin| bin.observed * bin.seconds)
        .sum();
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
            "Share of time in which a lane change was being started against the predicted probability, in bins; \
             95% Wilson intervals, a second a trial; the line is where both agree. Driving {whose}. Expected \
             calibration error: {error} percentage points. *n* = {} s of driving, {} s of them with a change \
             starting, {} drives; no test.",
            number(seconds, 0),
            number(changing, 0),
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
            let trials = bin.seconds.round() as usize;
            let events = ((bin.observed * bin.seconds).round() as usize).min(trials);
            let (low, high) = proportion(events, trials, 0.95)
                .map_or((0.0, 1.0), |share| (share.low, share.high));
            (bin.predicted, bin.observed, low, high)
        })
        .collect();
    // A bin of few seconds has an interval up to 1: points, not its end, set the axis.
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
    fn a_share_above_one_is_refused() {
        let bin = CalibrationBin {
            predicted: 0.1,
            observed: 1.2,
            seconds: 20.0,
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
