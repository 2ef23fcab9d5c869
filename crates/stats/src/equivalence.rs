//! Whether a difference is small: two one-sided tests.

use serde::{Deserialize, Serialize};

use crate::{
    Adjustment, Interval, Named, Reasons, StatsError, WithinSubjects,
    analysis::by_pair,
    complete,
    numerics::{
        distributions::{self, t_quantile_two_sided, t_two_sided},
        moments::{is_constant, mean_and_square_sum},
    },
};

/// The level of each one-sided test.
const LEVEL: f64 = 0.05;

/// Name of the only test of one sample; those of pairs have `|` in them.
const ONE_SAMPLE: &str = "value";

/// Which differences count as none: those between `low` and `high`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bounds {
    /// In the unit of the values.
    Raw {
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
    /// In standard deviations of the differences. Those are estimated, so the level holds approximately only.
    Standardized {
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
}

/// Two one-sided t tests of one difference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tost {
    /// Differences.
    pub n: usize,
    /// Their mean.
    pub estimate: f64,
    /// Its standard error.
    pub se: Option<f64>,
    /// n - 1.
    pub df: usize,
    /// Lower bound, in the unit of the values.
    pub low: Option<f64>,
    /// Upper bound, in the unit of the values.
    pub high: Option<f64>,
    /// (estimate - low) / se.
    pub t_lower: Option<f64>,
    /// One-sided p against an estimate at or below `low`.
    pub p_lower: Option<f64>,
    /// (estimate - high) / se.
    pub t_upper: Option<f64>,
    /// One-sided p against an estimate at or above `high`.
    pub p_upper: Option<f64>,
    /// The larger of the two.
    pub p: Option<f64>,
    /// Holm's correction of `p` over all pairs.
    pub p_holm: Option<f64>,
    /// The 90 % interval of the estimate, which lies within the bounds where p < .05.
    #[serde(flatten, with = "crate::interval::ci90")]
    pub ci90: Interval,
    /// The 95 % interval of the estimate.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
    /// estimate / se: against no difference.
    pub t: Option<f64>,
    /// Two-sided p against no difference.
    pub p_difference: Option<f64>,
    /// Estimate over the standard deviation of the differences.
    pub dz: Option<f64>,
    /// Whether p < .05, for this pair alone.
    pub equivalent: Option<bool>,
    /// Whether `p_holm` < .05: of several pairs this decides.
    pub equivalent_holm: Option<bool>,
    /// Whether `p_difference` < .05; both may hold, and neither.
    pub different: Option<bool>,
}

impl Tost {
    /// Writes the corrected p and its verdict.
    fn correct(&mut self, p_holm: Option<f64>) {
        self.p_holm = p_holm;
        self.equivalent_holm = p_holm.map(|p| p < LEVEL);
    }
}

/// Tests of equivalence of each pair of conditions, or of one sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Equivalence {
    /// Complete subjects, or values.
    pub n: usize,
    /// Subjects left out because a cell is missing.
    pub dropped: Vec<String>,
    /// Values left out because they are missing.
    pub missing: usize,
    /// What counts as no difference, as given.
    pub bounds: Bounds,
    /// Each pair of conditions, A minus B; or `value` alone, less the value it is compared with.
    pub tost: Named<Tost>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

impl Equivalence {
    /// Whether `n` counts values of one sample, not subjects.
    pub fn is_of_one_sample(&self) -> bool {
        self.tost.get(ONE_SAMPLE).is_some()
    }

    /// What `p_holm` is adjusted by: nothing where there is one test.
    pub fn adjusted(&self) -> Adjustment {
        if self.tost.len() > 1 { Adjustment::Holm } else { Adjustment::None }
    }
}

/// Whether conditions differ by less than the bounds, for each pair of them.
///
/// # Errors
/// [`StatsError::BadParameter`] unless both bounds are finite and low < high.
///
/// # Source
/// Schuirmann (1987); Lakens (2017) for standardised bounds.
///
/// # Example
/// ```
/// use maveric_stats::{Bounds, WithinSubjects, equivalence};
/// let rows = [[1.0, 1.1], [2.0, 1.9], [3.0, 3.2], [4.0, 4.0], [2.5, 2.4]].map(Vec::from);
/// let data = WithinSubjects::from_rows(&["a", "b"], &["p", "q", "r", "s", "t"], &rows)?;
/// let found = equivalence(&data, Bounds::Raw { low: -0.5, high: 0.5 })?;
/// assert_eq!(found.tost.get("a|b").unwrap().equivalent_holm, Some(true));
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn equivalence(data: &WithinSubjects, bounds: Bounds) -> Result<Equivalence, StatsError> {
    check(bounds)?;
    let mut undefined = Reasons::default();
    let tests = by_pair(data, "tost", &mut undefined, |i, j| {
        let (differences, constant) = data.differences(i, j);
        tost(&differences, constant, bounds)
    });
    Ok(Equivalence {
        n: data.n(),
        dropped: data.dropped().to_vec(),
        missing: 0,
        bounds,
        tost: tests.with_holm(|t| t.p, Tost::correct),
        undefined,
    })
}

