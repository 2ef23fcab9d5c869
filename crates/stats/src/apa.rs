//! Test results as APA writes them.
//!
//! A [`Statement`] carries italics for figures and pages; `to_string()` gives plain text. A value
//! that is not finite is written as `n/a`: a report string never shows `NaN`. Results say
//! themselves by [`Statements`], and by `Display`.

mod designs;
mod parts;
mod results;

pub use results::Statements;

use crate::{Adjustment, Interval, markup};
use std::fmt;

/// A formatted result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Statement(String);

impl Statement {
    /// With marks (see [`crate::markup`]), for figures, tables and captions.
    pub fn markup(&self) -> &str {
        &self.0
    }

    /// `t(23) = −5.90`: a statistic with its degrees of freedom.
    fn with_df(symbol: &str, degrees_of_freedom: &[f64], value: f64) -> Self {
        let df: Vec<String> = degrees_of_freedom.iter().map(|df| degrees(*df)).collect();
        let df = if df.is_empty() { String::new() } else { format!("({})", df.join(", ")) };
        Self(format!("{symbol}{df} = {}", number(value, 2)))
    }

    /// `F(3, 69) = 25.23, p < .001`.
    fn f_test(degrees_of_freedom: [f64; 2], value: f64, p: f64) -> Self {
        Self::with_df("*F*", &degrees_of_freedom, value).p(p, Adjustment::None)
    }

    /// `…, dz = −1.20`.
    fn and(mut self, symbol: &str, value: &str) -> Self {
        self.0.push_str(&[", ", symbol, " = ", value].concat());
        self
    }

    /// The same of a number bounded by 1; nothing without one.
    fn and_bounded(self, symbol: &str, value: Option<f64>) -> Self {
        match value {
            Some(value) => self.and(symbol, &bounded(value, 2)),
            None => self,
        }
    }

    /// `…, p_Holm = .012`.
    fn p(self, p: f64, adjusted: Adjustment) -> Self {
        self.p_named(p_symbol(adjusted), p)
    }

    /// The same of a p with a symbol of its own, because it is not that of the statistic before it.
    fn p_named(mut self, symbol: &str, p: f64) -> Self {
        self.0 += ", ";
        self.0 += &probability(symbol, p);
        self
    }

    /// `…, 95% CI [−1.73, −0.67]`; nothing without an interval.
    fn ci(self, level: f64, ci: Interval, write: fn(f64, usize) -> String) -> Self {
        self.interval(level, ci, |end| write(end, 2))
    }

    /// The same in the unit of the values, which may be small.
    fn ci_of_values(self, level: f64, ci: Interval) -> Self {
        self.interval(level, ci, |end| of_values(end, ci))
    }

    fn interval(mut self, level: f64, ci: Interval, write: impl Fn(f64) -> String) -> Self {
        if let Some((low, high)) = ci.ends() {
            let level = number(level * 100.0, 0);
            let ends = [write(low), write(high)].join(", ");
            self.0.push_str(&[", ", &level, "% CI [", &ends, "]"].concat());
        }
        self
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&markup::plain(&self.0))
    }
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

/// Decimals at which half the width of an interval has two significant digits; 0 without one.
///
/// # Example
/// ```
/// use maveric_stats::{Interval, apa::decimals_inside};
/// assert_eq!(decimals_inside(Interval::from((-0.0010, -0.0002))), 5);
/// assert_eq!(decimals_inside(Interval::from((12_033.8, 12_034.4))), 2);
/// assert_eq!(decimals_inside(Interval::default()), 0);
/// ```
pub fn decimals_inside(ci: Interval) -> usize {
    let half = ci.ends().map_or(0.0, |(low, high)| (high - low) / 2.0);
    two_digits(half, 15)
}

/// Decimals at which a width has two significant digits, at most so many; 0 without a width.
fn two_digits(width: f64, most: usize) -> usize {
    if !(width > 0.0 && width.is_finite()) {
        return 0;
    }
    let decimals = 1 - libm::log10(width).floor() as i32;
    usize::try_from(decimals).unwrap_or(0).min(most)
}

