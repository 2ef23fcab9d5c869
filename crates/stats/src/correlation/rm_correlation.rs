//! Correlation within people who answered several times.

use serde::{Deserialize, Serialize};

use super::{fisher_interval, p_of_r, pearson};
use crate::{
    Interval, Reasons, StatsError, complete, numerics::moments::centred, within_subjects::Index,
};

/// The common correlation within subjects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RmCorrelation {
    /// Correlation of x and y after each subject's means are taken out.
    pub r: Option<f64>,
    /// Pairs less subjects less 1.
    pub df: Option<usize>,
    /// Two-sided, t = r √(df / (1 - r²)).
    pub p: Option<f64>,
    /// The 95 % interval by Fisher's z, standard error 1/√(df-1).
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
    /// The common slope of y on x within subjects.
    pub slope: Option<f64>,
}

/// Repeated-measures correlation of two columns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RmCorrelationAnalysis {
    /// Complete pairs.
    pub n: usize,
    /// Subjects with a complete pair.
    pub subjects: usize,
    /// Pairs left out because a member is missing.
    pub missing: usize,
    /// The correlation within subjects.
    pub rm_corr: RmCorrelation,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Correlates columns of shape `(rows,)` within the subjects named beside them.
///
/// # Errors
/// [`StatsError::LengthMismatch`]; [`StatsError::NotFinite`]; [`StatsError::TooFew`] below
/// two subjects.
///
/// # Source
/// Bland and Altman (1995); Bakdash and Marusich (2017), as pingouin's `rm_corr`.
///
/// # Example
/// ```
/// use maveric_stats::rm_correlation;
/// let subjects = ["a", "a", "a", "b", "b", "b"].map(str::to_owned);
/// // Within both people y falls with x, although b has more of both.
/// let x = [1.0, 2.0, 3.0, 11.0, 12.0, 13.0].map(Some);
/// let y = [3.0, 2.5, 1.0, 13.0, 12.0, 11.5].map(Some);
/// let result = rm_correlation(&subjects, &x, &y)?.rm_corr;
/// assert!(result.r.unwrap() < -0.9 && result.df == Some(3));
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn rm_correlation(
    subjects: &[String],
    x: &[Option<f64>],
    y: &[Option<f64>],
) -> Result<RmCorrelationAnalysis, StatsError> {
    StatsError::same_length("subject", subjects.len(), x.len())?;
    let complete = complete::rows(&[("x", x), ("y", y)], "pair", 1)?;
    let index = Index::from_labels(complete.kept.iter().map(|&row| &subjects[row]));
    let n = complete.kept.len();
    complete::enough("subject", index.names.len(), 0, 2)?;
    let within = |column: &[f64]| {
        let mut result = vec![0.0; column.len()];
        for rows in index.members() {
            let values: Vec<f64> = rows.iter().map(|&r| column[r]).collect();
            for (row, value) in rows.into_iter().zip(centred(&values)) {
                result[row] = value;
            }
        }
        result
    };
    let (dx, dy) = (within(&complete.columns[0]), within(&complete.columns[1]));
    let mut undefined = Reasons::default();
    let df = n.saturating_sub(index.names.len() + 1);
    let r = if df == 0 { None } else { pearson::coefficient(&dx, &dy) };
    if r.is_none() {
        let reason = if df == 0 {
            "there are too few repeated pairs: no degrees of freedom are left"
        } else {
            "x or y does not vary within subjects"
        };
        undefined.note("rm_corr", reason);
    }
    let interval = r.filter(|_| df > 1).map(|r| fisher_interval(r, 1.0 / (df as f64 - 1.0).sqrt()));
    if interval.is_none() {
        let reason = "the interval needs at least two degrees of freedom";
        undefined.note_ends(&["rm_corr.ci"], reason);
    }
    let slope = r.map(|_| {
        let product: f64 = dx.iter().zip(&dy).map(|(a, b)| a * b).sum();
        product / dx.iter().map(|a| a * a).sum::<f64>()
    });
    Ok(RmCorrelationAnalysis {
        n,
        subjects: index.names.len(),
        missing: complete.missing,
        rm_corr: RmCorrelation {
            r,
            df: r.map(|_| df),
            p: r.map(|r| p_of_r(r, df as f64)),
            ci: interval.into(),
            slope,
        },
        undefined,
    })
}