/// Whether the mean of a sample differs from `mu` by less than the bounds; missing values are left out.
///
/// The result stands under `value`. Differences of pairs that are at hand may be given as they are, with `mu` 0.
///
/// # Errors
/// [`StatsError::BadParameter`] unless both bounds are finite and low < high and `mu` is finite; [`StatsError::NotFinite`];
/// [`StatsError::TooFew`] below two values.
pub fn equivalence_one(
    values: &[Option<f64>],
    mu: f64,
    bounds: Bounds,
) -> Result<Equivalence, StatsError> {
    check(bounds)?;
    let (differences, constant) = less(values, mu)?;
    let mut undefined = Reasons::default();
    let name = format!("tost.{ONE_SAMPLE}");
    let mut test = undefined.result(&name, tost(&differences, constant, bounds));
    test.correct(test.p);
    Ok(Equivalence {
        n: test.n,
        dropped: Vec::new(),
        missing: values.len() - test.n,
        bounds,
        tost: [(ONE_SAMPLE.to_owned(), test)].into_iter().collect(),
        undefined,
    })
}

/// Two one-sided t tests of an estimate of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimateTost {
    /// One-sided p against an estimate at or below the lower bound.
    pub p_lower: f64,
    /// One-sided p against one at or above the upper bound.
    pub p_upper: f64,
    /// Ends of the 90 % interval, which lies within the bounds where both are below .05.
    pub ci90: Option<(f64, f64)>,
}

/// Tests an estimate with its standard error and degrees of freedom against both bounds.
///
/// # Source
/// Schuirmann (1987).
///
/// # Example
/// ```
/// let test = maveric_stats::tost_of_estimate((0.1, 0.2), 18.0, (-0.5, 0.5));
/// let (low, high) = test.ci90.unwrap();
/// assert!(test.p_lower < 0.05 && test.p_upper < 0.05 && low > -0.5 && high < 0.5);
/// ```
pub fn tost_of_estimate(
    (estimate, se): (f64, f64),
    df: f64,
    (low, high): (f64, f64),
) -> EstimateTost {
    let half = t_quantile_two_sided(2.0 * LEVEL, df).map(|t| se * t);
    EstimateTost {
        p_lower: distributions::t_upper((estimate - low) / se, df),
        p_upper: distributions::t_upper((high - estimate) / se, df),
        ci90: half.map(|half| (estimate - half, estimate + half)),
    }
}

/// The values that are there, less `mu`, and whether they are all equal.
pub(crate) fn less(values: &[Option<f64>], mu: f64) -> Result<(Vec<f64>, bool), StatsError> {
    finite("mu", mu)?;
    let values = complete::values(values, "value", 2)?;
    let constant = is_constant(&values);
    Ok((values.into_iter().map(|v| v - mu).collect(), constant))
}

fn finite(name: &str, found: f64) -> Result<(), StatsError> {
    let fine = found.is_finite();
    fine.then_some(()).ok_or_else(|| StatsError::parameter(name, "a finite number", found))
}

fn check(bounds: Bounds) -> Result<(), StatsError> {
    let (Bounds::Raw { low, high } | Bounds::Standardized { low, high }) = bounds;
    finite("lower bound", low)?;
    finite("upper bound", high)?;
    (low < high).then_some(()).ok_or_else(|| {
        StatsError::parameter("upper bound", &format!("above the lower one, {low}"), high)
    })
}

