//! How good a trained model's predictions are: is C's probability one, and how far are F and V off?

use crate::{dataset::RowSet, fused::tile::Predicted, rows::RowWeights, scaling::Scaling};
use serde::{Deserialize, Serialize};

/// Bins of a [`Calibration`], each with about the same time.
const BINS: usize = 10;

/// Shares at which [`Residuals`] are given.
const SHARES: [f64; 9] = [0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99];

/// Which rows a [`Quality`] was taken over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RowsOf {
    /// The last part of every drive, not learned from.
    Validation,
    /// The rows learned from.
    Training,
}

/// How good the predictions are over some rows, without noise on their windows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Which rows.
    pub on: RowsOf,
    /// How many.
    pub rows: usize,
    /// Of P(change); `None` without rows, or where no change was learned from.
    pub lane_change: Option<Calibration>,
    /// f̂ minus the gap, in m, over following rows.
    pub following_distance_m: Option<Residuals>,
    /// v̂ minus ego's speed, in m/s.
    pub speed_mps: Option<Residuals>,
}

/// Predicted against observed share of time at which a lane change is being started.
///
/// Rows are weighted by the time they stand for, since every row with a change is taken and of the others only
/// one a grid step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// From the lowest probabilities to the highest.
    pub bins: Vec<CalibrationBin>,
    /// Expected calibration error: the mean of |predicted − observed| over the bins, weighted by time.
    pub expected_calibration_error: f64,
    /// Share of time at which a change is being started.
    pub observed: f64,
    /// Mean predicted probability.
    pub predicted: f64,
}

/// Rows with similar probabilities.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CalibrationBin {
    /// Lowest probability.
    pub low: f64,
    /// Highest probability.
    pub high: f64,
    /// Mean probability.
    pub predicted: f64,
    /// Share of the time at which a change is being started.
    pub observed: f64,
    /// Rows.
    pub rows: usize,
    /// Rows among them at which a change is being started.
    pub changes: usize,
    /// Time they stand for, in s.
    pub seconds: f64,
}

/// Prediction minus observation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// Rows.
    pub rows: usize,
    /// Mean.
    pub mean: f64,
    /// Root of the mean square.
    pub rmse: f64,
    /// Quantiles, lowest first.
    pub quantiles: Vec<Quantile>,
}

/// One quantile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quantile {
    /// Share of the residuals below.
    pub share: f64,
    /// The residual.
    pub value: f64,
}

impl Quality {
    pub(crate) fn of(
        on: RowsOf,
        rows: &RowSet,
        predicted: &[Predicted],
        scaling: &Scaling,
        weights: &RowWeights,
    ) -> Self {
        let all = || predicted.iter().zip(&rows.values).zip(&rows.weights);
        let far = |sd: f64, a: f32, b: f32| sd * (f64::from(a) - f64::from(b));
        let distance = all().filter(|(_, w)| w[0] > 0.0).map(|((p, known), _)| {
            let sd = scaling.following_distance.sd;
            far(sd, p.following_distance, known[1])
        });
        let speed = all().filter(|(_, w)| w[2] > 0.0);
        let speed = speed.map(|((p, known), _)| far(scaling.signals[0].sd, p.speed, known[3]));
        let learned = weights.changing > 0.0;
        let times = predicted.iter().zip(&rows.values).zip(&rows.seconds);
        let chances = times.filter(|(_, s)| learned && **s > 0.0);
        let chances = chances.map(|((p, known), &seconds)| Chance {
            probability: calibrated(p.probability, weights.log_odds_raised),
            change: known[2] > 0.5,
            seconds: f64::from(seconds),
        });
        Self {
            on,
            rows: rows.len(),
            lane_change: Calibration::of(chances.collect()),
            following_distance_m: Residuals::of(distance.collect()),
            speed_mps: Residuals::of(speed.collect()),
        }
    }
}

/// The probability in the true proportion of classes.
fn calibrated(probability: f32, log_odds_raised: f64) -> f64 {
    let p = f64::from(probability).clamp(1e-12, 1.0 - 1e-12);
    1.0 / (1.0 + ((1.0 - p) / p) * log_odds_raised.exp())
}

/// A row as a chance to change lane.
#[derive(Debug, Clone, Copy)]
struct Chance {
    probability: f64,
    change: bool,
    seconds: f64,
}

