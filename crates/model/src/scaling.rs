//! Standardising by the training set's mean and SD, stored with the weights.

use crate::windows::SIGNALS;
use serde::{Deserialize, Serialize};

/// Mean and standard deviation of one quantity, in its own unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Standardization {
    pub(crate) mean: f64,
    /// Standard deviation; 1 where the quantity did not vary.
    pub(crate) sd: f64,
}

impl Standardization {
    /// Mean and SD of `values`; 0 and 1 of nothing.
    pub(crate) fn from_values(values: impl Iterator<Item = f64> + Clone) -> Self {
        let n = values.clone().count() as f64;
        if n < 1.0 {
            return Self { mean: 0.0, sd: 1.0 };
        }
        let mean = values.clone().sum::<f64>() / n;
        let variance = values.map(|v| (v - mean) * (v - mean)).sum::<f64>() / n;
        // Rounding alone must not be blown up to unit variance.
        let least = 1e-6 * (1.0 + mean.abs());
        let sd = if variance.sqrt() > least { variance.sqrt() } else { 1.0 };
        Self { mean, sd }
    }

    /// In standard deviations from the mean.
    pub(crate) fn apply(&self, value: f64) -> f64 {
        (value - self.mean) / self.sd
    }

    /// Back in the quantity's unit.
    pub(crate) fn undo(&self, standardized: f64) -> f64 {
        self.mean + self.sd * standardized
    }
}

/// Every quantity the networks read or predict.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Scaling {
    /// The signals of a window; the first also scales V's target, ego speed.
    pub(crate) signals: [Standardization; SIGNALS],
    /// The gap in following rows, in m.
    pub(crate) following_distance: Standardization,
    /// The score, in points.
    pub(crate) aggression: Standardization,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_is_only_shifted() {
        let s = Standardization::from_values([3.0, 3.0, 3.0].into_iter());
        assert!((s.apply(3.0)).abs() < 1e-12);
        assert!((s.sd - 1.0).abs() < 1e-12);
    }

    #[test]
    fn undo_is_the_inverse() {
        let s = Standardization::from_values([1.0, 2.0, 6.0].into_iter());
        assert!((s.undo(s.apply(4.2)) - 4.2).abs() < 1e-12);
    }
}
