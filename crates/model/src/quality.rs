//! How good predictions are over some rows: is C's probability one, and how far are F and V off?

use crate::{
    held_out::Said,
    rows::{Row, RowWeights},
};
use serde::{Deserialize, Serialize};

/// Bins of a [`Calibration`], each with about the same time.
const BINS: usize = 10;

/// Shares at which [`Residuals`] are given.
const SHARES: [f64; 9] = [0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99];

/// How good the predictions are over some rows, without noise on their windows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Rows predicted, on the grid or not.
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
}

/// Rows with similar probabilities.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct CalibrationBin {
    /// Mean probability.
    pub predicted: f64,
    /// Share of the time at which a change is being started.
    pub observed: f64,
    /// Time they stand for, in s.
    pub seconds: f64,
}

/// Prediction minus observation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// Rows with a prediction and an observation.
    pub rows: usize,
    /// Mean: above 0 where predictions are too high.
    pub mean: f64,
    /// Root of the mean square.
    pub rmse: f64,
    /// Share of the residuals below, and the residual, lowest first.
    pub quantiles: Vec<(f64, f64)>,
}

impl Quality {
    /// Of what was said of rows, C having learned with these weights.
    pub(crate) fn from_predictions(predictions: &[(Said, &Row)], weights: &RowWeights) -> Self {
        let gap = |(s, r): &(Said, &Row)| Some(s.following_distance_m? - r.following_distance_m?);
        let speed = |(s, r): &(Said, &Row)| Some(s.speed_mps? - r.ego_speed_mps);
        let chance = |(s, r): &(Said, &Row)| {
            let odds = s.log_odds.filter(|_| weights.changing > 0.0)? - weights.log_odds_raised;
            Some(Chance {
                probability: 1.0 / (1.0 + libm::exp(-odds)),
                change: r.lane_change?,
                seconds: r.stands_for_s,
            })
        };
        let on_grid = predictions.iter().filter(|(_, r)| r.on_grid);
        Self {
            rows: predictions.len(),
            lane_change: Calibration::from_chances(predictions.iter().filter_map(chance).collect()),
            following_distance_m: Residuals::from_values(
                predictions.iter().filter_map(gap).collect(),
            ),
            speed_mps: Residuals::from_values(on_grid.filter_map(speed).collect()),
        }
    }
}

/// A row as a chance to change lane.
#[derive(Debug, Clone, Copy)]
struct Chance {
    probability: f64,
    change: bool,
    seconds: f64,
}

impl Calibration {
    fn from_chances(mut chances: Vec<Chance>) -> Option<Self> {
        chances.sort_by(|a, b| a.probability.total_cmp(&b.probability));
        let total: f64 = chances.iter().map(|c| c.seconds).sum();
        let mut bins = [CalibrationBin::default(); BINS];
        let mut before = 0.0;
        for chance in chances {
            let bin = &mut bins[((before / total * BINS as f64) as usize).min(BINS - 1)];
            before += chance.seconds;
            bin.seconds += chance.seconds;
            bin.predicted += chance.seconds * chance.probability;
            bin.observed += chance.seconds * f64::from(u8::from(chance.change));
        }
        let mut bins = bins.to_vec();
        bins.retain(|b| b.seconds > 0.0);
        let (mut error, mut observed) = (0.0, 0.0);
        for bin in &mut bins {
            error += (bin.predicted - bin.observed).abs() / total;
            observed += bin.observed / total;
            bin.predicted /= bin.seconds;
            bin.observed /= bin.seconds;
        }
        (total > 0.0).then_some(Self { expected_calibration_error: error, observed, bins })
    }
}

impl Residuals {
    fn from_values(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        let last = values.len().checked_sub(1)?;
        let quantiles = SHARES.map(|share| {
            // Between the two nearest, as R's type 7.
            let position = share * last as f64;
            let low = position.floor() as usize;
            let high = (low + 1).min(last);
            let between = position - low as f64;
            (share, values[low] + between * (values[high] - values[low]))
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
        let good = Calibration::from_chances(chances(1.0)).unwrap();
        assert_eq!(good.bins.len(), BINS);
        assert!(good.expected_calibration_error < 1e-12);
        assert!((good.observed - 0.45).abs() < 1e-12);
        let bad = Calibration::from_chances(chances(0.5)).unwrap();
        assert!((bad.expected_calibration_error - 0.225).abs() < 1e-12);
        assert_eq!(Calibration::from_chances(Vec::new()), None);
    }

    #[test]
    fn time_counts_and_not_rows() {
        // Nineteen twentieths of a second with a change against nine seconds without.
        let chance = |change: bool, seconds: f64| Chance { probability: 0.1, change, seconds };
        let mut chances = vec![chance(true, 0.05); 20];
        chances.extend(vec![chance(false, 1.0); 9]);
        let found = Calibration::from_chances(chances).unwrap();
        assert!((found.observed - 0.1).abs() < 1e-12);
        let predicted = found.bins.iter().map(|b| b.predicted * b.seconds).sum::<f64>();
        assert!((predicted - 1.0).abs() < 1e-12);
    }

    #[test]
    fn residuals_have_their_moments_and_quantiles() {
        let found = Residuals::from_values((-50..=50).map(f64::from).collect()).unwrap();
        assert!(found.mean.abs() < 1e-12);
        assert!((found.rmse - 850.0_f64.sqrt()).abs() < 1e-12);
        assert!((found.quantiles[0].1 + 49.0).abs() < 1e-12);
        assert!((found.quantiles[4].1).abs() < 1e-12);
        assert_eq!(Residuals::from_values(Vec::new()), None);
    }

    #[test]
    fn raised_odds_are_lowered_again() {
        let row = Row {
            window: Vec::new(),
            lead_speed_mps: 25.0,
            ego_speed_mps: 30.0,
            on_grid: true,
            following_distance_m: Some(40.0),
            lane_change: Some(false),
            stands_for_s: 1.0,
        };
        let weights =
            RowWeights { following: 1.0, changing: 1.0, keeping: 1.0, log_odds_raised: 3.0 };
        let said = Said {
            following_distance_m: Some(43.0),
            log_odds: Some((0.02_f64 / 0.98).ln() + 3.0),
            speed_mps: Some(29.0),
        };
        let found = Quality::from_predictions(&[(said, &row)], &weights);
        assert!((found.lane_change.unwrap().bins[0].predicted - 0.02).abs() < 1e-9);
        assert!((found.following_distance_m.unwrap().mean - 3.0).abs() < 1e-12);
        assert!((found.speed_mps.unwrap().mean + 1.0).abs() < 1e-12);
    }
}
