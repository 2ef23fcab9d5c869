//! A share and how sure we are of it.

use serde::{Deserialize, Serialize};

use crate::{StatsError, numerics::distributions::f_quantile_upper, power::z_for};

/// A proportion with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Proportion {
    /// successes / n.
    pub estimate: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Proportion {
    /// Both ends of its interval.
    pub fn ends(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// The same of a hundred.
    #[must_use]
    pub fn percent(&self) -> Self {
        let [estimate, low, high] = [self.estimate, self.low, self.high].map(|v| 100.0 * v);
        Self { estimate, low, high }
    }
}

/// Wilson's interval of a proportion, which stays inside 0 to 1 and does not collapse there.
///
/// # Errors
/// [`StatsError::BadParameter`] if n is 0, there are more successes than n, or
/// `confidence` is not between 0 and 1.
///
/// # Source
/// Wilson (1927), without continuity correction.
///
/// # Example
/// ```
/// let share = maveric_stats::proportion(8, 10, 0.95)?;
/// assert!((share.low - 0.4902).abs() < 1e-4 && (share.high - 0.9433).abs() < 1e-4);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn proportion(successes: usize, n: usize, confidence: f64) -> Result<Proportion, StatsError> {
    check(successes, n, confidence)?;
    let (size, share) = (n as f64, successes as f64 / n as f64);
    let square = z_for(confidence).powi(2);
    let centre = (share + square / (2.0 * size)) / (1.0 + square / size);
    let spread = share * (1.0 - share) / size + square / (4.0 * size * size);
    let half = (square * spread).sqrt() / (1.0 + square / size);
    Ok(Proportion {
        estimate: share,
        low: if successes == 0 { 0.0 } else { centre - half },
        high: if successes == n { 1.0 } else { centre + half },
    })
}

/// Clopper and Pearson's interval of a proportion, which is never too narrow: of 0 in n its upper end is the most that n cases
/// without one leave open, at 95 % about 3.7 / n (one-sided 3 / n, the rule of three).
///
/// # Errors
/// As [`proportion`].
///
/// # Source
/// Clopper and Pearson (1934).
///
/// # Example
/// ```
/// let share = maveric_stats::proportion_exact(0, 10, 0.95)?;
/// assert!(share.low == 0.0 && (share.high - 0.3085).abs() < 1e-4);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn proportion_exact(
    successes: usize,
    n: usize,
    confidence: f64,
) -> Result<Proportion, StatsError> {
    check(successes, n, confidence)?;
    let none = || StatsError::parameter("confidence", "one that F has a quantile for", confidence);
    let (low, high) = clopper_pearson(successes as f64, n as f64, confidence).ok_or_else(none)?;
    Ok(Proportion { estimate: successes as f64 / n as f64, low, high })
}

fn check(successes: usize, n: usize, confidence: f64) -> Result<(), StatsError> {
    if n == 0 {
        return Err(StatsError::parameter("n", "at least 1", 0.0));
    }
    if successes > n {
        return Err(StatsError::parameter("successes", "at most n", successes as f64));
    }
    StatsError::between_0_and_1("confidence", confidence)
}

/// Clopper and Pearson's interval of x of n; none without a case.
pub(crate) fn clopper_pearson(x: f64, n: f64, confidence: f64) -> Option<(f64, f64)> {
    if n <= 0.0 {
        return None;
    }
    let tail = (1.0 - confidence) / 2.0;
    let quantile = |a: f64, b: f64| f_quantile_upper(tail, 2.0 * a, 2.0 * b);
    let low = if x <= 0.0 { 0.0 } else { x / (x + (n - x + 1.0) * quantile(n - x + 1.0, x)?) };
    let high = if x >= n {
        1.0
    } else {
        let odds = (x + 1.0) * quantile(x + 1.0, n - x)?;
        odds / (n - x + odds)
    };
    Some((low, high))
}
