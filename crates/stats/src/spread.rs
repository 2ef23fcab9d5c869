//! How sure we are of a standard deviation.

use crate::numerics::{distributions::chi2_upper, roots};

/// Half of the 95 % interval of something normal, in its standard deviations, to the two decimals that Bland and Altman give.
pub const HALF_95: f64 = 1.96;

/// The 95 % interval of a standard deviation with `df` degrees of freedom, of values that are normal; none unless both are above 0.
///
/// # Source
/// √(df s² / χ²), χ² the quantiles of 2.5 and 97.5 %.
///
/// # Example
/// ```
/// let (low, high) = maveric_stats::sd_interval(1.0, 10.0).ok_or("no interval")?;
/// assert!((low - 0.6987).abs() < 1e-4 && (high - 1.7549).abs() < 1e-4);
/// # Ok::<(), &str>(())
/// ```
pub fn sd_interval(sd: f64, df: f64) -> Option<(f64, f64)> {
    if !(sd > 0.0 && df > 0.0 && sd.is_finite() && df.is_finite()) {
        return None;
    }
    let quantile = |upper: f64| roots::upwards(|x| chi2_upper(x, df) - upper, 0.0, df);
    let end = |upper: f64| Some(sd * (df / quantile(upper)?).sqrt());
    Some((end(0.025)?, end(0.975)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_are_those_of_the_chi_squared_distribution() {
        // qchisq(c(.975, .025), 5) of R: 12.8325, 0.831212.
        let (low, high) = sd_interval(2.0, 5.0).unwrap();
        assert!((low - 2.0 * (5.0_f64 / 12.832_502).sqrt()).abs() < 1e-6, "{low}");
        assert!((high - 2.0 * (5.0_f64 / 0.831_212).sqrt()).abs() < 1e-5, "{high}");
        assert_eq!(sd_interval(0.0, 5.0), None);
        assert_eq!(sd_interval(1.0, 0.0), None);
        assert_eq!(sd_interval(f64::NAN, 5.0), None);
    }
}
