//! Bayes factors of correlations.

use serde::{Deserialize, Serialize};

use super::{Prior, TOO_LARGE, power};
use crate::{
    Reasons, StatsError, complete,
    numerics::{
        moments::{centred, dot, is_constant},
        special::{ln_beta, ln_gamma_half_step},
    },
};

/// The Bayes factor of Pearson's r under stretched beta priors, symmetric about 0, from the exact density of r.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BayesCorrelation {
    /// Complete pairs.
    pub n: usize,
    /// Pearson's correlation.
    pub r: Option<f64>,
    /// Natural logarithm of `bf10`.
    pub log_bf10: Option<f64>,
    /// Likelihood with a correlation over that without, κ = 1/3: BayesFactor's default.
    pub bf10: Option<f64>,
    /// 1 / `bf10`.
    pub bf01: Option<f64>,
    /// Natural logarithm of `bf10_kappa1`.
    pub log_bf10_kappa1: Option<f64>,
    /// The same with a flat prior, κ = 1: JASP's default.
    pub bf10_kappa1: Option<f64>,
}

/// The Bayes factor of one correlation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BayesCorrelationAnalysis {
    /// Pairs left out because a value is missing.
    pub missing: usize,
    /// The factor.
    pub bayes_r: BayesCorrelation,
    /// The prior of `bf10`.
    pub prior: Prior,
    /// The prior of `bf10_kappa1`.
    pub prior_kappa1: Prior,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Bayes factor of the correlation of two columns of shape `(rows,)`; pairs with a missing value are left out.
///
/// # Errors
/// [`StatsError::LengthMismatch`], [`StatsError::NotFinite`]; [`StatsError::TooFew`] below three pairs.
///
/// # Source
/// Ly, Verhagen and Wagenmakers (2016), equation 25.
///
/// # Example
/// ```
/// let x = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(Some);
/// let y = [1.1, 1.9, 3.2, 3.9, 5.3, 5.8].map(Some);
/// let found = maveric_stats::bayes_correlation(&x, &y)?;
/// assert!(found.bayes_r.bf10_kappa1.unwrap() > 10.0);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn bayes_correlation(
    x: &[Option<f64>],
    y: &[Option<f64>],
) -> Result<BayesCorrelationAnalysis, StatsError> {
    let pairs = complete::rows(&[("x", x), ("y", y)], "pair", 3)?;
    let mut undefined = Reasons::default();
    let (x, y) = (&pairs.columns[0], &pairs.columns[1]);
    let r = (!is_constant(x) && !is_constant(y)).then(|| {
        let (x, y) = (centred(x), centred(y));
        (dot(&x, &y) / (dot(&x, &x).sqrt() * dot(&y, &y).sqrt())).clamp(-1.0, 1.0)
    });
    let n = x.len();
    // At ±1 the factor has no upper limit.
    let inside = r.filter(|r| 1.0 - r * r > 1e-14);
    let factor = |kappa: f64| inside.map(|r| log_bf10(r, n as f64, kappa));
    let prior = |kappa| Prior::new("stretched beta", kappa, "correlation");
    let (prior, prior_kappa1) = (prior(1.0 / 3.0), prior(1.0));
    let (third, flat) = (factor(prior.scale), factor(prior_kappa1.scale));
    let factors = ["bf10", "bf01", "bf10_kappa1"];
    if inside.is_none() {
        let reason = if r.is_none() {
            "a column does not vary"
        } else {
            "the pairs lie on a line: the factor has no limit"
        };
        if r.is_none() {
            undefined.note("bayes_r.r", reason);
        }
        undefined.note_below("bayes_r", &["log_bf10", "log_bf10_kappa1"], reason);
        undefined.note_below("bayes_r", &factors, reason);
    }
    let bayes_r = BayesCorrelation {
        n,
        r,
        log_bf10: third,
        bf10: third.and_then(power),
        bf01: third.and_then(|ln| power(-ln)),
        log_bf10_kappa1: flat,
        bf10_kappa1: flat.and_then(power),
    };
    if bayes_r.bf10.is_none() || bayes_r.bf01.is_none() || bayes_r.bf10_kappa1.is_none() {
        undefined.note_below("bayes_r", &factors, TOO_LARGE);
    }
    Ok(BayesCorrelationAnalysis { missing: pairs.missing, bayes_r, prior, prior_kappa1, undefined })
}

/// ln of √π 2^(1-2a) / B(a, a) · Γ((n+2a-1)/2) / Γ((n+2a)/2) · F((n-1)/2, (n-1)/2; (n+2a)/2; r²), a = 1/κ.
fn log_bf10(r: f64, n: f64, kappa: f64) -> f64 {
    let a = 1.0 / kappa;
    let front = 0.5 * libm::log(std::f64::consts::PI) + (1.0 - 2.0 * a) * std::f64::consts::LN_2
        - ln_beta(a, a)
        - ln_gamma_half_step(0.5 * (n + 2.0 * a - 1.0));
    front + ln_hypergeometric(0.5 * (n - 1.0), 0.5 * (n + 2.0 * a), r * r)
}

/// ln F(b, b; c; z) for 0 ≤ z < 1 and c > b, by the series or, where that converges faster, by Euler's transformation of it.
fn ln_hypergeometric(b: f64, c: f64, z: f64) -> f64 {
    let excess = c - 2.0 * b;
    let (b, outside) = if excess < 0.0 { (c - b, excess * libm::log1p(-z)) } else { (b, 0.0) };
    let (mut term, mut sum, mut k) = (1.0_f64, 1.0_f64, 0.0);
    // All terms are positive.
    while term > 1e-17 * sum && k < 1e7 {
        term *= (b + k) * (b + k) / ((c + k) * (k + 1.0)) * z;
        sum += term;
        k += 1.0;
    }
    outside + libm::log(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hypergeometric_function_agrees_with_a_closed_form() {
        // F(1, 1; 2; z) = -ln(1 - z) / z; F(½, ½; 3/2; z²) = asin(z) / z.
        for z in [0.1_f64, 0.5, 0.9] {
            let exact = (-(-z).ln_1p() / z).ln();
            assert!((ln_hypergeometric(1.0, 2.0, z) - exact).abs() < 1e-12);
            let exact = (z.asin() / z).ln();
            assert!((ln_hypergeometric(0.5, 1.5, z * z) - exact).abs() < 1e-12);
        }
    }

    #[test]
    fn pairs_on_a_line_and_constant_columns_have_reasons() {
        let x = [1.0, 2.0, 3.0, 4.0].map(Some);
        let line = bayes_correlation(&x, &x).unwrap();
        assert!((line.bayes_r.r.unwrap() - 1.0).abs() < 1e-15 && line.bayes_r.bf10.is_none());
        assert!(line.undefined.get("bayes_r.bf10").unwrap().contains("line"));
        let flat = bayes_correlation(&x, &[Some(2.0); 4]).unwrap();
        assert!(flat.undefined.get("bayes_r.r").is_some());
    }
}
