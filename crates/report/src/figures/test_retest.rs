//! Is Mimic as near to its driver as the driver is to themselves? Driver by driver.

use super::axes::{Frame, Labels, Place, Scale};
use super::canvas::{Canvas, Key, Pen};
use super::check::Check;
use super::fit;
use super::theme::{GRID, INK, MUTED, Marker, PURPLE, TWO_COLUMNS_MM, stroke};
use super::{Context, Figure, Plan, Shows, draw};
use crate::apa::number;
use crate::error::ReportError;
use crate::markup;
use serde::{Deserialize, Serialize};

/// Accuracies of drivers who drove twice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestRetest {
    /// The measures, from top to bottom.
    pub measures: Vec<RetestMeasure>,
}

/// One measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RetestMeasure {
    /// Such as `Mean velocity`.
    pub title: String,
    /// For each driver the accuracy (1 is the same) of their own second drive and of Mimic, both against the first
    /// drive; `None`: that drive has no value.
    pub drivers: Vec<(Option<f64>, Option<f64>)>,
}

const NAME: &str = "test-retest";
const ROW: f64 = 20.0;

/// A mean with half its 95% interval.
#[derive(Debug, Clone, Copy)]
struct Mean {
    mean: f64,
    half: f64,
}

impl Mean {
    fn of(values: &[f64]) -> Option<Self> {
        let mean = fit::mean(values)?;
        let n = values.len();
        let half = if n > 1 {
            fit::t_975(n - 1) * fit::standard_deviation(values) / (n as f64).sqrt()
        } else {
            0.0
        };
        Some(Self { mean, half })
    }

    fn written(self) -> String {
        let percent = |share: f64| number(100.0 * share, 1);
        let (low, high) = (self.mean - self.half, self.mean + self.half);
        format!(
            "{} [{}, {}]",
            percent(self.mean),
            percent(low),
            percent(high)
        )
    }
}

/// What is drawn of one measure: only drivers with both accuracies.
struct Row {
    title: String,
    n: usize,
    own: Mean,
    mimic: Mean,
    difference: Mean,
}

impl Row {
    fn of(measure: &RetestMeasure) -> Option<Self> {
        let pairs = || {
            measure
                .drivers
                .iter()
                .filter_map(|(own, mimic)| Some(((*own)?, (*mimic)?)))
        };
        let own: Vec<f64> = pairs().map(|pair| pair.0).collect();
        let mimic: Vec<f64> = pairs().map(|pair| pair.1).collect();
        let differences: Vec<f64> = pairs().map(|(own, mimic)| mimic - own).collect();
        Some(Self {
            title: markup::literal(&measure.title),
            n: own.len(),
            own: Mean::of(&own)?,
            mimic: Mean::of(&mimic)?,
            difference: Mean::of(&differences)?,
        })
    }
}

