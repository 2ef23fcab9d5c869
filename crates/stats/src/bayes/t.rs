//! Bayes factors of t tests.

use serde::{Deserialize, Serialize};

use super::{Prior, TOO_LARGE, power};
use crate::{
    Named, Reasons, StatsError, WithinSubjects,
    analysis::by_pair,
    equivalence::less,
    groups::{Samples, student},
    numerics::moments::mean_and_square_sum,
};

/// A JZS Bayes factor: Cauchy prior of scale √2/2 on the standardised effect, Jeffreys' on the variance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BayesT {
    /// Differences or values; of two groups nA nB / (nA + nB), which takes their place.
    pub n: f64,
    /// How many differences or values there are; of two groups how many in each.
    pub values: Vec<usize>,
    /// The t statistic, of two groups with pooled variance.
    pub t: Option<f64>,
    /// Natural logarithm of `bf10`.
    pub log_bf10: Option<f64>,
    /// Likelihood of the data with an effect over that without.
    pub bf10: Option<f64>,
    /// 1 / `bf10`.
    pub bf01: Option<f64>,
}

/// Bayes factors of each pair, or of one sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BayesTAnalysis {
    /// Complete subjects, or values.
    pub n: usize,
    /// Subjects left out because a cell is missing.
    pub dropped: Vec<String>,
    /// Values left out because they are missing.
    pub missing: usize,
    /// Each pair, A minus B; or `value` alone, less the value it is compared with.
    pub bayes_t: Named<BayesT>,
    /// The prior of each of them.
    pub prior: Prior,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Bayes factor of the paired t test of each pair of conditions.
///
/// # Source
/// Rouder, Speckman, Sun, Morey and Iverson (2009), equation 1, with the prior scale √2/2 of BayesFactor and JASP.
///
/// # Example
/// Student's sleep data:
/// ```
/// use maveric_stats::{WithinSubjects, bayes_paired};
/// let one = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0];
/// let two = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4];
/// let rows: Vec<Vec<f64>> = one.iter().zip(&two).map(|(a, b)| vec![*a, *b]).collect();
/// let names: Vec<String> = (0..10).map(|i| i.to_string()).collect();
/// let data = WithinSubjects::from_rows(&["one".to_owned(), "two".to_owned()], &names, &rows)?;
/// let bf10 = bayes_paired(&data).bayes_t.get("one|two").unwrap().bf10.unwrap();
/// assert!((bf10 - 17.258_880_268).abs() < 1e-8);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn bayes_paired(data: &WithinSubjects) -> BayesTAnalysis {
    let mut undefined = Reasons::default();
    let bayes_t = by_pair(data, "bayes_t", &mut undefined, |i, j| {
        let (differences, constant) = data.differences(i, j);
        of_sample(&differences, constant)
    });
    BayesTAnalysis {
        n: data.n(),
        dropped: data.dropped().to_vec(),
        missing: 0,
        bayes_t,
        prior: prior(),
        undefined,
    }
}

/// Bayes factor of the t test of one sample against `mu`, under `value`; missing values are left out.
///
/// # Errors
/// [`StatsError::NotFinite`]; [`StatsError::BadParameter`] if `mu` is not finite; [`StatsError::TooFew`] below two values.
pub fn bayes_one(values: &[Option<f64>], mu: f64) -> Result<BayesTAnalysis, StatsError> {
    let (differences, constant) = less(values, mu)?;
    let mut undefined = Reasons::default();
    let test = undefined.result("bayes_t.value", of_sample(&differences, constant));
    Ok(BayesTAnalysis {
        n: differences.len(),
        dropped: Vec::new(),
        missing: values.len() - differences.len(),
        bayes_t: [("value".to_owned(), test)].into_iter().collect(),
        prior: prior(),
        undefined,
    })
}

