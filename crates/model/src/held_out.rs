//! What is said of rows that were not learned from, and how far off it is.

use crate::{
    losses::surprise,
    rows::{Row, RowWeights},
};
use serde::{Deserialize, Serialize};

/// What is said of one row; `None` where nothing of the kind is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Said {
    pub(crate) following_distance_m: Option<f64>,
    /// Log-odds of a lane change being started, both classes at one half.
    pub(crate) log_odds: Option<f64>,
    pub(crate) speed_mps: Option<f64>,
}

/// How far off it is over some rows; `None` where nothing of the kind is said, or there is no such row.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct HeldOut {
    /// Root-mean-square error of the following distance, in m, over following rows.
    pub following_distance_m: Option<f64>,
    /// Cross-entropy of starting a lane change, in nats, both classes weighted to one half over the other drivers.
    pub lane_change: Option<f64>,
    /// Root-mean-square error of ego's speed, in m/s.
    pub speed_mps: Option<f64>,
}

impl HeldOut {
    pub(crate) fn from_predictions<'a>(
        predictions: impl IntoIterator<Item = (Said, &'a Row)>,
        weights: &RowWeights,
    ) -> Self {
        let mut sums = [(0.0, 0.0); 3];
        for (prediction, row) in predictions {
            let [following, change, grid, _] = weights.of_row(row);
            let squared = |a: Option<f64>, b: Option<f64>| Some((a? - b?).powi(2));
            let surprised = prediction.log_odds.zip(row.lane_change);
            let surprised =
                surprised.map(|(odds, change)| surprise(if change { -odds } else { odds }));
            let gap = squared(prediction.following_distance_m, row.following_distance_m);
            let speed = squared(prediction.speed_mps, Some(row.ego_speed_mps));
            let losses = [(gap, following), (surprised, change), (speed, grid)];
            for (sum, (loss, weight)) in sums.iter_mut().zip(losses) {
                if let Some(loss) = loss.filter(|_| weight > 0.0) {
                    *sum = (sum.0 + weight * loss, sum.1 + weight);
                }
            }
        }
        let [following, change, speed] =
            sums.map(|(loss, weight)| (weight > 0.0).then(|| loss / weight));
        Self {
            following_distance_m: following.map(f64::sqrt),
            lane_change: change,
            speed_mps: speed.map(f64::sqrt),
        }
    }
}

/// The rows by whose first share a driver is known, and those that judge; `None` if either would be empty.
pub(crate) fn cut(rows: &[Row], known: f64) -> Option<(&[Row], &[Row])> {
    let grid: Vec<usize> = (0..rows.len()).filter(|&i| rows[i].on_grid).collect();
    let first = (known * grid.len() as f64).floor() as usize;
    (first > 0 && first < grid.len()).then(|| rows.split_at(grid[first]))
}
