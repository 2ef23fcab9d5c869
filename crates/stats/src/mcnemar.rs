//! McNemar's test: do two yes/no answers of the same people differ?

use serde::{Deserialize, Serialize};

use crate::{
    Interval, Named, Reasons, StatsError, WithinSubjects,
    numerics::distributions::{chi2_upper, f_upper},
    power::z_for,
    proportion::clopper_pearson,
};

/// Confidence of the intervals.
const CONFIDENCE: f64 = 0.95;

/// Two conditions, each answered with yes or no by the same people.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct McNemar {
    /// Complete subjects.
    pub n: usize,
    /// Subjects left out because a cell is missing.
    pub dropped: Vec<String>,
    /// Share of yes by condition.
    pub yes: Named<f64>,
    /// The test.
    pub mcnemar: McNemarTest,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// McNemar's test of two conditions A and B.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct McNemarTest {
    /// Yes in A and B.
    pub both: usize,
    /// Yes in A alone.
    pub only_a: usize,
    /// Yes in B alone.
    pub only_b: usize,
    /// Yes in neither.
    pub neither: usize,
    /// Share of yes in A minus that in B.
    pub difference: f64,
    /// Its 95 % interval: Bonett and Price (2012), Wald's with half a person added to each cell that differs.
    #[serde(flatten, with = "crate::interval::difference_ci")]
    pub difference_ci: Interval,
    /// (only A) / (only B), the odds ratio of the pairs.
    pub odds_ratio: Option<f64>,
    /// Its 95 % interval: Clopper and Pearson's of (only A) / (only A + only B), as odds.
    #[serde(flatten, with = "crate::interval::odds_ratio_ci")]
    pub odds_ratio_ci: Interval,
    /// Two-sided binomial p of those who differ: never too small, and too large with few.
    pub p_exact: Option<f64>,
    /// The same less half the probability of what was seen: Fagerland, Lydersen and Laake (2013) advise it.
    pub p_mid: Option<f64>,
    /// (only A − only B)² / (only A + only B), without continuity correction.
    pub chi2: Option<f64>,
    /// P(χ²(1) ≥ χ²), for large samples.
    pub p: Option<f64>,
}

/// McNemar's test of two conditions whose values are 1 for yes and 0 for no.
///
/// # Errors
/// [`StatsError::BadParameter`] for another number of conditions, or a value that is neither.
///
/// # Source
/// McNemar (1947); Fagerland, Lydersen and Laake (2013), whose example this is: airways of 21 children before and after
/// a transplant.
///
/// # Example
/// ```
/// # use maveric_stats::{WithinSubjects, mcnemar};
/// let mut airways = vec![[1.0, 1.0]];
/// airways.push([1.0, 0.0]);
/// airways.extend([[0.0, 1.0]; 7]);
/// airways.extend([[0.0, 0.0]; 12]);
/// let children: Vec<String> = (1..=21).map(|i| i.to_string()).collect();
/// let airways = airways.into_iter().map(Vec::from).collect::<Vec<_>>();
/// let times = ["before", "after"].map(str::to_owned);
/// let found = mcnemar(&WithinSubjects::from_rows(&times, &children, &airways)?)?.mcnemar;
/// assert!((found.p_exact.unwrap() - 0.0703).abs() < 5e-5);
/// assert!((found.p_mid.unwrap() - 0.0391).abs() < 5e-5);
/// assert!((found.p.unwrap() - 0.0339).abs() < 5e-5);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn mcnemar(data: &WithinSubjects) -> Result<McNemar, StatsError> {
    check_yes_no(data)?;
    if data.k() != 2 {
        let (expected, found) = ("2: cochran-q compares more", data.k() as f64);
        return Err(StatsError::parameter("conditions", expected, found));
    }
    let mut undefined = Reasons::default();
    let mcnemar = undefined.result("mcnemar", test(&data.column(0), &data.column(1)));
    Ok(McNemar {
        n: data.n(),
        dropped: data.dropped().to_vec(),
        yes: shares(data),
        mcnemar,
        undefined,
    })
}

