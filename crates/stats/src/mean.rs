//! A mean and how well it is known.

use serde::{Deserialize, Serialize};

use crate::numerics::{distributions::t_quantile_two_sided, moments::mean_and_square_sum};

/// A mean with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeanInterval {
    /// Arithmetic mean.
    pub mean: f64,
    /// Lower end, by t with n - 1 degrees of freedom.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// The mean of values of shape `(n,)` with its 95 % interval; `None` below two finite values.
///
/// # Example
/// ```
/// let found = maveric_stats::mean_interval(&[1.0, 2.0, 3.0]).unwrap();
/// assert!((found.mean - 2.0).abs() < 1e-12 && (found.high - 4.484).abs() < 1e-3);
/// assert!(maveric_stats::mean_interval(&[1.0]).is_none());
/// ```
pub fn mean_interval(values: &[f64]) -> Option<MeanInterval> {
    let n = values.len() as f64;
    if values.len() < 2 || values.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let (mean, squares) = mean_and_square_sum(values.iter().copied());
    let half = t_quantile_two_sided(0.05, n - 1.0)? * (squares / (n - 1.0) / n).sqrt();
    Some(MeanInterval {
        mean,
        low: mean - half,
        high: mean + half,
    })
}
