//! How two columns go together.

mod kendall;
mod pearson;
mod rm_correlation;
mod spearman;
mod spearman_exact;

use serde::{Deserialize, Serialize};

pub use kendall::Kendall;
pub use pearson::Pearson;
pub use rm_correlation::{RmCorrelation, RmCorrelationAnalysis, rm_correlation};
pub use spearman::{Spearman, SpearmanCompat};

pub(crate) use pearson::coefficient;

use crate::{
    Reasons, StatsError, apa, complete,
    normality::shapiro_wilk,
    numerics::distributions::{
        fisher_ends, fisher_interval, normal_quantile, t_quantile_two_sided, t_two_sided,
    },
};

/// Which coefficient is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum CorrelationMethod {
    /// Pearson's r.
    Pearson,
    /// Spearman's ρ.
    Spearman,
    /// Kendall's τ-b.
    Kendall,
    /// Pearson if Shapiro and Wilk reject neither column at 5 %, else Spearman.
    #[default]
    Auto,
    /// All three.
    All,
}

/// The correlation of two columns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Correlation {
    /// Complete pairs.
    pub n: usize,
    /// Pairs left out because a member is missing.
    pub missing: usize,
    /// Pearson's r, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pearson: Option<Pearson>,
    /// Spearman's ρ, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spearman: Option<Spearman>,
    /// Kendall's τ-b, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kendall: Option<Kendall>,
    /// What [`CorrelationMethod::Auto`] chose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen: Option<CorrelationMethod>,
    /// Why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reasons: Vec<String>,
    /// What a reader should know before believing p.
    pub warnings: Vec<String>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Correlates two columns of shape `(rows,)`; a pair with a missing member is left out.
///
/// Give `subjects` where the rows belong to people: if one occurs twice, the rows are not
/// independent and a warning names [`rm_correlation`].
///
/// # Errors
/// [`StatsError::LengthMismatch`]; [`StatsError::NotFinite`]; [`StatsError::TooFew`] below
/// two complete pairs.
///
/// # Source
/// At each field of [`Pearson`], [`Spearman`] and [`Kendall`].
///
/// # Example
/// ```
/// use maveric_stats::{CorrelationMethod, correlate};
/// // Anscombe (1973), first set.
/// let x = [10.0, 8.0, 13.0, 9.0, 11.0, 14.0, 6.0, 4.0, 12.0, 7.0, 5.0].map(Some);
/// let y = [8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68].map(Some);
/// let result = correlate(&x, &y, CorrelationMethod::All, None)?;
/// assert!((result.pearson.unwrap().r.unwrap() - 0.8164).abs() < 1e-4);
/// assert!((result.spearman.unwrap().p.unwrap() - 0.0033).abs() < 1e-4); // exact
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
///
/// Lightness and quality of canned tuna (Hollander and Wolfe, 1973, p. 185; R's help of
/// `cor.test`): tau = 0.444, p = .1194.
/// ```
/// use maveric_stats::{CorrelationMethod, correlate};
/// let lightness = [44.4, 45.9, 41.9, 53.3, 44.7, 44.1, 50.7, 45.2, 60.1].map(Some);
/// let quality = [2.6, 3.1, 2.5, 5.0, 3.6, 4.0, 5.2, 2.8, 3.8].map(Some);
/// let result = correlate(&lightness, &quality, CorrelationMethod::Kendall, None)?;
/// let kendall = result.kendall.unwrap();
/// assert!((kendall.tau_b.unwrap() - 0.4444444).abs() < 1e-7);
/// assert!((kendall.p.unwrap() - 0.1194).abs() < 5e-5);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn correlate(
    x: &[Option<f64>],
    y: &[Option<f64>],
    method: CorrelationMethod,
    subjects: Option<&[String]>,
) -> Result<Correlation, StatsError> {
    let complete = complete::rows(&[("x", x), ("y", y)], "pair", 2)?;
    let (x, y) = (&complete.columns[0], &complete.columns[1]);
    let mut result = Correlation {
        n: x.len(),
        missing: complete.missing,
        pearson: None,
        spearman: None,
        kendall: None,
        chosen: None,
        reasons: Vec::new(),
        warnings: repeated_subjects(subjects, &complete.kept)?,
        undefined: Reasons::default(),
    };
    let mut wanted = method;
    if method == CorrelationMethod::Auto {
        (wanted, result.reasons) = choose(x, y);
        result.chosen = Some(wanted);
    }
    let every_method = wanted == CorrelationMethod::All;
    let undefined = &mut result.undefined;
    if every_method || wanted == CorrelationMethod::Pearson {
        result.pearson = Some(undefined.result("pearson", pearson::test(x, y)));
    }
    if every_method || wanted == CorrelationMethod::Spearman {
        result.spearman = Some(undefined.result("spearman", spearman::test(x, y)));
    }
    if every_method || wanted == CorrelationMethod::Kendall {
        result.kendall = Some(undefined.result("kendall", kendall::test(x, y)));
    }
    Ok(result)
}

