//! Tails and quantiles of the normal, t, F and chi-squared distributions.
//!
//! Every tail is the survival function itself: `1 - cdf` is 0 where Holm has to rank. `erfc` is that of `libm`, right to
//! the last bit; that of statrs is off by 4e-11 near z = 1.4.

use libm::erfc;
use statrs::function::erf::erfc_inv;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use super::{
    roots,
    special::{beta_tails, gamma_upper, ln_beta},
};

/// A tail too small for double precision, as the smallest normal number: Holm can still
/// rank it, and nobody reads it as impossible.
fn positive(p: f64) -> f64 {
    p.clamp(f64::MIN_POSITIVE, 1.0)
}

/// P(Z > z).
pub(crate) fn normal_upper(z: f64) -> f64 {
    0.5 * erfc(z * FRAC_1_SQRT_2)
}

/// P(|Z| > |z|).
pub(crate) fn normal_two_sided(z: f64) -> f64 {
    positive(erfc(z.abs() * FRAC_1_SQRT_2))
}

/// The density of the standard normal distribution.
pub(crate) fn normal_density(z: f64) -> f64 {
    libm::exp(-0.5 * z * z) * 0.398_942_280_401_432_7
}

/// z with P(Z < z) = `p`, for `p` strictly between 0 and 1.
pub(crate) fn normal_quantile(p: f64) -> f64 {
    let z = -SQRT_2 * erfc_inv(2.0 * p);
    // One Newton step takes the approximation to full precision.
    let error = if p < 0.5 { normal_upper(-z) - p } else { (1.0 - p) - normal_upper(z) };
    let step = error / normal_density(z);
    if step.is_finite() { z - step } else { z }
}

/// 97.5 % point of the normal distribution.
const NORMAL_975: f64 = 1.959_963_984_540_054;

/// The 95 % interval of a correlation, with the standard error of Fisher's z.
pub(crate) fn fisher_interval(r: f64, error: f64) -> (f64, f64) {
    fisher_ends(r, NORMAL_975 * error)
}

/// tanh(atanh(r) ± half), which is r itself at ±1.
pub(crate) fn fisher_ends(r: f64, half: f64) -> (f64, f64) {
    if r.abs() >= 1.0 {
        return (r, r);
    }
    (libm::tanh(libm::atanh(r) - half), libm::tanh(libm::atanh(r) + half))
}

/// P(|T| > |t|) with `df` degrees of freedom.
pub(crate) fn t_two_sided(t: f64, df: f64) -> f64 {
    let square = t * t;
    if !square.is_finite() {
        return f64::MIN_POSITIVE;
    }
    positive(beta_tails(0.5 * df, 0.5, df / (df + square), square / (df + square)).0)
}

/// P(T > t) with `df` degrees of freedom.
pub(crate) fn t_upper(t: f64, df: f64) -> f64 {
    let half = 0.5 * t_two_sided(t, df);
    if t > 0.0 { half } else { 1.0 - half }
}

/// t with P(|T| > t) = `p`.
pub(crate) fn t_quantile_two_sided(p: f64, df: f64) -> Option<f64> {
    let guess = normal_quantile(1.0 - 0.5 * p);
    let gap = |t: f64| libm::log(t_two_sided(t, df)) - libm::log(p);
    // Newton's steps on the logarithm, from the first term of the expansion in 1/df.
    let ln_density = |t: f64| -0.5 * (df + 1.0) * libm::log1p(t * t / df) - ln_beta(0.5, 0.5 * df);
    let mut t = guess + guess * (guess * guess + 1.0) / (4.0 * df);
    for _ in 0..20 {
        let slope = 2.0 * libm::exp(ln_density(t)) / df.sqrt() / t_two_sided(t, df);
        let step = gap(t) / slope;
        t += step;
        if !(step.is_finite() && t > 0.0) {
            break;
        }
        // The error is squared at each step, so the next would be below rounding.
        if step.abs() <= 1e-9 * t {
            return Some(t);
        }
    }
    roots::upwards(gap, 0.5 * guess, guess)
}

/// P(F > f).
pub(crate) fn f_upper(f: f64, df1: f64, df2: f64) -> f64 {
    if f <= 0.0 {
        return 1.0;
    }
    let whole = df2 + df1 * f;
    positive(beta_tails(0.5 * df2, 0.5 * df1, df2 / whole, df1 * f / whole).0)
}

/// f with P(F > f) = `p`.
pub(crate) fn f_quantile_upper(p: f64, df1: f64, df2: f64) -> Option<f64> {
    roots::upwards(|f| f_upper(f, df1, df2) - p, 0.0, 1.0)
}

/// P(χ² > x).
pub(crate) fn chi2_upper(x: f64, df: f64) -> f64 {
    positive(gamma_upper(0.5 * df, 0.5 * x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_tails_undo_each_other() {
        for df in [1.0, 7.0, 23.0, 99_999.0] {
            let t = t_quantile_two_sided(0.05, df).unwrap();
            assert!((t_two_sided(t, df) - 0.05).abs() < 1e-12);
        }
        for p in [1e-12, 0.025, 0.5, 0.975] {
            assert!(((1.0 - normal_upper(normal_quantile(p))) - p).abs() < 1e-15);
        }
        assert!((t_quantile_two_sided(0.05, 23.0).unwrap() - 2.068_657_610_419_041).abs() < 1e-12);
    }

    #[test]
    fn far_tails_are_small_and_not_zero() {
        assert!(chi2_upper(800.0, 3.0) > 0.0);
        assert!(f_upper(800.0, 3.0, 69.0) > 0.0);
        assert!((chi2_upper(59.85, 3.0) / 6.328_378_691_693_308e-13 - 1.0).abs() < 1e-10);
    }

    /// mpmath, 40 digits.
    #[test]
    fn tails_agree_with_forty_digits_to_the_twelfth() {
        let two_sided = [
            (normal_two_sided(1.435_295_634_864_317_3), 0.151_202_871_135_656_67),
            (normal_two_sided(0.3), 0.764_177_155_622_094_7),
            (normal_two_sided(9.5), 2.098_903_015_072_521_5e-21),
            (t_two_sided(2.5, 23.0), 0.019_994_122_327_887_084),
            (t_two_sided(2.5, 1e4), 0.012_435_219_550_583_697),
            (t_two_sided(30.0, 9999.0), 2.048_028_052_186_590_4e-189),
        ];
        let upper = [
            (f_upper(25.23, 3.0, 69.0), 3.944_383_888_953_689e-11),
            (f_upper(1.5, 3.0, 29_997.0), 0.212_313_702_965_295_83),
            (f_upper(2.1, 2.76, 63.49), 0.113_939_324_524_051_64),
            (chi2_upper(41.19, 3.0), 5.959_710_530_226_924e-9),
            (chi2_upper(500.0, 480.0), 0.255_208_419_036_934_3),
            (chi2_upper(1200.0, 1000.0), 1.225_594_233_062_290_4e-5),
            (chi2_upper(10.0, 30.0), 0.999_773_746_323_823_2),
        ];
        for (found, exact) in two_sided.into_iter().chain(upper) {
            assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
        }
        // A fraction of thousands of terms, each rounded.
        assert!((t_two_sided(1.96, 1e6) / 0.049_996_067_585_269_79 - 1.0).abs() < 1e-10);
        for (p, z) in [
            (1e-12, -7.034_483_825_301_132),
            (0.025, -1.959_963_984_540_054_2),
            (0.2, -0.841_621_233_572_914_2),
        ] {
            assert!((normal_quantile(p) / z - 1.0).abs() < 1e-15, "{}", normal_quantile(p));
        }
    }
}
