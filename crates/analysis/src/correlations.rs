//! The tests of `maveric_stats` as the analyses ask for them: too few data give no number, not a failure.

use crate::{AnalysisError, result::Correlation};
use maveric_stats::{CorrelationMethod, Interval, StatsError, circular_linear, rm_correlation};

fn none(method: &str, n: usize) -> Correlation {
    Correlation {
        method: method.to_owned(),
        n,
        df: n.saturating_sub(2),
        r: None,
        p: None,
        ci: Interval::default(),
    }
}

fn complete(x: &[Option<f64>], y: &[Option<f64>]) -> usize {
    x.iter().zip(y).filter(|(x, y)| x.is_some() && y.is_some()).count()
}

/// Pearson's or Spearman's correlation of two columns, pairs with a missing member left out.
pub(crate) fn correlate(
    x: &[Option<f64>],
    y: &[Option<f64>],
    method: CorrelationMethod,
) -> Result<Correlation, AnalysisError> {
    let correlation = match maveric_stats::correlate(x, y, method, None) {
        Ok(correlation) => correlation,
        Err(StatsError::TooFew { .. }) => return Ok(none("pearson", complete(x, y))),
        Err(error) => return Err(error.into()),
    };
    let spearman = correlation
        .chosen
        .map_or(method == CorrelationMethod::Spearman, |c| c == CorrelationMethod::Spearman);
    let name = if spearman { "spearman" } else { "pearson" };
    let mut result = none(name, correlation.n);
    if spearman {
        if let Some(s) = correlation.spearman {
            (result.r, result.p, result.ci) = (s.rho, s.p, s.ci_bw);
        }
    } else if let Some(p) = correlation.pearson {
        (result.r, result.p, result.ci) = (p.r, p.p, p.ci);
    }
    Ok(result)
}

/// Correlation within people, for several pairs a person.
pub(crate) fn correlate_within(
    subjects: &[String],
    x: &[Option<f64>],
    y: &[Option<f64>],
) -> Result<Correlation, AnalysisError> {
    match rm_correlation(subjects, x, y) {
        Ok(within) => {
            let r = within.rm_corr;
            Ok(Correlation {
                df: r.df.unwrap_or(0),
                r: r.r,
                p: r.p,
                ci: r.ci,
                ..none("rm_corr", within.n)
            })
        }
        Err(StatsError::TooFew { .. }) => Ok(none("rm_corr", complete(x, y))),
        Err(error) => Err(error.into()),
    }
}

/// Multiple R of a change on cosine and sine of an angle, and its p.
pub(crate) fn circular(
    angle: &[Option<f64>],
    change: &[Option<f64>],
) -> Result<(Option<f64>, Option<f64>), AnalysisError> {
    match circular_linear(angle, change) {
        Ok(association) => Ok((association.r, association.p)),
        Err(StatsError::TooFew { .. }) => Ok((None, None)),
        Err(error) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_few_pairs_have_a_count_and_no_number() {
        let x = [Some(1.0), Some(2.0), None, Some(4.0)];
        let y = [Some(3.0), None, Some(2.0), None];
        let found = correlate(&x, &y, CorrelationMethod::Spearman).unwrap();
        assert_eq!((found.n, found.df, found.r), (1, 0, None));
        let people = ["a", "a", "b", "b"].map(str::to_owned);
        let within = correlate_within(&people, &x, &y).unwrap();
        assert_eq!((within.method.as_str(), within.n, within.r), ("rm_corr", 1, None));
        assert_eq!(circular(&x, &y).unwrap(), (None, None));
        assert_eq!(correlate(&[None], &[None], CorrelationMethod::Pearson).unwrap().n, 0);
    }

    #[test]
    fn each_method_gives_its_own_coefficient_and_interval() {
        // Rising, but not in a line.
        let x: Vec<Option<f64>> = (1..=8).map(|i| Some(f64::from(i))).collect();
        let y: Vec<Option<f64>> = (1..=8).map(|i| Some(f64::from(i * i * i))).collect();
        let ranks = correlate(&x, &y, CorrelationMethod::Spearman).unwrap();
        let line = correlate(&x, &y, CorrelationMethod::Pearson).unwrap();
        assert_eq!((ranks.method.as_str(), line.method.as_str()), ("spearman", "pearson"));
        assert!((ranks.r.unwrap() - 1.0).abs() < 1e-12);
        assert!(line.r.unwrap() < 0.95 && line.df == 6);
        assert!(line.ci.low.unwrap() < line.r.unwrap() && line.r.unwrap() < line.ci.high.unwrap());
    }
}