/// An estimate or an end of an interval in the unit of the values: two decimals, or as many as show how wide the interval is.
fn of_values(value: f64, ci: Interval) -> String {
    number(value, decimals_inside(ci).max(2))
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

/// Decimals that show two digits of a spread, in the unit of the numbers beside it: at least two, at most six.
///
/// # Example
/// ```
/// use maveric_stats::apa::decimals;
/// assert_eq!([12.0, 0.1, 0.03, 0.004, 0.0].map(decimals), [2, 2, 3, 4, 2]);
/// ```
pub fn decimals(spread: f64) -> usize {
    two_digits(spread, 6).max(2)
}

/// Decimals of numbers beside the standard deviations of their conditions, by how much people differ in them on the whole. A condition in
/// which nobody differs says nothing of that.
///
/// # Example
/// ```
/// use maveric_stats::apa::decimals_among;
/// assert_eq!(decimals_among([0.0, 0.03, 0.04]), 3);
/// assert_eq!(decimals_among([0.0]), 2);
/// ```
pub fn decimals_among(spreads: impl IntoIterator<Item = f64>) -> usize {
    let variances = spreads.into_iter().map(|sd| sd * sd);
    let variances: Vec<f64> = variances.filter(|variance| *variance > 0.0).collect();
    let variance = variances.iter().sum::<f64>() / variances.len().max(1) as f64;
    decimals(variance.sqrt())
}

/// Degrees of freedom: whole if they are, else two decimals.
pub fn degrees(value: f64) -> String {
    let whole = (value - value.round()).abs() < 1e-9;
    number(value, if whole { 0 } else { 2 })
}

/// A p without its symbol, as a table's cell has it: `.024`, `< .001`.
pub fn p_cell(p: f64) -> String {
    if p < 0.001 { "< .001".to_owned() } else { bounded(p, 3) }
}

fn probability(symbol: &str, p: f64) -> String {
    if !p.is_finite() {
        return format!("{symbol} n/a");
    }
    if p < 0.001 { format!("{symbol} < .001") } else { format!("{symbol} = {}", bounded(p, 3)) }
}

/// `p_Holm` and its like, with marks.
pub fn p_symbol(adjusted: Adjustment) -> &'static str {
    match adjusted {
        Adjustment::Holm => "*p*_{Holm}",
        Adjustment::Bonferroni => "*p*_{Bonferroni}",
        Adjustment::Hochberg => "*p*_{Hochberg}",
        Adjustment::Bh => "*p*_{BH}",
        Adjustment::None => "*p*",
    }
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
/// assert_eq!(maveric_stats::apa::r(0.46, 22, 0.0237).to_string(), "r(22) = .46, p = .024");
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
    Statement(format!("{symbol}({df}) = {}", bounded(value, 2))).p(p, Adjustment::None)
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
    /// Its 90 % interval.
    pub eta2_partial_ci90: Interval,
    /// Epsilon of the sphericity correction that was applied.
    pub epsilon: Option<f64>,
}

/// `F(3, 69) = 25.23, p < .001, ηp² = .52, 90% CI [.38, .62]`; corrected: `…, ε = .92`.
pub fn f(test: &F) -> Statement {
    Statement::f_test([test.df_effect, test.df_error], test.f, test.p)
        .and_bounded("*η*_{p}^{2}", test.eta2_partial)
        .ci(0.9, test.eta2_partial_ci90.holding(test.eta2_partial), bounded)
        .and_bounded("*ε*", test.epsilon)
}

/// `χ²(3, N = 24) = 41.19, p < .001, W = .57`: Friedman's test with Kendall's W.
pub fn chi2(statistic: f64, df: usize, n: usize, p: f64, kendall_w: Option<f64>) -> Statement {
    let p = (p_symbol(Adjustment::None), p);
    of_n("*χ*^{2}", statistic, [df, n], p, kendall_w)
}

