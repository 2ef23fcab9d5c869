//! Spearman's rank correlation.

use serde::{Deserialize, Serialize};

use super::{fisher_interval, p_of_r, spearman_exact};
use crate::{
    Interval, PMethod, Reasons,
    numerics::{decimal, distributions::normal_upper},
    ranks,
};

/// Spearman's ρ.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Spearman {
    /// Pearson's r of the mid-ranks; the coefficient is its own effect size.
    pub rho: Option<f64>,
    /// `p_exact` where it was computed, else `p_t`.
    pub p: Option<f64>,
    /// Which of the two `p` is.
    pub p_method: Option<PMethod>,
    /// n - 2, of the t approximation.
    pub df: Option<usize>,
    /// t approximation: t = ρ √(df / (1 - ρ²)).
    pub p_t: Option<f64>,
    /// All pairings, given the ties, |ρ| at least as large; up to 14 pairs. R is exact only
    /// to 9, without ties.
    pub p_exact: Option<f64>,
    /// The 95 % interval by Fisher's z with standard error 1/√(n-3), as JASP
    /// and pingouin.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
    /// The interval by Bonett and Wright (2000): variance (1 + ρ²/2)/(n-3). This is the one
    /// whose coverage is right.
    #[serde(flatten, with = "crate::interval::ci_bw")]
    pub ci_bw: Interval,
    /// What other programs print for the same data.
    #[serde(flatten)]
    pub compat: SpearmanCompat,
}

/// Values that only other programs print, to compare with.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SpearmanCompat {
    /// R's `cor.test(method = "spearman")`: exact to n = 9, then an Edgeworth series to n = 1290; beyond, and
    /// with ties, the t approximation.
    pub p_r_default: Option<f64>,
}

/// Doubled ranks less their mean, and whether there are ties.
fn centred_ranks(values: &[f64]) -> (Vec<i64>, bool) {
    let (ranks, ties) = ranks::doubled(&decimal::tied(values));
    let mean = values.len() as i64 + 1;
    (ranks.iter().map(|r| r - mean).collect(), ties > 0.0)
}

/// ρ; `None` if a column is constant.
fn of_ranks(x: &[i64], y: &[i64]) -> Option<f64> {
    let dot = |a: &[i64], b: &[i64]| a.iter().zip(b).map(|(a, b)| i128::from(a * b)).sum::<i128>();
    let (xx, yy, xy) = (dot(x, x), dot(y, y), dot(x, y));
    if xx == 0 || yy == 0 {
        return None;
    }
    if xy * xy == xx * yy {
        return Some(if xy > 0 { 1.0 } else { -1.0 });
    }
    Some(xy as f64 / ((xx as f64).sqrt() * (yy as f64).sqrt()))
}

pub(super) fn test(x: &[f64], y: &[f64]) -> (Spearman, Reasons) {
    let mut reasons = Reasons::default();
    let ((rx, ties_x), (ry, ties_y)) = (centred_ranks(x), centred_ranks(y));
    let Some(rho) = of_ranks(&rx, &ry) else {
        let reason = "a column does not vary, so its ranks are all alike and rho is 0/0";
        reasons.note("", reason);
        return (Spearman::default(), reasons);
    };
    let n = x.len() as f64;
    let df = n - 2.0;
    let p_t = (df > 0.0).then(|| p_of_r(rho, df));
    if p_t.is_none() {
        let names = ["p_t", "p_r_default"];
        reasons.note_all(&names, "two pairs leave no degrees of freedom");
    }
    let p_exact = spearman_exact::p_value(&rx, &ry);
    if p_exact.is_none() {
        let most = spearman_exact::MOST_PAIRS;
        reasons.note("p_exact", format!("not computed: more than {most} pairs"));
    }
    // R counts no further than to 1290: n (n² - 1) would overflow its integers.
    let p_r_default = if ties_x || ties_y || x.len() > 1290 {
        p_t
    } else if x.len() <= 9 {
        p_exact
    } else {
        Some(edgeworth(rho, n))
    };
    let interval =
        |variance: f64| (n > 3.0).then(|| fisher_interval(rho, (variance / (n - 3.0)).sqrt()));
    let (fisher, bonett) = (interval(1.0), interval(1.0 + 0.5 * rho * rho));
    if fisher.is_none() {
        reasons.note_ends(&["ci", "ci_bw"], "the interval needs at least four pairs");
    }
    let result = Spearman {
        rho: Some(rho),
        p: p_exact.or(p_t),
        p_method: Some(if p_exact.is_some() { PMethod::Exact } else { PMethod::T }),
        df: Some(x.len() - 2),
        p_t,
        p_exact,
        ci: fisher.into(),
        ci_bw: bonett.into(),
        compat: SpearmanCompat { p_r_default },
    };
    (result, reasons)
}

/// Twice the tail of the Edgeworth series of algorithm AS 89, cut to 0..1 as R does.
fn edgeworth(rho: f64, n: f64) -> f64 {
    let cube = n * (n * n - 1.0) / 6.0;
    let sum = (cube * (1.0 - rho)).round();
    let upper = sum > cube;
    // The series is that of P(S' ≥ start), S being even: S itself above, S + 2 below.
    let start = if upper { sum } else { sum + 2.0 };
    let b = 1.0 / n;
    let x = (6.0 * (start - 1.0) * b / (n * n - 1.0) - 1.0) * (n - 1.0).sqrt();
    let y = x * x;
    let series = x
        * b
        * (0.2274
            + b * (0.2531 + 0.1745 * b)
            + y * (-0.0758 + b * (0.1033 + 0.3932 * b)
                - y * b
                    * (0.0879 + 0.0151 * b
                        - y * (0.0072 - 0.0831 * b + y * b * (0.0131 - 4.6e-4 * y)))));
    let correction = series / libm::exp(0.5 * y);
    let tail = if upper { normal_upper(x) + correction } else { normal_upper(-x) - correction };
    (2.0 * tail.clamp(0.0, 1.0)).min(1.0)
}
