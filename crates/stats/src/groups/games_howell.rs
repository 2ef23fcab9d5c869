//! Games and Howell's comparison of pairs.

use serde::{Deserialize, Serialize};

use super::{
    Sample,
    t::{no_welch_error, welch_error},
};
use crate::{Interval, Reasons, numerics::studentized_range};

/// Welch's t of two of several groups, by the studentised range of all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GamesHowell {
    /// Difference over its standard error, as Welch.
    pub t: Option<f64>,
    /// Welch's degrees of freedom.
    pub df: Option<f64>,
    /// P(range of k means > |t| √2): already for all pairs.
    pub p: Option<f64>,
    /// The simultaneous 95 % interval of the difference.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

pub(super) fn test(a: &Sample, b: &Sample, k: usize) -> (GamesHowell, Reasons) {
    let mut reasons = Reasons::default();
    let error = welch_error(a, b);
    if error.is_none() {
        reasons.note("", no_welch_error(a, b));
    }
    let difference = a.mean - b.mean;
    let t = error.map(|(se, _)| difference / se);
    let root = std::f64::consts::SQRT_2;
    let p =
        error.zip(t).map(|((_, df), t)| studentized_range::upper_with_df(t.abs() * root, k, df));
    let half = error.and_then(|(se, df)| {
        let q = studentized_range::quantile_upper(0.05, k, df)?;
        Some(q * se / root)
    });
    if half.is_none() {
        let reason = "the studentised range has no quantile at these degrees of freedom";
        reasons.note_ends(&["ci"], reason);
    }
    let result =
        GamesHowell { t, df: error.map(|(_, df)| df), p, ci: Interval::around(difference, half) };
    (result, reasons)
}
