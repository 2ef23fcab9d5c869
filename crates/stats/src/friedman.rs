//! Friedman's test: do conditions differ in the ranks that subjects give them?

mod exact;

use serde::{Deserialize, Serialize};

use crate::{
    Interval, Reasons, WithinSubjects,
    numerics::{
        decimal,
        distributions::{chi2_upper, f_upper},
        noncentral::f_ncp_interval,
    },
    ranks,
};

/// Friedman's test, corrected for ties.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Friedman {
    /// χ² = (k-1) Σ (Rj - n(k+1)/2)² / (Σ r² - n k (k+1)²/4).
    pub chi2: Option<f64>,
    /// k - 1.
    pub df: Option<usize>,
    /// P(χ²' ≥ χ²), large-sample.
    pub p: Option<f64>,
    /// Kendall's W = χ² / (n (k-1)): partial eta squared of the ranks.
    pub kendall_w: Option<f64>,
    /// Its 90 % interval, that of partial eta squared for F of the ranks:
    /// ncp / (ncp + (n-1)(k-1)). `bootstrap` gives one that does not lean on F.
    #[serde(flatten, with = "crate::interval::kendall_w_ci90")]
    pub kendall_w_ci90: Interval,
    /// Iman and Davenport's F = (n-1) χ² / (n (k-1) - χ²).
    #[serde(rename = "F")]
    pub f: Option<f64>,
    /// k - 1.
    #[serde(rename = "F_df1")]
    pub f_df1: Option<f64>,
    /// (n-1)(k-1).
    #[serde(rename = "F_df2")]
    pub f_df2: Option<f64>,
    /// p of F with those degrees of freedom.
    #[serde(rename = "F_p")]
    pub f_p: Option<f64>,
    /// p of F with k-1-2/n and n-1 times that, as Marozzi (2014) has it.
    #[serde(rename = "F_p_marozzi")]
    pub f_p_marozzi: Option<f64>,
    /// All orders within subjects, given the ties.
    pub p_exact: Option<f64>,
}

/// Doubled ranks within subjects, and what the tests after Friedman's need of them.
pub(crate) struct RankTable {
    pub(crate) n: usize,
    pub(crate) k: usize,
    /// Row-major, shape `(n, k)`, twice the mid-ranks.
    pub(crate) doubled: Vec<i64>,
    /// Twice the rank sum of each condition.
    pub(crate) sums: Vec<i64>,
    /// Four times Σ r².
    pub(crate) squares: i64,
}

impl RankTable {
    pub(crate) fn new(data: &WithinSubjects) -> Self {
        let mut table = Self {
            n: data.n(),
            k: data.k(),
            doubled: Vec::with_capacity(data.values().len()),
            sums: vec![0; data.k()],
            squares: 0,
        };
        for row in decimal::tied(data.values()).chunks_exact(data.k()) {
            let (ranks, _) = ranks::doubled(row);
            for (sum, rank) in table.sums.iter_mut().zip(&ranks) {
                *sum += rank;
                table.squares += rank * rank;
            }
            table.doubled.extend(ranks);
        }
        table
    }

    /// The table in which subject i occurs `counts[i]` times.
    pub(crate) fn resampled(&self, counts: &[u32]) -> Self {
        let mut table =
            Self { n: 0, k: self.k, doubled: Vec::new(), sums: vec![0; self.k], squares: 0 };
        for (row, &count) in self.doubled.chunks_exact(self.k).zip(counts) {
            let count = i64::from(count);
            table.n += count as usize;
            for (sum, rank) in table.sums.iter_mut().zip(row) {
                *sum += count * rank;
                table.squares += count * rank * rank;
            }
        }
        table
    }

    /// Four times Σ (Rj - mean)².
    pub(crate) fn spread(&self) -> i64 {
        let mean = (self.n * (self.k + 1)) as i64;
        self.sums.iter().map(|s| (s - mean) * (s - mean)).sum()
    }

    /// Four times Σ (r - mean)².
    fn within(&self) -> i64 {
        let k = self.k as i64;
        self.squares - self.n as i64 * k * (k + 1) * (k + 1)
    }

    /// Kendall's W; `None` if every subject ties all conditions.
    pub(crate) fn kendall_w(&self) -> Option<f64> {
        let within = self.within();
        (within > 0).then(|| self.spread() as f64 / (within as f64 * self.n as f64))
    }

    /// Whether all subjects order the conditions alike, so that nothing is left over.
    pub(crate) fn unanimous(&self) -> bool {
        self.within() * self.n as i64 == self.spread()
    }
}

/// How exact p is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Exact {
    /// Up to the size that takes about a tenth of a second.
    Feasible,
    /// Not at all, as in a simulation.
    No,
}

pub(crate) fn test(table: &RankTable, exact: Exact) -> (Friedman, Reasons) {
    let mut reasons = Reasons::default();
    let (n, k) = (table.n as f64, table.k as f64);
    let within = table.within();
    if within == 0 {
        let reason = "every subject ties all conditions, so there are no ranks to compare";
        reasons.note("", reason);
        return (Friedman::default(), reasons);
    }
    let chi2 = (k - 1.0) * table.spread() as f64 / within as f64;
    let (d1, d2) = (k - 1.0, (n - 1.0) * (k - 1.0));
    let f = (!table.unanimous()).then(|| (n - 1.0) * chi2 / (n * (k - 1.0) - chi2));
    if f.is_none() {
        let reason = "all subjects order the conditions alike, so F has no finite value";
        reasons.note_all(&["F", "F_p", "F_p_marozzi"], reason);
        reasons.note_ends(&["kendall_w_ci90"], reason);
    }
    let interval = f.and_then(|f| f_ncp_interval(f, d1, d2, 0.05));
    if interval.is_none() {
        let reason = "the noncentral F cannot be inverted here";
        reasons.note_ends(&["kendall_w_ci90"], reason);
    }
    let d1_marozzi = d1 - 2.0 / n;
    let marozzi =
        f.filter(|_| d1_marozzi > 0.0).map(|f| f_upper(f, d1_marozzi, (n - 1.0) * d1_marozzi));
    if marozzi.is_none() {
        let reason = "with two subjects and two conditions it has no degrees of freedom";
        reasons.note("F_p_marozzi", reason);
    }
    let p_exact = match exact {
        Exact::Feasible => exact::p_value(table),
        Exact::No => None,
    };
    if p_exact.is_none() {
        let reason = match exact {
            Exact::Feasible => "not computed: there are too many arrangements of the ranks",
            Exact::No => "not computed: not asked for",
        };
        reasons.note("p_exact", reason);
    }
    let friedman = Friedman {
        chi2: Some(chi2),
        df: Some(table.k - 1),
        p: Some(chi2_upper(chi2, d1)),
        kendall_w: table.kendall_w(),
        kendall_w_ci90: Interval::from(interval).map(|ncp| ncp / (ncp + d2)),
        f,
        f_df1: Some(d1),
        f_df2: Some(d2),
        f_p: f.map(|f| f_upper(f, d1, d2)),
        f_p_marozzi: marozzi,
        p_exact,
    };
    (friedman, reasons)
}