fn choose(x: &[f64], y: &[f64]) -> (CorrelationMethod, Vec<String>) {
    let mut reasons = Vec::new();
    let mut normal = true;
    for (name, column) in [("x", x), ("y", y)] {
        let (test, _) = shapiro_wilk(column);
        let stands = test.p.is_some_and(|p| p >= 0.05);
        normal &= stands;
        let verdict = if stands { "does not reject" } else { "rejects" };
        reasons.push(match test.p {
            Some(p) => format!("Shapiro-Wilk {verdict} normality of {name} ({})", apa::p(p)),
            None => format!("normality of {name} cannot be tested"),
        });
    }
    let chosen = if normal { CorrelationMethod::Pearson } else { CorrelationMethod::Spearman };
    (chosen, reasons)
}

fn repeated_subjects(
    subjects: Option<&[String]>,
    kept: &[usize],
) -> Result<Vec<String>, StatsError> {
    let Some(subjects) = subjects else {
        return Ok(Vec::new());
    };
    if let Some(&last) = kept.last().filter(|&&row| row >= subjects.len()) {
        StatsError::same_length("subject", subjects.len(), last + 1)?;
    }
    let distinct: std::collections::BTreeSet<_> = kept.iter().map(|&row| &subjects[row]).collect();
    if distinct.len() == kept.len() {
        return Ok(Vec::new());
    }
    Ok(vec![format!(
        "{} pairs come from {} subjects: repeated answers of one person are not independent, so p and interval are too good; use rmcorr (repeated-measures correlation)",
        kept.len(),
        distinct.len()
    )])
}

/// The interval of one of `tests` coefficients that hold together with 95 %: Šidák's level in Fisher's z, with Bonett and Wright's
/// variance for ranks. `None` for fewer than four pairs.
///
/// # Source
/// Šidák (1967), Rectangular confidence regions; Bonett and Wright (2000).
///
/// # Example
/// ```
/// let (low, high) = maveric_stats::simultaneous_interval(0.5, 24, 104, false).unwrap();
/// let (alone, _) = maveric_stats::simultaneous_interval(0.5, 24, 1, false).unwrap();
/// assert!(low < 0.0 && 0.0 < alone && alone < 0.5 && 0.5 < high);
/// ```
pub fn simultaneous_interval(r: f64, n: usize, tests: usize, ranks: bool) -> Option<(f64, f64)> {
    if n < 4 || tests == 0 || !r.is_finite() || r.abs() > 1.0 {
        return None;
    }
    let variance = if ranks { 1.0 + 0.5 * r * r } else { 1.0 };
    let outside = -libm::log1p(-0.05) / tests as f64;
    let tail = -libm::expm1(-outside) / 2.0;
    let half = -normal_quantile(tail) * (variance / (n as f64 - 3.0)).sqrt();
    Some(fisher_ends(r, half))
}

/// The smallest correlation of `n` pairs whose two-sided p by t is below .05 / `tests`, which the least of a family has to be by Holm;
/// `None` below four pairs or without tests.
///
/// # Example
/// ```
/// let least = maveric_stats::least_correlation(24, 104).unwrap();
/// assert!((least - 0.657).abs() < 1e-3);
/// ```
pub fn least_correlation(n: usize, tests: usize) -> Option<f64> {
    if n < 4 || tests == 0 {
        return None;
    }
    let df = n as f64 - 2.0;
    let t = t_quantile_two_sided(0.05 / tests as f64, df)?;
    Some(t / libm::hypot(t, df.sqrt()))
}

/// Two-sided p of a correlation with `df` degrees of freedom: t = r √(df / (1 - r²)); the
/// smallest normal number where r is 1.
pub(crate) fn p_of_r(r: f64, df: f64) -> f64 {
    let rest = (1.0 - r) * (1.0 + r);
    if rest <= 0.0 {
        return f64::MIN_POSITIVE;
    }
    t_two_sided(r * (df / rest).sqrt(), df)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_answers_of_one_person_are_warned_about() {
        let x = [1.0, 2.0, 4.0].map(Some);
        let who = ["a", "b", "a"].map(str::to_owned);
        let result = correlate(&x, &x, CorrelationMethod::Pearson, Some(&who)).unwrap();
        assert!(result.warnings[0].contains("rmcorr"));
        let result =
            correlate(&[Some(1.0), Some(2.0), None], &x, CorrelationMethod::Pearson, Some(&who))
                .unwrap();
        assert!(result.warnings.is_empty() && result.missing == 1);
    }

    #[test]
    fn ranks_in_one_order_have_a_tau_of_one_and_no_interval() {
        let x = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(Some);
        let kendall = |y: [f64; 6]| {
            let found = correlate(&x, &y.map(Some), CorrelationMethod::All, None).unwrap();
            let kendall = found.kendall.unwrap();
            (kendall.tau_b, kendall.ci.ends().is_some())
        };
        assert_eq!(kendall([1.0, 2.0, 4.0, 8.0, 16.0, 32.0]), (Some(1.0), false));
        let (tau, interval) = kendall([2.0, 1.0, 4.0, 8.0, 16.0, 32.0]);
        assert!(tau.unwrap() < 1.0 && interval);
    }

    #[test]
    fn auto_says_what_it_chose_and_why() {
        let x: Vec<_> = (0..20).map(|i| Some(f64::from(i).exp())).collect();
        let result = correlate(&x, &x, CorrelationMethod::Auto, None).unwrap();
        assert_eq!(result.chosen, Some(CorrelationMethod::Spearman));
        assert_eq!(result.reasons.len(), 2);
    }
}
