//! All groups at once, by the ranks of all values.

use serde::{Deserialize, Serialize};

use super::{Sample, Samples};
use crate::{
    Named, Reasons,
    numerics::distributions::{chi2_upper, normal_two_sided},
    ranks,
    within_subjects::each_pair,
};

/// Kruskal and Wallis' test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Kruskal {
    /// H, corrected for ties.
    pub chi2: Option<f64>,
    /// k - 1.
    pub df: usize,
    /// P(χ² ≥ H).
    pub p: Option<f64>,
    /// H / (n - 1), from 0 to 1.
    pub epsilon2: Option<f64>,
}

/// Dunn's comparison of two groups by the mean ranks of all.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Dunn {
    /// Difference of the mean ranks over its standard error, corrected for ties.
    pub z: Option<f64>,
    /// Two-sided, by the normal distribution.
    pub p: Option<f64>,
    /// Holm's correction over all pairs.
    pub p_holm: Option<f64>,
}

pub(super) fn tests(samples: &Samples) -> (Kruskal, Named<Dunn>, Reasons) {
    let mut reasons = Reasons::default();
    let values: Vec<f64> = samples.all.iter().flat_map(|s| s.keys.clone()).collect();
    let (doubled, ties) = ranks::doubled(&values);
    let n = values.len() as f64;
    let mut from = 0;
    let mut means = Vec::new();
    for sample in &samples.all {
        let part = &doubled[from..from + sample.values.len()];
        means.push(0.5 * part.iter().sum::<i64>() as f64 / sample.n());
        from += sample.values.len();
    }
    // The variance of all ranks, with n - 1.
    let variance = (n * (n + 1.0) / 12.0) - ties / (12.0 * (n - 1.0));
    let varies = variance > 1e-9;
    if !varies {
        reasons.note_all(&["kruskal", "dunn"], "all values are equal");
    }
    let middle = 0.5 * (n + 1.0);
    let between: f64 =
        samples.all.iter().zip(&means).map(|(s, mean)| s.n() * (mean - middle).powi(2)).sum();
    let chi2 = varies.then(|| between / variance);
    let df = samples.all.len() - 1;
    let kruskal = Kruskal {
        chi2,
        df,
        p: chi2.map(|h| chi2_upper(h, df as f64)),
        epsilon2: chi2.map(|h| h / (n - 1.0)),
    };
    let ranked: Vec<(&Sample, f64)> = samples.all.iter().zip(means).collect();
    let pairs: Named<Dunn> = each_pair(&ranked)
        .map(|((a, rank_a), (b, rank_b))| {
            let error = (variance * (1.0 / a.n() + 1.0 / b.n())).sqrt();
            let z = varies.then(|| (rank_a - rank_b) / error);
            let test = Dunn { z, p: z.map(normal_two_sided), p_holm: None };
            (format!("{}|{}", a.name, b.name), test)
        })
        .collect();
    let dunn = pairs.with_holm(|t| t.p, |t, p| t.p_holm = p);
    (kruskal, dunn, reasons)
}
