//! Test results as APA writes them, from plain numbers.
//!
//! [`Statement`] carries italics for figures and pages; `to_string()` gives plain text. A value
//! that is not finite is written as `n/a`: a report string never shows `NaN`.

use crate::markup;
use std::fmt::{self, Write as _};

/// A formatted result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Statement(String);

impl Statement {
    /// With marks (see [`crate::markup`]), for figures, tables and captions.
    pub fn markup(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&markup::plain(&self.0))
    }
}

/// An interval with its level, such as 0.95.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Level in 0..1.
    pub level: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A number with a true minus sign and fixed decimals: `−5.90`.
pub fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "n/a".to_owned();
    }
    let written = format!("{value:.decimals$}");
    match written.strip_prefix('-') {
        Some(rest) if rest.chars().all(|sign| sign == '0' || sign == '.') => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => written,
    }
}

/// A number bounded by 1, without the zero before the point: `.46`, `−.05`, `1.00`.
pub fn bounded(value: f64, decimals: usize) -> String {
    let written = number(value, decimals);
    match written.strip_prefix("−0.") {
        Some(rest) => format!("−.{rest}"),
        None => match written.strip_prefix("0.") {
            Some(rest) => format!(".{rest}"),
            None => written,
        },
    }
}

/// Degrees of freedom: whole if they are, else two decimals.
fn degrees(value: f64) -> String {
    let whole = (value - value.round()).abs() < 1e-9;
    number(value, if whole { 0 } else { 2 })
}

fn probability(symbol: &str, p: f64) -> String {
    if !p.is_finite() {
        return format!("{symbol} n/a");
    }
    if p < 0.001 {
        format!("{symbol} < .001")
    } else {
        format!("{symbol} = {}", bounded(p, 3))
    }
}

fn interval(interval: Interval, write: impl Fn(f64) -> String) -> String {
    let level = number(interval.level * 100.0, 0);
    format!(
        ", {level}% CI [{}, {}]",
        write(interval.low),
        write(interval.high)
    )
}

/// `p = .024`, `p < .001`.
pub fn p(p: f64) -> Statement {
    Statement(probability("*p*", p))
}

/// `p_Holm = .024`.
pub fn p_holm(p: f64) -> Statement {
    Statement(probability("*p*_{Holm}", p))
}

/// `r(22) = .46, p = .024`.
///
/// # Example
/// ```
/// assert_eq!(maveric_report::apa::r(0.46, 22, 0.0237).to_string(), "r(22) = .46, p = .024");
/// ```
pub fn r(r: f64, df: usize, p: f64) -> Statement {
    correlation("*r*", r, df, p)
}

/// `ρ(22) = −.71, p < .001`: Spearman's.
pub fn rho(rho: f64, df: usize, p: f64) -> Statement {
    correlation("*ρ*", rho, df, p)
}

/// `r_rm(71) = .34, p = .004`: repeated-measures correlation.
pub fn r_rm(r: f64, df: usize, p: f64) -> Statement {
    correlation("*r*_{rm}", r, df, p)
}

fn correlation(symbol: &str, value: f64, df: usize, p: f64) -> Statement {
    Statement(format!(
        "{symbol}({df}) = {}, {}",
        bounded(value, 2),
        probability("*p*", p)
    ))
}

/// An F test, as repeated-measures ANOVA gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct F {
    /// The statistic.
    pub f: f64,
    /// Degrees of freedom of the effect, already corrected if `epsilon` is given.
    pub df_effect: f64,
    /// Degrees of freedom of the error, likewise.
    pub df_error: f64,
    /// p value, after the correction if there is one.
    pub p: f64,
    /// Partial eta squared.
    pub eta2_partial: Option<f64>,
    /// Its interval.
    pub interval: Option<Interval>,
    /// Epsilon of the sphericity correction that was applied.
    pub epsilon: Option<f64>,
}

/// `F(3, 69) = 25.23, p < .001, ηp² = .52, 90% CI [.38, .62]`; corrected: `…, ε = .92`.
pub fn f(test: &F) -> Statement {
    let mut out = format!(
        "*F*({}, {}) = {}, {}",
        degrees(test.df_effect),
        degrees(test.df_error),
        number(test.f, 2),
        probability("*p*", test.p)
    );
    if let Some(eta2) = test.eta2_partial {
        let _ = write!(out, ", *η*_{{p}}^{{2}} = {}", bounded(eta2, 2));
    }
    if let Some(ci) = test.interval {
        out += &interval(ci, |value| bounded(value, 2));
    }
    if let Some(epsilon) = test.epsilon {
        let _ = write!(out, ", *ε* = {}", bounded(epsilon, 2));
    }
    Statement(out)
}

