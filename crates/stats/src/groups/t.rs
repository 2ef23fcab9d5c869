//! Means of two groups.

use serde::{Deserialize, Serialize};

use super::Sample;
use crate::{
    Interval, Reasons,
    numerics::{
        distributions::{t_quantile_two_sided, t_two_sided},
        noncentral::t_ncp_interval,
        special::hedges_factor,
    },
};

/// The difference of the means of two groups.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeanDifference {
    /// Mean of A minus mean of B.
    pub mean_diff: f64,
    /// Difference over its standard error.
    pub t: Option<f64>,
    /// Degrees of freedom: nA + nB - 2, or Welch's.
    pub df: Option<f64>,
    /// Two-sided.
    pub p: Option<f64>,
    /// Holm's correction over all pairs.
    pub p_holm: Option<f64>,
    /// The 95 % interval of the difference.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

/// The standardised difference of two groups, variance pooled over both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hedges {
    /// Difference over the pooled standard deviation (Cohen's d).
    pub d: Option<f64>,
    /// d times Hedges' exact correction, Γ(m/2) / (√(m/2) Γ((m-1)/2)), m = nA + nB - 2.
    pub g: Option<f64>,
    /// The 95 % interval of d, by the noncentral t.
    #[serde(flatten, with = "crate::interval::d_ci")]
    pub d_ci: Interval,
    /// The interval of g: that of d times the same correction.
    #[serde(flatten, with = "crate::interval::g_ci")]
    pub g_ci: Interval,
}

/// Standard error and degrees of freedom without equal variances; `None` if a group has one value or neither varies.
pub(super) fn welch_error(a: &Sample, b: &Sample) -> Option<(f64, f64)> {
    let (va, vb) = (a.variance()? / a.n(), b.variance()? / b.n());
    let sum = va + vb;
    let df = sum * sum / (va * va / (a.n() - 1.0) + vb * vb / (b.n() - 1.0));
    (sum > 0.0).then(|| (sum.sqrt(), df))
}

/// Why there is no [`welch_error`].
pub(super) fn no_welch_error(a: &Sample, b: &Sample) -> String {
    for group in [a, b] {
        if group.values.len() < 2 {
            return format!("group `{}` has a single value, so no variance", group.name);
        }
    }
    "neither group varies".to_owned()
}

/// The pooled variance and its degrees of freedom; `None` if it is zero.
fn pooled(a: &Sample, b: &Sample) -> Option<(f64, f64)> {
    let (squares, df) = (a.squares + b.squares, a.n() + b.n() - 2.0);
    (df > 0.0 && squares > 0.0).then(|| (squares / df, df))
}

fn no_pooled(a: &Sample, b: &Sample) -> &'static str {
    if a.values.len() + b.values.len() < 3 {
        "two single values have no variance"
    } else {
        "the values do not vary within the two groups"
    }
}

pub(super) fn welch(a: &Sample, b: &Sample) -> (MeanDifference, Reasons) {
    test(a, b, welch_error(a, b), || no_welch_error(a, b))
}

/// Student's t test of two groups.
pub(crate) fn student(a: &Sample, b: &Sample) -> (MeanDifference, Reasons) {
    let error = pooled(a, b).map(|(v, df)| ((v * (1.0 / a.n() + 1.0 / b.n())).sqrt(), df));
    test(a, b, error, || no_pooled(a, b).to_owned())
}

fn test(
    a: &Sample,
    b: &Sample,
    error: Option<(f64, f64)>,
    why: impl Fn() -> String,
) -> (MeanDifference, Reasons) {
    let mut reasons = Reasons::default();
    let mean_diff = a.mean - b.mean;
    if error.is_none() {
        let names = ["t", "df", "p", "p_holm", "ci_low", "ci_high"];
        reasons.note_all(&names, &why());
    }
    let t = error.map(|(se, _)| mean_diff / se);
    let half = error.and_then(|(se, df)| Some(se * t_quantile_two_sided(0.05, df)?));
    if half.is_none() {
        reasons.note_ends(&["ci"], "t has no quantile at these degrees of freedom");
    }
    let result = MeanDifference {
        mean_diff,
        t,
        df: error.map(|(_, df)| df),
        p: error.zip(t).map(|((_, df), t)| t_two_sided(t, df)),
        p_holm: None,
        ci: Interval::around(mean_diff, half),
    };
    (result, reasons)
}

pub(super) fn hedges(a: &Sample, b: &Sample) -> (Hedges, Reasons) {
    let mut reasons = Reasons::default();
    let size = (1.0 / a.n() + 1.0 / b.n()).sqrt();
    let pooled = pooled(a, b);
    if pooled.is_none() {
        reasons.note("", no_pooled(a, b));
    }
    let d = pooled.map(|(variance, _)| (a.mean - b.mean) / variance.sqrt());
    let factor = pooled.filter(|(_, df)| *df > 1.0).map(|(_, df)| hedges_factor(df));
    if factor.is_none() {
        let names = ["g", "g_ci_low", "g_ci_high"];
        reasons.note_all(&names, "its correction needs at least four values");
    }
    let interval = d.zip(pooled).and_then(|(d, (_, df))| {
        let (low, high) = t_ncp_interval(d / size, df, 0.025)?;
        Some((low * size, high * size))
    });
    if interval.is_none() {
        let reason = "no noncentral t leaves 2.5 % beyond this t";
        reasons.note_ends(&["d_ci", "g_ci"], reason);
    }
    let corrected = interval.zip(factor).map(|((low, high), factor)| (low * factor, high * factor));
    let result = Hedges {
        d,
        g: d.zip(factor).map(|(d, factor)| d * factor),
        d_ci: interval.into(),
        g_ci: corrected.into(),
    };
    (result, reasons)
}
