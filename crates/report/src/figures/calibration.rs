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
    let share = "a share, 0 to 1";
    for bin in &input.bins {
        check.within((0.0, 1.0), "predicted", [bin.predicted], share)?;
        check.within((0.0, 1.0), "observed", [bin.observed], share)?;
        let seconds = bin.seconds;
        check.that(seconds >= 1.0, "seconds", seconds, "a second at least")?;
    }
    let numbers = input.bins.iter().map(|b| b.seconds);
    check.finite("expected_error and seconds", numbers.chain([input.expected_error]))?;
    let observed: Vec<[f64; 4]> = input.bins.iter().map(CalibrationBin::percent).collect();
    // A bin of few seconds has an interval up to 100: points, not its end, set the axis.
    let most = observed.iter().map(|[x, y, ..]| x.max(*y));
    let top = (1.25 * most.fold(2.0, f64::max)).min(100.0);
    draw(plan(input), context, |canvas, place| {
        let labels =
            Labels { x: "Predicted probability (%)", y: "Observed share (%)", ..Labels::default() };
        let x = Scale::between(0.0, top, 5);
        let mut panel = Panel::open(canvas, place, &labels, (x.clone(), x));
        let alike = Pen::new(GREY, stroke::AXIS).dashed(3.0, 2.0);
        panel.line([(0.0, 0.0), (top, top)], alike);
        let pen = Pen::new(MUTED, stroke::BOX);
        for [x, share, low, high] in observed {
            panel.upright_interval(x, [share, low, high], pen, (2.2, Marker::Circle, INK));
        }
        let look = Look::new(size::SMALL).end().colour(MUTED);
        let Place { right, bottom, .. } = panel.frame.place;
        let error = format!("calibration error {} points", error(input));
        canvas.text(&error, (right - 2.0, bottom - 4.0), look);
    })
}

impl CalibrationBin {
    /// Predicted, observed and the ends of its Wilson interval, in per cent.
    fn percent(&self) -> [f64; 4] {
        let trials = self.seconds.round() as usize;
        let events = ((self.observed * self.seconds).round() as usize).min(trials);
        let ends = proportion(events, trials, 0.95);
        let (low, high) = ends.map_or((0.0, 1.0), |share| (share.low, share.high));
        [self.predicted, self.observed, low, high].map(|share| 100.0 * share)
    }
}

fn error(input: &Calibration) -> String {
    number(100.0 * input.expected_error, 2)
}

fn plan(input: &Calibration) -> Plan {
    let seconds: f64 = input.bins.iter().map(|bin| bin.seconds).sum();
    let changing = input.bins.iter().map(|bin| bin.observed * bin.seconds);
    let whose = if input.held_out { "did not learn" } else { "learned" };
    let error = error(input);
    Plan {
        name: NAME.to_owned(),
        size_mm: (ONE_COLUMN_MM, 72.0),
        title: "Calibration of the lane-change probability".to_owned(),
        caption: format!(
            "Share of time in which a lane change was being started against the predicted probability, in bins; \
             95% Wilson intervals, a second a trial; the line is where both agree. Driving that the networks {whose} from. Expected \
             calibration error: {error} percentage points. *n* = {} s of driving, {} s of them with a change \
             starting, {} drives; no test.",
            number(seconds, 0),
            number(changing.sum(), 0),
            input.drives
        ),
        alt: format!(
            "Over {} bins the observed share differs from the predicted one by {error} percentage points on average.",
            input.bins.len()
        ),
        shows: Shows::Participants,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_above_one_is_refused() {
        let bin = CalibrationBin { predicted: 0.1, observed: 1.2, seconds: 20.0 };
        let input = Calibration { bins: vec![bin], expected_error: 0.0, drives: 1, held_out: true };
        let refused = calibration(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }
}