impl Calibration {
    fn of(mut chances: Vec<Chance>) -> Option<Self> {
        chances.sort_by(|a, b| a.probability.total_cmp(&b.probability));
        let total: f64 = chances.iter().map(|c| c.seconds).sum();
        let mut bins: Vec<Vec<Chance>> = Vec::new();
        let mut before = 0.0;
        for chance in chances {
            let bin = ((before / total * BINS as f64) as usize).min(BINS - 1);
            before += chance.seconds;
            while bins.len() <= bin {
                bins.push(Vec::new());
            }
            bins[bin].push(chance);
        }
        let of_bin = |bin: &Vec<Chance>| {
            let (first, last) = (bin.first()?, bin.last()?);
            let seconds: f64 = bin.iter().map(|c| c.seconds).sum();
            let weighted = |of: &dyn Fn(&Chance) -> f64| -> f64 {
                bin.iter().map(|c| of(c) * c.seconds).sum::<f64>() / seconds
            };
            Some(CalibrationBin {
                low: first.probability,
                high: last.probability,
                predicted: weighted(&|c| c.probability),
                observed: weighted(&|c| f64::from(u8::from(c.change))),
                rows: bin.len(),
                changes: bin.iter().filter(|c| c.change).count(),
                seconds,
            })
        };
        let bins: Vec<CalibrationBin> = bins.iter().filter_map(of_bin).collect();
        let mean = |of: &dyn Fn(&CalibrationBin) -> f64| -> f64 {
            bins.iter().map(|b| of(b) * b.seconds).sum::<f64>() / total
        };
        (total > 0.0).then(|| Self {
            expected_calibration_error: mean(&|b| (b.predicted - b.observed).abs()),
            observed: mean(&|b| b.observed),
            predicted: mean(&|b| b.predicted),
            bins: bins.clone(),
        })
    }
}

impl Residuals {
    fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        let last = values.len().checked_sub(1)?;
        let quantiles = SHARES.map(|share| {
            // Between the two nearest, as R's type 7.
            let at = share * last as f64;
            let low = at.floor() as usize;
            let high = (low + 1).min(last);
            let between = at - low as f64;
            Quantile {
                share,
                value: values[low] + between * (values[high] - values[low]),
            }
        });
        Some(Self {
            rows: values.len(),
            mean: values.iter().sum::<f64>() / n,
            rmse: (values.iter().map(|v| v * v).sum::<f64>() / n).sqrt(),
            quantiles: quantiles.to_vec(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn true_probabilities_have_no_calibration_error_and_doubled_ones_do() {
        // At probability p in ten, p of every ten rows have a change.
        let chances = |factor: f64| {
            let rows = (0..10).flat_map(|p| (0..10).map(move |i| (p, i)));
            rows.map(|(p, i)| Chance {
                probability: factor * f64::from(p) / 10.0,
                change: i < p,
                seconds: 1.0,
            })
            .collect()
        };
        let good = Calibration::of(chances(1.0)).unwrap();
        assert_eq!(good.bins.len(), BINS);
        assert!(good.expected_calibration_error < 1e-12);
        assert!((good.observed - 0.45).abs() < 1e-12);
        let bad = Calibration::of(chances(0.5)).unwrap();
        assert!((bad.expected_calibration_error - 0.225).abs() < 1e-12);
        assert_eq!(Calibration::of(Vec::new()), None);
    }

    #[test]
    fn time_counts_and_not_rows() {
        // Nineteen twentieths of a second with a change against nine seconds without.
        let chance = |change: bool, seconds: f64| Chance {
            probability: 0.1,
            change,
            seconds,
        };
        let mut chances = vec![chance(true, 0.05); 20];
        chances.extend(vec![chance(false, 1.0); 9]);
        let found = Calibration::of(chances).unwrap();
        assert!((found.observed - 0.1).abs() < 1e-12);
        assert!((found.predicted - 0.1).abs() < 1e-12);
    }

    #[test]
    fn residuals_have_their_moments_and_quantiles() {
        let found = Residuals::of((-50..=50).map(f64::from).collect()).unwrap();
        assert!(found.mean.abs() < 1e-12);
        assert!((found.rmse - 850.0_f64.sqrt()).abs() < 1e-12);
        assert!((found.quantiles[0].value + 49.0).abs() < 1e-12);
        assert!((found.quantiles[4].value).abs() < 1e-12);
        assert_eq!(Residuals::of(Vec::new()), None);
    }

    #[test]
    fn raised_odds_are_lowered_again() {
        let p = 0.02_f64;
        let raised = (p / (1.0 - p)).ln() + 3.0;
        let shown = 1.0 / (1.0 + (-raised).exp());
        assert!((calibrated(shown as f32, 3.0) - p).abs() < 1e-6);
    }
}