/// Draws both accuracies with 95% intervals over drivers, and beside them the paired difference with its own.
///
/// # Errors
/// [`ReportError`] if there is no measure, a measure has no driver with both accuracies, or a value is not finite.
///
/// # Source
/// Method, section 9.2: accuracy. A driver's own second drive as the most that can be asked is ours.
pub fn test_retest(input: &TestRetest, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "measures", input.measures.len())?;
    let mut rows = Vec::new();
    for measure in &input.measures {
        let values = measure
            .drivers
            .iter()
            .flat_map(|(own, mimic)| [*own, *mimic]);
        check.finite(&measure.title, values.flatten())?;
        let what = format!("drivers with both accuracies of {}", measure.title);
        let row = Row::of(measure);
        check.at_least(1, &what, row.as_ref().map_or(0, |row| row.n))?;
        rows.extend(row);
    }
    let low = rows.iter().map(|row| row.n).min().unwrap_or(0);
    let high = rows.iter().map(|row| row.n).max().unwrap_or(0);
    let n = if low == high {
        format!("{low}")
    } else {
        format!("{low} to {high}")
    };
    let found: Vec<String> = rows
        .iter()
        .map(|row| {
            format!(
                "{}: own second drive {}%, Mimic {}%, difference {} points.",
                markup::plain(&row.title),
                row.own.written(),
                row.mimic.written(),
                row.difference.written()
            )
        })
        .collect();
    let height = (46.0 + ROW * rows.len() as f64) / 72.0 * 25.4;
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (TWO_COLUMNS_MM, (height * 10.0).round() / 10.0),
        title: "Mimic beside the driver’s own second drive".to_owned(),
        caption: format!(
            "Left, accuracy (1 − |drive − first drive| / first drive) of each driver’s own second drive and of Mimic, \
             both against the first drive: mean over drivers with its 95% interval (*t*). Right, Mimic minus own \
             second drive, driver by driver, with the interval of that difference: right of the line Mimic is nearer. \
             *n* = {n} drivers a measure: those with a value in all three drives. Intervals are not adjusted for the \
             number of measures."
        ),
        alt: found.join(" "),
        shows: Shows::Participants,
    };
    let own = (Marker::Circle, INK);
    let mimic = (Marker::Square, PURPLE);
    draw(plan, context, |canvas, whole| {
        let keys = [
            (Key::Point(own.0, own.1), "own second drive"),
            (Key::Point(mimic.0, mimic.1), "Mimic"),
        ];
        let whole = canvas.legend(whole, &keys);
        let split = whole.left + 0.64 * (whole.right - whole.left);
        let left = Place {
            right: split - 8.0,
            ..whole
        };
        let right = Place {
            left: split + 8.0,
            ..whole
        };
        let last = rows.len() as f64 - 1.0;
        let names = rows.iter().enumerate();
        let ticks = names
            .map(|(k, row)| (last - k as f64, row.title.clone()))
            .collect();
        let ends = rows
            .iter()
            .flat_map(|row| reach(row.own).into_iter().chain(reach(row.mimic)));
        let labels = Labels {
            x: "Accuracy (%)",
            ..Labels::default()
        };
        let y = Scale::labelled(-0.6, last + 0.6, ticks);
        let frame = Frame::draw(canvas, left, &labels, Scale::over(ends, 6), y);
        for (index, row) in rows.iter().enumerate() {
            let y = last - index as f64;
            paint_mean(canvas, &frame, row.own, y + 0.16, own);
            paint_mean(canvas, &frame, row.mimic, y - 0.16, mimic);
        }
        let ends = rows
            .iter()
            .flat_map(|row| reach(row.difference))
            .chain([0.0]);
        let labels = Labels {
            x: "Mimic − own second drive (% points)",
            ..Labels::default()
        };
        let y = Scale::labelled(-0.6, last + 0.6, Vec::new());
        let frame = Frame::draw(canvas, right, &labels, Scale::over(ends, 4), y);
        for (index, row) in rows.iter().enumerate() {
            let y = last - index as f64;
            let across = (frame.at(frame.x.low(), y), frame.at(frame.x.high(), y));
            canvas.line(across.0, across.1, Pen::new(GRID, stroke::THIN));
            paint_mean(canvas, &frame, row.difference, y, (Marker::Diamond, INK));
        }
        let zero = frame.x.at(0.0);
        let dashed = Pen::new(MUTED, stroke::AXIS).dashed(2.0, 1.5);
        canvas.line((zero, frame.place.bottom), (zero, frame.place.top), dashed);
    })
}

fn reach(mean: Mean) -> [f64; 2] {
    [mean.mean - mean.half, mean.mean + mean.half].map(|share| 100.0 * share)
}

fn paint_mean(
    canvas: &mut Canvas<'_>,
    frame: &Frame,
    mean: Mean,
    y: f64,
    (marker, colour): (Marker, plotters::style::RGBColor),
) {
    let [low, high] = reach(mean);
    canvas.line(
        frame.at(low, y),
        frame.at(high, y),
        Pen::new(colour, stroke::STRONG),
    );
    canvas.marker(frame.at(100.0 * mean.mean, y), 2.2, marker, colour);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_without_one_of_the_two_is_left_out_of_both() {
        let measure = RetestMeasure {
            title: "Merge back".into(),
            drivers: vec![
                (Some(0.9), Some(0.8)),
                (Some(0.2), None),
                (Some(0.7), Some(0.7)),
            ],
        };
        let row = Row::of(&measure).unwrap();
        assert_eq!(row.n, 2);
        assert!((row.own.mean - 0.8).abs() < 1e-12);
        assert!((row.difference.mean + 0.05).abs() < 1e-12);
    }

    #[test]
    fn nobody_with_both_is_refused_by_name() {
        let measures = vec![RetestMeasure {
            title: "Merge back".into(),
            drivers: vec![(Some(0.9), None)],
        }];
        let refused = test_retest(&TestRetest { measures }, &Context::real()).unwrap_err();
        assert!(
            refused
                .to_string()
                .contains("both accuracies of Merge back, got 0")
        );
    }
}