fn tost(differences: &[f64], constant: bool, bounds: Bounds) -> (Tost, Reasons) {
    let mut reasons = Reasons::default();
    let n = differences.len() as f64;
    let df = n - 1.0;
    let (estimate, squares) = mean_and_square_sum(differences.iter().copied());
    let sd = (!constant && squares > 0.0).then(|| (squares / df).sqrt());
    let se = sd.map(|sd| sd / n.sqrt());
    let (low, high) = match bounds {
        Bounds::Raw { low, high } => (Some(low), Some(high)),
        Bounds::Standardized { low, high } => (sd.map(|sd| low * sd), sd.map(|sd| high * sd)),
    };
    if sd.is_none() {
        let reason = "the differences do not vary";
        let tests = ["t_lower", "p_lower", "t_upper", "p_upper", "p", "p_holm"];
        reasons.note_all(&tests, reason);
        reasons.note_all(&["se", "t", "dz"], reason);
        reasons.note_all(&["p_difference", "different"], reason);
        reasons.note_all(&["equivalent", "equivalent_holm"], reason);
        reasons.note_ends(&["ci90", "ci"], reason);
        // Raw bounds exist whatever the data.
        if low.is_none() {
            reasons.note_all(&["low", "high"], reason);
        }
    }
    let over = |bound: Option<f64>| Some((estimate - bound?) / se?);
    let (t_lower, t_upper) = (over(low), over(high));
    let p_lower = t_lower.map(|t| distributions::t_upper(t, df));
    let p_upper = t_upper.map(|t| distributions::t_upper(-t, df));
    let p = p_lower.zip(p_upper).map(|(a, b)| a.max(b));
    let half_of = |level| se.and_then(|se| Some(se * t_quantile_two_sided(level, df)?));
    let (half, ordinary) = (half_of(2.0 * LEVEL), half_of(LEVEL));
    if half.is_none() {
        let reason = "t has no quantile at these degrees of freedom";
        reasons.note_ends(&["ci90", "ci"], reason);
    }
    let t = se.map(|se| estimate / se);
    let p_difference = t.map(|t| t_two_sided(t, df));
    let test = Tost {
        n: differences.len(),
        estimate,
        se,
        df: differences.len() - 1,
        low,
        high,
        t_lower,
        p_lower,
        t_upper,
        p_upper,
        p,
        p_holm: None,
        ci90: Interval::around(estimate, half),
        ci: Interval::around(estimate, ordinary),
        t,
        p_difference,
        dz: sd.map(|sd| estimate / sd),
        equivalent: p.map(|p| p < LEVEL),
        equivalent_holm: None,
        different: p_difference.map(|p| p < LEVEL),
    };
    (test, reasons)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_lies_within_the_bounds_where_the_test_says_so() {
        let values = [0.3, -0.2, 0.1, 0.4, -0.1, 0.2].map(Some);
        for high in [0.2, 0.3, 0.35, 0.5] {
            let bounds = Bounds::Raw { low: -high, high };
            let found = equivalence_one(&values, 0.0, bounds).unwrap();
            let test = found.tost.get("value").unwrap();
            let inside = test.ci90.low.unwrap() > -high && test.ci90.high.unwrap() < high;
            assert_eq!(test.equivalent, Some(inside));
        }
    }

    #[test]
    fn of_several_pairs_holms_correction_decides() {
        let rows = [
            [0.0, 0.3, 0.1],
            [1.0, 0.7, 1.4],
            [2.0, 2.5, 1.6],
            [3.0, 2.9, 3.5],
            [4.0, 4.3, 3.8],
            [5.0, 4.8, 5.1],
        ];
        let names = ["p", "q", "r", "s", "t", "u"];
        let shown = |conditions: usize, high: f64| {
            let rows = rows.map(|row| row[..conditions].to_vec());
            let data = WithinSubjects::from_rows(&["a", "b", "c"][..conditions], &names, &rows);
            let found = equivalence(&data.unwrap(), Bounds::Raw { low: -high, high }).unwrap();
            let test = found.tost.get("a|b").unwrap();
            let sentence = found.to_string();
            let named = sentence.lines().next().unwrap().contains("p_Holm");
            (test.equivalent.unwrap(), test.equivalent_holm.unwrap(), named)
        };
        assert_eq!(shown(2, 0.4), (true, true, false));
        assert_eq!(shown(3, 0.4), (true, false, true));
        assert_eq!(shown(3, 1.0), (true, true, true));
    }

    #[test]
    fn differences_that_do_not_vary_have_a_reason_for_each_missing_number() {
        let data = WithinSubjects::from_rows(
            &["a", "b"],
            &["p", "q", "r"],
            &[vec![1.1, 1.0], vec![2.1, 2.0], vec![3.1, 3.0]],
        );
        let bounds = Bounds::Raw { low: -1.0, high: 1.0 };
        let found = equivalence(&data.unwrap(), bounds).unwrap();
        let test = found.tost.get("a|b").unwrap();
        assert!(test.p.is_none() && test.low == Some(-1.0));
        for verdict in ["equivalent", "equivalent_holm"] {
            let name = format!("tost.a|b.{verdict}");
            assert!(found.undefined.get(&name).is_some(), "{name}");
        }
        assert!(found.undefined.get("tost.a|b.low").is_none());
    }

    #[test]
    fn bounds_in_the_wrong_order_are_refused() {
        let bounds = Bounds::Raw { low: 1.0, high: 0.0 };
        let error = equivalence_one(&[Some(1.0), Some(2.0)], 0.0, bounds).unwrap_err();
        assert!(error.to_string().contains("above the lower one, 1"));
    }
}