/// `Q(3, N = 24) = 7.53, p = .057, W = .10`: a statistic of n people, p with its symbol, and Kendall's W.
fn of_n(
    symbol: &str,
    value: f64,
    [df, n]: [usize; 2],
    (p_symbol, p): (&str, f64),
    w: Option<f64>,
) -> Statement {
    let written = number(value, 2);
    Statement(format!("{symbol}({df}, *N* = {n}) = {written}"))
        .p_named(p_symbol, p)
        .and_bounded("*W*", w)
}

/// `t(23) = −5.90, p_Holm < .001, dz = −1.20, 95% CI [−1.73, −0.67]`; dz with its 95 % interval.
pub fn t(
    statistic: f64,
    df: f64,
    p: f64,
    adjusted: Adjustment,
    dz: Option<(f64, Interval)>,
) -> Statement {
    let statement = Statement::with_df("*t*", &[df], statistic).p(p, adjusted);
    match dz {
        Some((dz, ci)) => statement.and("*d*_{z}", &number(dz, 2)).ci(0.95, ci, number),
        None => statement,
    }
}

/// `V = 45, p_Holm = .012, r_rb = −.52`: Wilcoxon's signed ranks with the rank-biserial correlation.
pub fn wilcoxon(v: f64, p: f64, adjusted: Adjustment, rank_biserial: Option<f64>) -> Statement {
    Statement(format!("*V* = {}", degrees(v))).p(p, adjusted).and_bounded("*r*_{rb}", rank_biserial)
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
            eta2_partial_ci90: (0.381, 0.617).into(),
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
            eta2_partial_ci90: Interval::default(),
            ..test
        };
        assert_eq!(
            f(&corrected).to_string(),
            "F(2.76, 63.49) = 25.23, p < .001, ηp² = .52, ε = .92"
        );
    }

    #[test]
    fn an_interval_that_leaves_its_estimate_out_is_not_printed() {
        let tiny = F {
            f: 0.09,
            df_effect: 3.0,
            df_error: 6.0,
            p: 0.96,
            eta2_partial: Some(0.04),
            eta2_partial_ci90: (0.0, 0.0).into(),
            epsilon: None,
        };
        assert_eq!(f(&tiny).to_string(), "F(3, 6) = 0.09, p = .960, ηp² = .04");
    }

    #[test]
    fn friedman_names_n_and_w() {
        let written = chi2(41.19, 3, 24, 1e-8, Some(0.572)).to_string();
        assert_eq!(written, "χ²(3, N = 24) = 41.19, p < .001, W = .57");
    }

    #[test]
    fn paired_t_keeps_the_zero_of_an_unbounded_effect() {
        let ci = (-1.73, -0.67).into();
        let written = t(-5.9, 23.0, 2e-6, Adjustment::Holm, Some((-1.2, ci))).to_string();
        assert_eq!(written, "t(23) = −5.90, p_Holm < .001, dz = −1.20, 95% CI [−1.73, −0.67]");
    }

    #[test]
    fn an_interval_in_a_small_unit_is_no_row_of_zeros() {
        let ci = (-0.001_04, -0.000_21).into();
        let said = Statement("estimate".to_owned()).ci_of_values(0.9, ci);
        assert_eq!(said.to_string(), "estimate, 90% CI [−0.00104, −0.00021]");
        assert_eq!(of_values(-0.000_62, ci), "−0.00062");
        // Two decimals where they are enough, or nothing has a width.
        let said = |low: f64, high: f64| {
            let said = Statement("estimate".to_owned()).ci_of_values(0.95, (low, high).into());
            said.to_string()
        };
        assert_eq!(said(-0.2, 0.114), "estimate, 95% CI [−0.20, 0.11]");
        assert_eq!(said(120.0, 160.0), "estimate, 95% CI [120.00, 160.00]");
        assert_eq!(said(3.0, 3.0), "estimate, 95% CI [3.00, 3.00]");
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
