//! Whether a printed p follows from the printed coefficient and degrees of freedom.

use serde::{Deserialize, Serialize};

use crate::{StatsError, correlation::p_of_r, numerics::decimal::places_of};

/// A correlation as it is printed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReportedCorrelation {
    /// As printed, such as `-.71`.
    pub coefficient: String,
    /// Degrees of freedom.
    pub df: usize,
    /// As printed, such as `<.001`, `=.012` or `.012`.
    pub p: String,
}

/// What the printed coefficient implies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recheck {
    /// Two-sided p of the coefficient as printed: t = r √(df / (1 - r²)).
    pub p: f64,
    /// Smallest and largest p of any coefficient that rounds to the printed one.
    pub p_range: [f64; 2],
    /// Whether the printed p, rounded as it is, can come from that range.
    pub consistent: bool,
}

/// One answer a printed correlation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecheckAnalysis {
    /// In the order given.
    pub row: Vec<Recheck>,
}

/// Recomputes p of printed correlations.
///
/// Spearman's p by an exact method may differ a little from this; a printed p that is off
/// by a factor does not.
///
/// # Errors
/// [`StatsError::Unreadable`] if a coefficient or p is no number;
/// [`StatsError::BadParameter`] without degrees of freedom.
///
/// # Example
/// ```
/// use maveric_stats::{ReportedCorrelation, recheck};
/// let printed = |p: &str| ReportedCorrelation { coefficient: "-.48".into(), df: 22, p: p.into() };
/// let rows = recheck(&[printed("=.018"), printed("=.0018")])?.row;
/// assert!(rows[0].consistent && !rows[1].consistent);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn recheck(reported: &[ReportedCorrelation]) -> Result<RecheckAnalysis, StatsError> {
    let row = reported
        .iter()
        .enumerate()
        .map(|(row, printed)| one(row, printed))
        .collect::<Result<_, _>>()?;
    Ok(RecheckAnalysis { row })
}

fn one(row: usize, printed: &ReportedCorrelation) -> Result<Recheck, StatsError> {
    if printed.df == 0 {
        return Err(StatsError::parameter("df", "at least 1", 0.0));
    }
    let df = printed.df as f64;
    let (r, half) = number(row, "coefficient", &printed.coefficient)?;
    if r.abs() > 1.0 {
        return Err(StatsError::parameter("coefficient", "from -1 to 1", r));
    }
    let text = printed.p.trim();
    let (relation, digits) = match text.chars().next() {
        Some(c @ ('<' | '>' | '=')) => (c, &text[1..]),
        _ => ('=', text),
    };
    let (p, p_half) = number(row, "p", digits)?;
    let smallest = p_of_r((r.abs() + half).min(1.0), df);
    let largest = p_of_r((r.abs() - half).max(0.0), df);
    let consistent = match relation {
        '<' => smallest < p,
        '>' => largest > p,
        _ => smallest <= p + p_half && largest >= p - p_half,
    };
    Ok(Recheck { p: p_of_r(r, df), p_range: [smallest, largest], consistent })
}

/// A printed number and half a unit of its last digit.
fn number(row: usize, what: &str, text: &str) -> Result<(f64, f64), StatsError> {
    let cleaned = text.trim().replace('\u{2212}', "-");
    let value = cleaned.parse::<f64>().ok().filter(|v| v.is_finite());
    let value = value.ok_or_else(|| StatsError::Unreadable {
        row,
        what: what.to_owned(),
        text: text.to_owned(),
        expected: "a number such as -.46, or p as <.001 or =.012".to_owned(),
    })?;
    let places = i32::try_from(places_of(&cleaned)).unwrap_or(i32::MAX);
    // Printed decimals stand exactly in the middle of what rounds to them.
    Ok((value, 0.5 * 10.0_f64.powi(-places) * (1.0 + 1e-12)))
}
