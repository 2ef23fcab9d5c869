//! Pairwise t tests over the error term of the analysis of variance.

use serde::{Deserialize, Serialize};

use crate::{Reasons, RmAnova, numerics::distributions::t_two_sided};

/// A difference of two conditions over the common error term: right under sphericity,
/// too small or too large a standard error for single pairs without it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PooledT {
    /// Mean difference over √(2 MSe / n).
    pub t: Option<f64>,
    /// (n-1)(k-1).
    pub df: usize,
    /// Two-sided.
    pub p: Option<f64>,
    /// Holm's correction over all pairs.
    pub p_holm: Option<f64>,
}

pub(crate) fn test(difference: f64, n: usize, anova: &RmAnova) -> (PooledT, Reasons) {
    let mut reasons = Reasons::default();
    let df = anova.df2 as f64;
    let error = (2.0 * anova.ss_error / df / n as f64).sqrt();
    let t = (error > 0.0).then(|| difference / error);
    if t.is_none() {
        reasons.note("", "the error sum of squares is zero");
    }
    let result = PooledT { t, df: anova.df2, p: t.map(|t| t_two_sided(t, df)), p_holm: None };
    (result, reasons)
}
