//! The paired t test and the standardised mean difference.

use serde::{Deserialize, Serialize};

use crate::{
    Interval, Reasons,
    numerics::{
        decimal,
        distributions::{t_quantile_two_sided, t_two_sided},
        moments::{is_rounding, largest, mean_and_square_sum},
        noncentral::t_ncp_interval,
        special::hedges_factor,
    },
};

/// The difference of two conditions, each subject its own control.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PairedT {
    /// Mean of A minus B.
    pub mean_diff: f64,
    /// Mean difference over its standard error.
    pub t: Option<f64>,
    /// n - 1.
    pub df: usize,
    /// Two-sided.
    pub p: Option<f64>,
    /// Holm's correction over all pairs of the analysis.
    pub p_holm: Option<f64>,
    /// The 95 % interval of the mean difference.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
    /// Mean difference over the standard deviation of the differences.
    pub dz: Option<f64>,
    /// dz times Hedges' exact correction, Γ(m/2) / (√(m/2) Γ((m-1)/2)), m = n-1.
    pub gz: Option<f64>,
    /// The 95 % interval of dz, by the noncentral t.
    #[serde(flatten, with = "crate::interval::dz_ci")]
    pub dz_ci: Interval,
    /// The 95 % interval of gz: that of dz times the same correction.
    #[serde(flatten, with = "crate::interval::gz_ci")]
    pub gz_ci: Interval,
    /// Mean difference over the root of the mean of both variances; what pingouin calls
    /// Cohen's d of a paired design.
    pub d_av: Option<f64>,
    /// Its 95 % interval: that of dz times the ratio of both standard
    /// deviations (Algina and Keselman, 2003).
    #[serde(flatten, with = "crate::interval::d_av_ci")]
    pub d_av_ci: Interval,
}

/// Compares two columns of shape `(n,)`, n ≥ 2; `t95` is the two-sided 5 % quantile.
pub(crate) fn test(a: &[f64], b: &[f64], t95: Option<f64>) -> (PairedT, Reasons) {
    let mut reasons = Reasons::default();
    let n = a.len() as f64;
    let df = n - 1.0;
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let (mean, squares) = mean_and_square_sum(differences.iter().copied());
    let constant = is_constant_difference(a, b, &differences);
    let sd = (!constant).then(|| (squares / df).sqrt()).filter(|sd| *sd > 0.0);
    let t = sd.map(|sd| mean / (sd / n.sqrt()));
    if sd.is_none() {
        let reason = "the differences do not vary";
        reasons.note_all(&["t", "p", "p_holm", "dz", "gz"], reason);
        reasons.note_ends(&["ci", "dz_ci", "gz_ci", "d_av_ci"], reason);
    }
    let half = sd.zip(t95).map(|(sd, t95)| t95 * sd / n.sqrt());
    let dz = sd.map(|sd| mean / sd);
    let correction = (df > 1.0).then(|| hedges_factor(df));
    if correction.is_none() {
        let names = ["gz", "gz_ci_low", "gz_ci_high"];
        reasons.note_all(&names, "its correction needs at least three subjects");
    }
    let interval = t
        .and_then(|t| t_ncp_interval(t, df, 0.025))
        .map(|(low, high)| (low / n.sqrt(), high / n.sqrt()));
    if interval.is_none() {
        let reason = "no noncentral t leaves 2.5 % beyond this t";
        reasons.note_ends(&["dz_ci", "gz_ci", "d_av_ci"], reason);
    }
    let variance = |values: &[f64]| mean_and_square_sum(values.iter().copied()).1 / df;
    let average_sd = (0.5 * (variance(a) + variance(b))).sqrt();
    let d_av = (average_sd > 0.0).then(|| mean / average_sd);
    if d_av.is_none() {
        let names = ["d_av", "d_av_ci_low", "d_av_ci_high"];
        reasons.note_all(&names, "neither condition varies");
    }
    let corrected =
        interval.zip(correction).map(|((low, high), factor)| (low * factor, high * factor));
    let over_average = interval
        .zip(sd)
        .filter(|_| average_sd > 0.0)
        .map(|((low, high), sd)| (low * sd / average_sd, high * sd / average_sd));
    let result = PairedT {
        mean_diff: mean,
        t,
        df: a.len() - 1,
        p: t.map(|t| t_two_sided(t, df)),
        p_holm: None,
        ci: Interval::around(mean, half),
        dz,
        gz: dz.zip(correction).map(|(dz, factor)| dz * factor),
        dz_ci: interval.into(),
        gz_ci: corrected.into(),
        d_av,
        d_av_ci: over_average.into(),
    };
    (result, reasons)
}

/// The two-sided 5 % quantile of t for n subjects.
pub(crate) fn t95(n: usize) -> Option<f64> {
    t_quantile_two_sided(0.05, n as f64 - 1.0)
}

/// Whether all differences are one number, as written or up to rounding.
pub(crate) fn is_constant_difference(a: &[f64], b: &[f64], differences: &[f64]) -> bool {
    let scale = largest(a).max(largest(b));
    let spread = differences.iter().fold(0.0_f64, |m, d| m.max((d - differences[0]).abs()));
    if is_rounding(spread, scale) {
        return true;
    }
    if spread > 1e-6 * scale {
        return false;
    }
    let (n, both) = (a.len(), [a, b].concat());
    let written = decimal::Written::from_values(&both);
    (1..n).all(|i| written.same_difference((i, n + i), (0, n)))
}