/// Refuses values other than 0 and 1.
pub(crate) fn check_yes_no(data: &WithinSubjects) -> Result<(), StatsError> {
    let other = data.values().iter().find(|v| ![0.0, 1.0].contains(*v));
    other.map_or(Ok(()), |value| Err(StatsError::parameter("value", "0 or 1", *value)))
}

/// Share of yes by condition.
pub(crate) fn shares(data: &WithinSubjects) -> Named<f64> {
    let share = |j: usize| data.column(j).iter().sum::<f64>() / data.n() as f64;
    Named::by_name(data.conditions(), share)
}

/// The test of two columns of 0 and 1.
pub(crate) fn test(a: &[f64], b: &[f64]) -> (McNemarTest, Reasons) {
    let answers = || a.iter().zip(b).map(|(a, b)| (*a > 0.5, *b > 0.5));
    let count = |a: bool, b: bool| answers().filter(|pair| *pair == (a, b)).count();
    let (both, only_a) = (count(true, true), count(true, false));
    let (only_b, neither) = (count(false, true), count(false, false));
    let (x, y, n) = (only_a as f64, only_b as f64, a.len() as f64);
    let (p_a, p_b) = ((x + 1.0) / (n + 2.0), (y + 1.0) / (n + 2.0));
    let spread = (p_a + p_b - (p_a - p_b).powi(2)) / (n + 2.0);
    let half = z_for(CONFIDENCE) * spread.sqrt();
    let mut undefined = Reasons::default();
    let differing = x + y;
    let (mut p_exact, mut p_mid, mut chi2) = (None, None, None);
    if differing > 0.0 {
        let less = x.min(y);
        let tail = at_most(less, differing);
        let seen = tail - at_most(less - 1.0, differing);
        p_exact = Some((2.0 * tail).min(1.0));
        // As many either way is one outcome, any other has its mirror.
        p_mid = Some(if only_a == only_b { 1.0 - seen / 2.0 } else { 2.0 * tail - seen });
        chi2 = Some((x - y).powi(2) / differing);
    } else {
        let names = ["p_exact", "p_mid", "chi2", "p", "odds_ratio"];
        undefined.note_all(&names, "nobody answered the two conditions differently");
    }
    if differing > 0.0 && only_b == 0 {
        let reason = "nobody said yes in the second condition alone";
        undefined.note("odds_ratio", reason);
    }
    let odds = |share: f64| share / (1.0 - share);
    let ends = clopper_pearson(x, differing, CONFIDENCE);
    let test = McNemarTest {
        both,
        only_a,
        only_b,
        neither,
        difference: (x - y) / n,
        difference_ci: ((p_a - p_b - half).max(-1.0), (p_a - p_b + half).min(1.0)).into(),
        odds_ratio: (only_b > 0).then(|| x / y),
        odds_ratio_ci: Interval {
            low: ends.map(|(low, _)| odds(low)),
            high: ends.filter(|_| only_b > 0).map(|(_, high)| odds(high)),
        },
        p_exact,
        p_mid,
        chi2,
        p: chi2.map(|chi2| chi2_upper(chi2, 1.0)),
    };
    (test, undefined)
}

