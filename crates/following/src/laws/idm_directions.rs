//! IDM along the directions in which other drivers differ.

use super::{Parametric, idm::Idm};
use nalgebra::{Matrix5, SVector, SymmetricEigen};
use serde::{Deserialize, Serialize};

/// Directions at most: as many as an embedding has numbers.
const MOST: usize = 3;
/// Standard deviations that a driver may be away from the mean along each.
const REACH: f64 = 3.0;

/// Means and principal directions of several drivers' IDM parameters, on a logarithmic scale.
///
/// A linear style space of the parameters, fitted in two steps: what a learned embedding has to be better than.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IdmDirections {
    /// Mean logarithm of v0, T, s0, a and b.
    pub mean: [f64; 5],
    /// One standard deviation along each direction, the widest first; fewer than the drivers, three at most.
    pub directions: Vec<[f64; 5]>,
}

impl IdmDirections {
    /// The directions of laws that were fitted one by one; none from a single law.
    pub fn of(laws: &[Idm]) -> Self {
        let logs: Vec<[f64; 5]> = laws
            .iter()
            .map(|law| law.parameters().map(f64::ln))
            .collect();
        let points: Vec<SVector<f64, 5>> = logs.into_iter().map(SVector::from).collect();
        let n = points.len().max(1) as f64;
        let mean = points.iter().sum::<SVector<f64, 5>>() / n;
        let away = points.iter().map(|p| p - mean);
        let covariance: Matrix5<f64> = away.map(|d| d * d.transpose() / n).sum();
        let found = SymmetricEigen::new(covariance);
        let mut order: Vec<usize> = (0..5).collect();
        order.sort_by(|&a, &b| found.eigenvalues[b].total_cmp(&found.eigenvalues[a]));
        let directions = order
            .into_iter()
            .take(MOST.min(laws.len().saturating_sub(1)))
            .filter(|&at| found.eigenvalues[at] > 0.0)
            .map(|at| {
                let direction = found.eigenvectors.column(at);
                // Either sign is the same direction: the one whose largest number is positive.
                let sign = direction[direction.icamax()].signum();
                std::array::from_fn(|i| sign * found.eigenvalues[at].sqrt() * direction[i])
            })
            .collect();
        Self {
            mean: mean.into(),
            directions,
        }
    }

    /// The law `away` standard deviations along the directions, kept within the bounds of the calibration.
    pub fn law(&self, away: &[f64]) -> Idm {
        let log = |i: usize| {
            let moved = self.directions.iter().zip(away).map(|(d, a)| a * d[i]);
            self.mean[i] + moved.sum::<f64>()
        };
        let p: Vec<f64> = Idm::BOUNDS
            .iter()
            .enumerate()
            .map(|(i, &(low, high))| log(i).exp().clamp(low, high))
            .collect();
        Idm::from_parameters(&p)
    }

    /// Bounds of the search along each direction.
    pub(crate) fn bounds(&self) -> Vec<(f64, f64)> {
        vec![(-REACH, REACH); self.directions.len()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up::DRIVER;

    #[test]
    fn drivers_that_differ_in_the_time_gap_span_one_direction() {
        let laws: Vec<Idm> = [1.0, 1.5, 2.25].map(|t| DRIVER.with_time_gap_s(t)).to_vec();
        let found = IdmDirections::of(&laws);
        let wide = found.law(&[1.0]);
        let narrow = found.law(&[-1.0]);
        assert!((wide.standstill_gap_m - DRIVER.standstill_gap_m).abs() < 1e-9);
        assert!((wide.time_gap_s * narrow.time_gap_s - 1.5 * 1.5).abs() < 1e-9);
        assert!((wide.time_gap_s / narrow.time_gap_s).ln().abs() > 0.5);
    }

    #[test]
    fn one_driver_has_no_direction() {
        let found = IdmDirections::of(&[DRIVER]);
        assert!(found.directions.is_empty());
        assert!((found.law(&[]).time_gap_s - DRIVER.time_gap_s).abs() < 1e-9);
    }
}
