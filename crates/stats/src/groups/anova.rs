//! All groups at once, by their means.

use serde::{Deserialize, Serialize};

use super::Samples;
use crate::{
    Interval, Reasons,
    numerics::{distributions::f_upper, noncentral::f_ncp_interval},
};

/// Fisher's analysis of variance of independent groups.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OneWayAnova {
    /// Mean square between over mean square within groups.
    #[serde(rename = "F")]
    pub f: Option<f64>,
    /// k - 1.
    pub df1: usize,
    /// n - k.
    pub df2: usize,
    /// P(F' ≥ F).
    pub p: Option<f64>,
    /// Σ n (group mean - grand mean)².
    pub ss_between: f64,
    /// Σ (value - group mean)².
    pub ss_within: f64,
    /// Share of the sum of squares between groups.
    pub eta2: Option<f64>,
    /// Its 90 % interval, by the noncentral F: ncp / (ncp + df2).
    #[serde(flatten, with = "crate::interval::eta2_ci90")]
    pub eta2_ci90: Interval,
    /// (SSb - df1 MSw) / (SSb + SSw + MSw); it may be negative.
    pub omega2: Option<f64>,
}

/// Welch's analysis of variance, without equal variances.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WelchAnova {
    /// Welch's statistic.
    #[serde(rename = "F")]
    pub f: Option<f64>,
    /// k - 1.
    pub df1: usize,
    /// Welch's degrees of freedom of the error.
    pub df2: Option<f64>,
    /// P(F' ≥ F).
    pub p: Option<f64>,
}

pub(super) fn fisher(samples: &Samples) -> (OneWayAnova, Reasons) {
    let mut reasons = Reasons::default();
    let (n, k) = (samples.n(), samples.all.len());
    let (df1, df2) = (k - 1, n - k);
    let (d1, d2) = (df1 as f64, df2 as f64);
    let total: f64 = samples.all.iter().map(|s| s.n() * s.mean).sum();
    let grand = total / n as f64;
    let between = |s: &super::Sample| s.n() * (s.mean - grand).powi(2);
    let ss_between: f64 = samples.all.iter().map(between).sum();
    let ss_within: f64 = samples.all.iter().map(|s| s.squares).sum();
    let error = (ss_within > 0.0).then(|| ss_within / d2);
    let f = error.map(|error| ss_between / d1 / error);
    let interval = f.and_then(|f| f_ncp_interval(f, d1, d2, 0.05));
    if f.is_none() {
        reasons.note_all(&["F", "p"], "the values do not vary within groups");
    }
    if interval.is_none() {
        reasons.note_ends(&["eta2_ci90"], "there is no F to invert");
    }
    let ss_total = ss_between + ss_within;
    let varies = ss_total > 0.0;
    if !varies {
        reasons.note("eta2", "the values do not vary at all: it is 0/0");
    }
    if error.is_none() {
        reasons.note("omega2", "the values do not vary within groups");
    }
    let anova = OneWayAnova {
        f,
        df1,
        df2,
        p: f.map(|f| f_upper(f, d1, d2)),
        ss_between,
        ss_within,
        eta2: varies.then(|| ss_between / ss_total),
        eta2_ci90: Interval::from(interval).map(|ncp| ncp / (ncp + d2)),
        omega2: error.map(|error| (ss_between - d1 * error) / (ss_total + error)),
    };
    (anova, reasons)
}

/// # Source
/// Welch (1951).
pub(super) fn welch(samples: &Samples) -> (WelchAnova, Reasons) {
    let mut reasons = Reasons::default();
    let k = samples.all.len() as f64;
    let weight = |s: &super::Sample| s.variance().filter(|v| *v > 0.0).map(|v| s.n() / v);
    let weights: Option<Vec<f64>> = samples.all.iter().map(weight).collect();
    if weights.is_none() {
        let without = samples.all.iter().filter(|s| weight(s).is_none());
        let names: Vec<_> = without.map(|s| format!("`{}`", s.name)).collect();
        let reason = format!("no variance in group {}", names.join(", "));
        reasons.note_all(&["F", "df2", "p"], &reason);
    }
    let f_and_df2 = weights.map(|weights| {
        let total: f64 = weights.iter().sum();
        let pairs = || weights.iter().zip(&samples.all);
        let grand = pairs().map(|(w, s)| w * s.mean).sum::<f64>() / total;
        let between: f64 = pairs().map(|(w, s)| w * (s.mean - grand).powi(2)).sum();
        let share = |(w, s): (&f64, &super::Sample)| (1.0 - w / total).powi(2) / (s.n() - 1.0);
        let uneven: f64 = pairs().map(share).sum();
        let f = between / (k - 1.0) / (1.0 + 2.0 * (k - 2.0) * uneven / (k * k - 1.0));
        (f, (k * k - 1.0) / (3.0 * uneven))
    });
    let anova = WelchAnova {
        f: f_and_df2.map(|(f, _)| f),
        df1: samples.all.len() - 1,
        df2: f_and_df2.map(|(_, df2)| df2),
        p: f_and_df2.map(|(f, df2)| f_upper(f, k - 1.0, df2)),
    };
    (anova, reasons)
}
