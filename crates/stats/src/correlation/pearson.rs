//! Pearson's product-moment correlation.

use serde::{Deserialize, Serialize};

use super::{fisher_interval, p_of_r};
use crate::{
    Interval, Reasons,
    numerics::moments::{centred, is_constant, is_rounding, largest},
};

/// Pearson's r.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Pearson {
    /// Σ xy / √(Σx² Σy²) of centred columns; the coefficient is its own effect size.
    pub r: Option<f64>,
    /// r √(df / (1 - r²)).
    pub t: Option<f64>,
    /// n - 2.
    pub df: Option<usize>,
    /// Two-sided. For exactly linear data, which no sample of independent normal columns
    /// is, the smallest positive number of double precision.
    pub p: Option<f64>,
    /// The 95 % interval by Fisher's z, standard error 1/√(n-3).
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

/// r, exactly ±1 for data that are linear up to rounding; `None` if a column is constant.
pub(crate) fn coefficient(x: &[f64], y: &[f64]) -> Option<f64> {
    if is_constant(x) || is_constant(y) {
        return None;
    }
    let (dx, dy) = (centred(x), centred(y));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (xx, yy, xy) = (dot(&dx, &dx), dot(&dy, &dy), dot(&dx, &dy));
    let slope = xy / xx;
    let rounding = largest(y) + slope.abs() * largest(x);
    if dx.iter().zip(&dy).all(|(a, b)| is_rounding(b - slope * a, rounding)) {
        return Some(1.0_f64.copysign(slope));
    }
    let r = xy / (xx.sqrt() * yy.sqrt());
    r.is_finite().then(|| r.clamp(-1.0, 1.0))
}

pub(super) fn test(x: &[f64], y: &[f64]) -> (Pearson, Reasons) {
    let mut reasons = Reasons::default();
    let r = coefficient(x, y);
    if r.is_none() {
        reasons.note("", "a column does not vary, so r is 0/0");
        return (Pearson::default(), reasons);
    }
    let n = x.len() as f64;
    let df = n - 2.0;
    let inner = r.filter(|r| r.abs() < 1.0 && df > 0.0);
    if inner.is_none() {
        reasons.note("t", "the pairs lie on a line, so t has no finite value");
    }
    let p = r.filter(|_| df > 0.0).map(|r| p_of_r(r, df));
    if p.is_none() {
        reasons.note("p", "two pairs leave no degrees of freedom");
    }
    let interval = r.filter(|_| n > 3.0).map(|r| fisher_interval(r, 1.0 / (n - 3.0).sqrt()));
    if interval.is_none() {
        reasons.note_ends(&["ci"], "the interval needs at least four pairs");
    }
    let result = Pearson {
        r,
        t: inner.map(|r| r * (df / ((1.0 - r) * (1.0 + r))).sqrt()),
        df: Some(x.len() - 2),
        p,
        ci: interval.into(),
    };
    (result, reasons)
}
