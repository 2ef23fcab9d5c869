//! Conover's comparisons after Friedman's test.

use serde::{Deserialize, Serialize};

use crate::{Reasons, friedman::RankTable, numerics::distributions::t_two_sided};

/// A difference of rank sums over what the ranks leave unexplained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Conover {
    /// (Ra - Rb) / √(2 (n Σr² - ΣRj²) / ((n-1)(k-1))).
    pub t: Option<f64>,
    /// (n-1)(k-1).
    pub df: usize,
    /// Two-sided.
    pub p: Option<f64>,
    /// Holm's correction over all pairs.
    pub p_holm: Option<f64>,
}

/// Compares conditions `a` and `b` (from 0).
///
/// # Source
/// Conover (1999), *Practical Nonparametric Statistics*, section 5.8.
pub(crate) fn test(table: &RankTable, a: usize, b: usize) -> (Conover, Reasons) {
    let mut reasons = Reasons::default();
    let df = (table.n - 1) * (table.k - 1);
    let sums: i64 = table.sums.iter().map(|s| s * s).sum();
    // Doubled ranks: numerator and root of the denominator are both twice too large.
    let left = table.n as i64 * table.squares - sums;
    let t = (left > 0)
        .then(|| (table.sums[a] - table.sums[b]) as f64 / (2.0 * left as f64 / df as f64).sqrt());
    if t.is_none() {
        reasons.note("", "all subjects order the conditions alike, so nothing is left to compare the difference with");
    }
    let result = Conover { t, df, p: t.map(|t| t_two_sided(t, df as f64)), p_holm: None };
    (result, reasons)
}