/// Bayes factor of Student's t test of each pair of the groups named beside the values, both of shape `(rows,)`.
///
/// # Errors
/// As [`groups`](crate::groups()).
pub fn bayes_groups(
    groups: &[String],
    values: &[Option<f64>],
) -> Result<BayesTAnalysis, StatsError> {
    let samples = Samples::new(groups, values)?;
    let mut undefined = Reasons::default();
    let bayes_t = samples.pairs("bayes_t", &mut undefined, |a, b| {
        let (student, mut reasons) = student(a, b);
        let n = a.n() * b.n() / (a.n() + b.n());
        let why = reasons.get("t").unwrap_or_default().to_owned();
        reasons = Reasons::default();
        let values = vec![a.n() as usize, b.n() as usize];
        let test = of_t((n, values), student.t.zip(student.df), &why, &mut reasons);
        (test, reasons)
    });
    Ok(BayesTAnalysis {
        n: samples.n(),
        dropped: Vec::new(),
        missing: samples.missing,
        bayes_t,
        prior: prior(),
        undefined,
    })
}

/// That of BayesFactor and JASP.
fn prior() -> Prior {
    Prior::new("Cauchy", std::f64::consts::FRAC_1_SQRT_2, "standardised effect")
}

fn of_sample(differences: &[f64], constant: bool) -> (BayesT, Reasons) {
    let mut reasons = Reasons::default();
    let n = differences.len() as f64;
    let (mean, squares) = mean_and_square_sum(differences.iter().copied());
    let varies = !constant && squares > 0.0;
    let t = varies.then(|| mean / (squares / (n - 1.0) / n).sqrt());
    let test = of_t(
        (n, vec![differences.len()]),
        t.map(|t| (t, n - 1.0)),
        "the differences do not vary",
        &mut reasons,
    );
    (test, reasons)
}

fn of_t(
    (n, values): (f64, Vec<usize>),
    t: Option<(f64, f64)>,
    why: &str,
    reasons: &mut Reasons,
) -> BayesT {
    if t.is_none() {
        reasons.note_all(&["t", "log_bf10", "bf10", "bf01"], why);
    }
    let ln = t.map(|(t, df)| log_bf10(t, n, df));
    let (bf10, bf01) = (ln.and_then(power), ln.and_then(|ln| power(-ln)));
    if ln.is_some() && (bf10.is_none() || bf01.is_none()) {
        reasons.note_all(&["bf10", "bf01"], TOO_LARGE);
    }
    BayesT { n, values, t: t.map(|(t, _)| t), log_bf10: ln, bf10, bf01 }
}

/// ln of the JZS Bayes factor.
///
/// The prior is a normal one whose variance r² g has g from an inverse gamma (½, ½); the integral over x = ln g is taken by the
/// trapezoidal rule, whose error is about exp(-π²/step) here, on logarithms: t may be 1e7.
fn log_bf10(t: f64, n: f64, df: f64) -> f64 {
    const STEP: f64 = 0.25;
    let square = t * t;
    let scaled = 0.5 * n;
    let without = -0.5 * (df + 1.0) * libm::log1p(square / df);
    let ln_term = |x: f64| {
        let spread = 1.0 + scaled * libm::exp(x);
        let with =
            -0.5 * libm::log(spread) - 0.5 * (df + 1.0) * libm::log1p(square / (spread * df));
        // The density of ln g.
        with - 0.5 * (libm::log(std::f64::consts::TAU) + x + libm::exp(-x))
    };
    // Above x = 2 ln t the terms fall as exp(-x).
    let last = (45.0 + 2.0 * libm::log(1.0 + t.abs())) / STEP;
    let first = -8.0 / STEP;
    let terms: Vec<f64> =
        (first as i32..=last as i32).map(|i| ln_term(STEP * f64::from(i))).collect();
    let top = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = terms.iter().map(|ln| libm::exp(ln - top)).sum();
    top + libm::log(STEP * sum) - without
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_t_of_zero_speaks_for_no_effect_and_more_so_with_more_people() {
        let (few, many) = (log_bf10(0.0, 10.0, 9.0), log_bf10(0.0, 1000.0, 999.0));
        assert!(few < 0.0 && many < few);
        // By Simpson's rule with 4,000 steps.
        assert!((few.exp() - 0.308_793_556_708_283).abs() < 1e-12);
    }

    #[test]
    fn a_factor_beyond_double_precision_keeps_its_logarithm() {
        let mut reasons = Reasons::default();
        let found = of_t((500.0, vec![500]), Some((1e6, 499.0)), "", &mut reasons);
        assert!(found.log_bf10.unwrap() > 710.0 && found.bf10.is_none());
        assert!(reasons.get("bf10").is_some());
    }
}
