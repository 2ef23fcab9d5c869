//! Nemenyi's comparisons after Friedman's test.

use serde::{Deserialize, Serialize};

use crate::{friedman::RankTable, numerics::studentized_range};

/// A difference of mean ranks against the studentised range of k groups.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Nemenyi {
    /// |mean rank of A - mean rank of B| / √(k (k+1) / (12 n)).
    pub q: f64,
    /// P(range of k ≥ q), infinite degrees of freedom; corrected for all pairs already.
    pub p: f64,
}

/// Compares conditions `a` and `b` (from 0).
///
/// # Source
/// Demšar (2006); as `scikit_posthocs.posthoc_nemenyi_friedman`, without a tie correction.
pub(crate) fn test(table: &RankTable, a: usize, b: usize) -> Nemenyi {
    let (n, k) = (table.n as f64, table.k as f64);
    let difference = (table.sums[a] - table.sums[b]).abs() as f64 / (2.0 * n);
    let q = difference / (k * (k + 1.0) / (12.0 * n)).sqrt();
    Nemenyi { q, p: studentized_range::upper(q, table.k) }
}
