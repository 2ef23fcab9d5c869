//! A share and how sure we are of it.

use serde::{Deserialize, Serialize};

use crate::{StatsError, power::z_for};

/// A proportion with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Proportion {
    /// successes / n.
    pub estimate: f64,
    /// Lower end of Wilson's interval.
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
        Self {
            estimate,
            low,
            high,
        }
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
    let bad = |name: &str, expected: &str, found: f64| StatsError::parameter(name, expected, found);
    if n == 0 {
        return Err(bad("n", "at least 1", 0.0));
    }
    if successes > n {
        return Err(bad("successes", "at most n", successes as f64));
    }
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(bad("confidence", "between 0 and 1", confidence));
    }
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