/// P(X ≤ x) of n fair coins, by the F distribution.
fn at_most(x: f64, n: f64) -> f64 {
    if x < 0.0 {
        return 0.0;
    }
    if x >= n {
        return 1.0;
    }
    // I_{1/2}(n − x, x + 1) = P(F(2(x + 1), 2(n − x)) ≥ (n − x) / (x + 1)).
    f_upper((n - x) / (x + 1.0), 2.0 * (x + 1.0), 2.0 * (n - x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::apa::Statements;

    /// A table of these counts: both, only the first, only the second, neither.
    fn table(counts: [usize; 4]) -> WithinSubjects {
        let cells = [[1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
        let rows = counts.iter().zip(cells);
        let rows: Vec<Vec<f64>> =
            rows.flat_map(|(count, cell)| std::iter::repeat_n(cell.to_vec(), *count)).collect();
        let people: Vec<String> = (0..rows.len()).map(|i| i.to_string()).collect();
        WithinSubjects::from_rows(&["a".to_owned(), "b".to_owned()], &people, &rows).unwrap()
    }

    fn near(found: Option<f64>, expected: f64) {
        let found = found.unwrap();
        assert!((found - expected).abs() < 1e-9, "{found}, expected {expected}");
    }

    #[test]
    fn eight_against_one_by_hand() {
        let found = mcnemar(&table([4, 8, 1, 7])).unwrap();
        let test = &found.mcnemar;
        // 2 (1 + 9) / 512, less 9 / 512; 49 / 9.
        near(test.p_exact, 20.0 / 512.0);
        near(test.p_mid, 11.0 / 512.0);
        near(test.chi2, 49.0 / 9.0);
        near(test.odds_ratio, 8.0);
        // Clopper and Pearson of 8 of 9: .5175 to .9972.
        assert!((test.odds_ratio_ci.low.unwrap() - 0.517_504 / 0.482_496).abs() < 1e-4);
        assert!((test.odds_ratio_ci.high.unwrap() - 0.997_191 / 0.002_809).abs() < 0.5);
        // (9 − 2) / 22 ± 1.96 √((11/22 − (7/22)²) / 22).
        assert!((test.difference - 7.0 / 20.0).abs() < 1e-12);
        assert!((test.difference_ci.low.unwrap() - 0.054_308).abs() < 1e-5, "{test:?}");
        assert!((test.difference_ci.high.unwrap() - 0.582_056).abs() < 1e-5, "{test:?}");
        assert_eq!(found.yes.get("a"), Some(&0.6));
        let turned = mcnemar(&table([4, 1, 8, 7])).unwrap().mcnemar;
        assert_eq!((turned.p_exact, turned.p_mid), (test.p_exact, test.p_mid));
        assert!((turned.difference + test.difference).abs() < 1e-12);
        assert!(
            (turned.odds_ratio_ci.low.unwrap() * test.odds_ratio_ci.high.unwrap() - 1.0).abs()
                < 1e-9
        );
    }

    #[test]
    fn the_mid_p_is_named_and_of_few_who_differ_the_exact_one_stands_beside() {
        let said = |counts: [usize; 4]| {
            let statements = mcnemar(&table(counts)).unwrap().statements();
            statements[0].1.to_string()
        };
        let few = said([4, 8, 1, 7]);
        assert!(few.starts_with("8 against 1, mid-p = .021, exact p = .039, difference"), "{few}");
        assert!(said([0, 20, 4, 0]).contains("exact"));
        let many = said([0, 20, 5, 0]);
        assert!(many.contains("mid-p") && !many.contains("exact"), "{many}");
    }

    #[test]
    fn as_many_either_way_is_no_difference_and_nobody_differing_no_test() {
        let even = mcnemar(&table([1, 3, 3, 1])).unwrap().mcnemar;
        near(even.p_exact, 1.0);
        // 1 − P(X = 3 of 6) / 2 = 1 − 10/64.
        near(even.p_mid, 54.0 / 64.0);
        let none = mcnemar(&table([5, 0, 0, 5])).unwrap();
        assert_eq!((none.mcnemar.p_exact, none.mcnemar.p), (None, None));
        assert!(none.undefined.get("mcnemar.p_exact").is_some());
        assert!(none.statements().is_empty());
        let alone = mcnemar(&table([0, 6, 0, 0])).unwrap().mcnemar;
        assert_eq!((alone.odds_ratio, alone.odds_ratio_ci.high), (None, None));
        near(alone.p_exact, 2.0 / 64.0);
    }

    #[test]
    fn other_values_and_other_numbers_of_conditions_are_refused() {
        let rows = [vec![1.0, 2.0], vec![0.0, 1.0]];
        let people = ["p".to_owned(), "q".to_owned()];
        let two = ["a".to_owned(), "b".to_owned()];
        let scores = WithinSubjects::from_rows(&two, &people, &rows).unwrap();
        assert!(mcnemar(&scores).unwrap_err().to_string().contains("0 or 1"));
        let three = ["a", "b", "c"].map(str::to_owned);
        let rows = [vec![1.0, 0.0, 1.0], vec![0.0, 1.0, 1.0]];
        let data = WithinSubjects::from_rows(&three, &people, &rows).unwrap();
        assert!(mcnemar(&data).is_err());
    }
}