/// `χ²(3, N = 24) = 41.19, p < .001, W = .57`: Friedman's test with Kendall's W.
pub fn chi2(statistic: f64, df: usize, n: usize, p: f64, kendall_w: Option<f64>) -> Statement {
    let mut out = format!(
        "*χ*^{{2}}({df}, *N* = {n}) = {}, {}",
        number(statistic, 2),
        probability("*p*", p)
    );
    if let Some(w) = kendall_w {
        let _ = write!(out, ", *W* = {}", bounded(w, 2));
    }
    Statement(out)
}

/// `t(23) = −5.90, p_Holm < .001, dz = −1.20, 95% CI [−1.73, −0.67]`.
pub fn t(
    statistic: f64,
    df: usize,
    p_holm: f64,
    effect: Option<(f64, Option<Interval>)>,
) -> Statement {
    let mut out = format!(
        "*t*({df}) = {}, {}",
        number(statistic, 2),
        probability("*p*_{Holm}", p_holm)
    );
    if let Some((dz, ci)) = effect {
        let _ = write!(out, ", *d*_{{z}} = {}", number(dz, 2));
        if let Some(ci) = ci {
            out += &interval(ci, |value| number(value, 2));
        }
    }
    Statement(out)
}

/// `V = 45, p_Holm = .012, r_rb = −.52`: Wilcoxon's signed ranks with the rank-biserial correlation.
pub fn wilcoxon(v: f64, p_holm: f64, rank_biserial: Option<f64>) -> Statement {
    let mut out = format!(
        "*V* = {}, {}",
        degrees(v),
        probability("*p*_{Holm}", p_holm)
    );
    if let Some(effect) = rank_biserial {
        let _ = write!(out, ", *r*_{{rb}} = {}", bounded(effect, 2));
    }
    Statement(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_measures_anova_reads_as_the_manual_has_it() {
        let test = F {
            f: 25.231,
            df_effect: 3.0,
            df_error: 69.0,
            p: 3.2e-11,
            eta2_partial: Some(0.523),
            interval: Some(Interval {
                level: 0.9,
                low: 0.381,
                high: 0.617,
            }),
            epsilon: None,
        };
        assert_eq!(
            f(&test).to_string(),
            "F(3, 69) = 25.23, p < .001, ηp² = .52, 90% CI [.38, .62]"
        );
        let corrected = F {
            df_effect: 2.76,
            df_error: 63.49,
            epsilon: Some(0.92),
            interval: None,
            ..test
        };
        assert_eq!(
            f(&corrected).to_string(),
            "F(2.76, 63.49) = 25.23, p < .001, ηp² = .52, ε = .92"
        );
    }

    #[test]
    fn friedman_names_n_and_w() {
        let written = chi2(41.19, 3, 24, 1e-8, Some(0.572)).to_string();
        assert_eq!(written, "χ²(3, N = 24) = 41.19, p < .001, W = .57");
    }

    #[test]
    fn paired_t_keeps_the_zero_of_an_unbounded_effect() {
        let ci = Interval {
            level: 0.95,
            low: -1.73,
            high: -0.67,
        };
        let written = t(-5.9, 23, 2e-6, Some((-1.2, Some(ci)))).to_string();
        assert_eq!(
            written,
            "t(23) = −5.90, p_Holm < .001, dz = −1.20, 95% CI [−1.73, −0.67]"
        );
    }

    #[test]
    fn what_is_bounded_by_one_has_no_leading_zero() {
        assert_eq!(bounded(0.456, 2), ".46");
        assert_eq!(bounded(-0.05, 2), "−.05");
        assert_eq!(bounded(1.0, 2), "1.00");
        assert_eq!(bounded(-0.001, 2), ".00");
        assert_eq!(r(-0.46, 22, 0.0237).to_string(), "r(22) = −.46, p = .024");
        assert_eq!(p(0.000_99).to_string(), "p < .001");
        assert_eq!(p(1.0).to_string(), "p = 1.000");
    }

    #[test]
    fn a_missing_result_is_not_printed_as_a_number() {
        assert_eq!(r(f64::NAN, 22, f64::NAN).to_string(), "r(22) = n/a, p n/a");
    }
}
