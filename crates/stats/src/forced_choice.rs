//! How well people tell two things apart of which they know that one is it.

use crate::{Proportion, StatsError, numerics::distributions::normal_quantile, proportion_exact};
use serde::{Deserialize, Serialize};

/// Choices between two, one each of so many people.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ForcedChoice {
    /// Choices.
    pub n: usize,
    /// Those that were right.
    pub correct: usize,
    /// Their share with the exact interval; one half is a coin.
    pub share: Proportion,
    /// d′, in standard deviations of what one thing feels like: 0 where nobody tells them apart.
    pub d_prime: f64,
}

/// The share of right choices with the exact interval of this confidence, and d′.
///
/// # Errors
/// [`StatsError`] for no choice, more right ones than choices, or a confidence outside 0 to 1.
///
/// # Source
/// Clopper and Pearson (1934); Macmillan and Creelman (2005), chapter 7: d′ = √2 Φ⁻¹((k + ½)/(n + 1)) of k right choices in n, with which neither 0 nor n
/// has none.
///
/// # Example
/// ```
/// // 16 of 20: the share of the formula is 16.5/21 = .7857, z is 0.7916.
/// let told = maveric_stats::forced_choice(16, 20, 0.95)?;
/// assert!((told.d_prime - 1.1195).abs() < 1e-4);
/// assert!((told.share.low - 0.5634).abs() < 1e-4);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn forced_choice(
    correct: usize,
    n: usize,
    confidence: f64,
) -> Result<ForcedChoice, StatsError> {
    let share = proportion_exact(correct, n, confidence)?;
    let z = normal_quantile((correct as f64 + 0.5) / (n as f64 + 1.0));
    Ok(ForcedChoice { n, correct, share, d_prime: std::f64::consts::SQRT_2 * z })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coin_has_no_d_prime_and_both_ways_are_alike() {
        let of = |correct, n| forced_choice(correct, n, 0.95).unwrap().d_prime;
        assert!(of(10, 20).abs() < 1e-12);
        assert!((of(16, 20) + of(4, 20)).abs() < 1e-12);
        assert!(of(20, 20).is_finite() && of(0, 20) < 0.0);
        assert!(forced_choice(0, 0, 0.95).is_err());
    }
}
