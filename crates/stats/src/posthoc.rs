//! All pairs of conditions, after an omnibus test or instead of one.

use serde::{Deserialize, Serialize};

use crate::{
    Adjustment, Interval, Named, Nemenyi, PMethod, PairedT, Reasons, StatsError, Wilcoxon,
    WithinSubjects, analysis, friedman::RankTable, numerics::moments::mean_and_square_sum,
    rm_anova,
};

/// The test of a pair of conditions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum PosthocTest {
    /// Paired t test, each pair with its own error.
    T,
    /// t test over the pooled error term of the analysis of variance.
    PooledT,
    /// Wilcoxon's signed-rank test.
    Wilcoxon,
    /// Conover's comparison of rank sums.
    Conover,
    /// Nemenyi's comparison of mean ranks; its p is corrected for all pairs by itself.
    Nemenyi,
}

/// The name of an effect size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EffectName {
    /// Mean difference over the standard deviation of the differences.
    Dz,
    /// (W+ - W-) / (W+ + W-) of the signed ranks.
    RankBiserial,
    /// SSc / (SSc + SSe).
    Eta2Partial,
    /// χ² / (n (k-1)).
    KendallW,
}

/// An effect size with its interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// Which effect size.
    pub name: EffectName,
    /// The estimate.
    pub value: Option<f64>,
    /// The interval.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
    /// Confidence of the interval: 0.95 for pairs, 0.90 for partial eta squared and W.
    pub confidence: f64,
}

/// One pair of conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PosthocPair {
    /// Mean of A minus B.
    pub mean_diff: f64,
    /// t, W+ or q of the test.
    pub statistic: Option<f64>,
    /// Degrees of freedom of a t.
    pub df: Option<usize>,
    /// Differences that are not zero, of Wilcoxon's test; else all subjects.
    pub n_used: usize,
    /// Two-sided.
    pub p: Option<f64>,
    /// How p was computed.
    pub p_method: Option<PMethod>,
    /// p corrected for all pairs.
    pub p_adjusted: Option<f64>,
    /// Whether the corrected p is below alpha.
    pub reject: Option<bool>,
    /// Effect size of the pair.
    pub effect: Effect,
}

/// All pairs of a within-subject design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Posthoc {
    /// Complete subjects.
    pub n: usize,
    /// Conditions.
    pub k: usize,
    /// Subjects left out because a cell is missing.
    pub dropped: Vec<String>,
    /// Which test compared each pair.
    pub test: PosthocTest,
    /// The correction for all pairs.
    pub adjust: Adjustment,
    /// Level of significance of `reject`.
    pub alpha: f64,
    /// Results by pair `A|B`, A minus B.
    pub pairs: Named<PosthocPair>,
    /// What a reader should know.
    pub warnings: Vec<String>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Compares every pair of conditions.
///
/// # Errors
/// [`StatsError::BadParameter`] if `alpha` is not between 0 and 1.
///
/// # Source
/// Student (1908), Wilcoxon (1945), Conover (1999, section 5.8), Nemenyi as Demšar (2006);
/// corrections as [`Adjustment`]. Wilcoxon's p is exact with ties too, and differences tie
/// as written: R and SciPy rank the doubles.
///
/// # Example
/// Depression before and after a tranquilliser (Hollander and Wolfe, 1973, table 3.1; R's
/// help of `wilcox.test`): V = 40, two-sided p = .0391.
/// ```
/// use maveric_stats::{Adjustment, PosthocTest, WithinSubjects, posthoc};
/// let rows = [
///     [1.83, 0.878], [0.50, 0.647], [1.62, 0.598], [2.48, 2.05], [1.68, 1.06],
///     [1.88, 1.29], [1.55, 1.06], [3.06, 3.14], [1.30, 1.29],
/// ].map(Vec::from);
/// let patients = ["1", "2", "3", "4", "5", "6", "7", "8", "9"];
/// let data = WithinSubjects::from_rows(&["first", "second"], &patients, &rows)?;
/// let result = posthoc(&data, PosthocTest::Wilcoxon, Adjustment::Holm, 0.05)?;
/// let pair = result.pairs.get("first|second").unwrap();
/// assert_eq!((pair.statistic, pair.p), (Some(40.0), Some(0.0390625)));
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
///
/// Means, by t tests:
/// ```
/// use maveric_stats::{Adjustment, PosthocTest, WithinSubjects, posthoc};
/// let rows = [[1.0, 4.0, 2.0], [2.0, 6.0, 3.0], [3.0, 6.5, 3.5], [1.5, 5.0, 4.0]].map(Vec::from);
/// let data = WithinSubjects::from_rows(&["a", "b", "c"], &["1", "2", "3", "4"], &rows);
/// let result = posthoc(&data?, PosthocTest::T, Adjustment::Holm, 0.05)?;
/// let pair = result.pairs.get("a|b").unwrap();
/// assert!(pair.mean_diff < 0.0 && pair.p_adjusted > pair.p);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn posthoc(
    data: &WithinSubjects,
    test: PosthocTest,
    adjust: Adjustment,
    alpha: f64,
) -> Result<Posthoc, StatsError> {
    StatsError::between_0_and_1("alpha", alpha)?;
    Ok(all_pairs(data, test, adjust, alpha))
}

/// [`posthoc`] for a level that has been checked.
pub(crate) fn all_pairs(
    data: &WithinSubjects,
    test: PosthocTest,
    adjust: Adjustment,
    alpha: f64,
) -> Posthoc {
    let mut undefined = Reasons::default();
    let columns: Vec<Vec<f64>> = (0..data.k()).map(|j| data.column(j)).collect();
    let mut raw = single_tests(data, test, &columns, &mut undefined);
    let mut warnings = Vec::new();
    let nemenyi = test == PosthocTest::Nemenyi;
    if nemenyi && adjust != Adjustment::None {
        warnings.push(
            "Nemenyi's p is corrected for all pairs by itself; it is not corrected again"
                .to_owned(),
        );
    }
    let adjust = if nemenyi { Adjustment::None } else { adjust };
    let p: Vec<Option<f64>> = raw.values().map(|pair| pair.p).collect();
    for (pair, adjusted) in raw.values_mut().zip(adjust.apply_defined(&p)) {
        pair.p_adjusted = adjusted;
        pair.reject = adjusted.map(|p| p < alpha);
    }
    for (name, pair) in raw.iter() {
        let result = format!("pairs.{name}");
        if pair.p.is_none() {
            let reason = "the differences of the pair do not allow the test";
            undefined.note_below(&result, &PARTS_OF_TEST, reason);
        }
        if pair.df.is_none() {
            let reason = "the statistic has no degrees of freedom";
            undefined.note_below(&result, &["df"], reason);
        }
        for (part, value) in [
            ("effect.value", pair.effect.value),
            ("effect.ci_low", pair.effect.ci.low),
            ("effect.ci_high", pair.effect.ci.high),
        ] {
            if value.is_none() {
                let reason = "the differences do not vary, or the effect is at its limit";
                undefined.note_below(&result, &[part], reason);
            }
        }
    }
    Posthoc {
        n: data.n(),
        k: data.k(),
        dropped: data.dropped().to_vec(),
        test,
        adjust,
        alpha,
        pairs: raw,
        warnings,
        undefined,
    }
}

/// What a pair has only with a p.
const PARTS_OF_TEST: [&str; 5] = ["statistic", "p", "p_method", "p_adjusted", "reject"];

/// What the five tests have in common: statistic, df, n used, p and its method.
struct Single(Option<f64>, Option<usize>, usize, Option<f64>, PMethod);

fn single_tests(
    data: &WithinSubjects,
    test: PosthocTest,
    columns: &[Vec<f64>],
    undefined: &mut Reasons,
) -> Named<PosthocPair> {
    // The tests' own reasons carry their own names; those of the pairs are given above.
    let (mut inner, mut ignored) = (Reasons::default(), Reasons::default());
    let n = data.n();
    let single_t =
        |t: Option<f64>, df: usize, p: Option<f64>| Single(t, Some(df), n, p, PMethod::T);
    // Tests of means report dz, tests of ranks the rank-biserial correlation.
    let (singles, effects): (Vec<Single>, Vec<Effect>) = match test {
        PosthocTest::T => {
            let tests = analysis::paired_t(data, columns, &mut inner);
            let singles = tests.values().map(|t| single_t(t.t, t.df, t.p));
            (singles.collect(), dz(&tests))
        }
        PosthocTest::PooledT => {
            let parts = rm_anova::decompose(data);
            let (anova, _) = rm_anova::test(data, &parts);
            let tests = analysis::pooled_t(data, &parts, &anova, &mut inner);
            let singles = tests.values().map(|t| single_t(t.t, t.df, t.p));
            let paired = analysis::paired_t(data, columns, &mut ignored);
            (singles.collect(), dz(&paired))
        }
        PosthocTest::Wilcoxon => {
            let tests = analysis::wilcoxon(data, columns, &mut inner);
            let single = |w: &Wilcoxon| {
                let method = w.p_method.unwrap_or(PMethod::Exact);
                Single(w.w_plus, None, w.n_used, w.p, method)
            };
            (tests.values().map(single).collect(), rank_biserial(&tests))
        }
        PosthocTest::Conover => {
            let tests = analysis::conover(data, &RankTable::new(data), &mut inner);
            let singles = tests.values().map(|t| single_t(t.t, t.df, t.p));
            let signed = analysis::wilcoxon(data, columns, &mut ignored);
            (singles.collect(), rank_biserial(&signed))
        }
        PosthocTest::Nemenyi => {
            let tests = analysis::nemenyi(data, &RankTable::new(data));
            let single =
                |t: &Nemenyi| Single(Some(t.q), None, n, Some(t.p), PMethod::StudentizedRange);
            let signed = analysis::wilcoxon(data, columns, &mut ignored);
            (tests.values().map(single).collect(), rank_biserial(&signed))
        }
    };
    for (name, reason) in inner.iter() {
        let place = name.split_once('.').map_or(name, |(_, rest)| rest);
        // A reason for the whole pair, or for its p, is the reason here.
        let mut pairs = data.pairs().into_iter().map(|(_, _, pair)| pair);
        if let Some(pair) = pairs.find(|pair| place == pair || place == format!("{pair}.p")) {
            undefined.note_below(&format!("pairs.{pair}"), &PARTS_OF_TEST, reason);
        }
    }
    data.pairs()
        .into_iter()
        .zip(singles)
        .zip(effects)
        .map(|(((a, b, name), single), effect)| {
            let Single(statistic, df, n_used, p, method) = single;
            let differences = data.rows().map(|row| row[a] - row[b]);
            let pair = PosthocPair {
                mean_diff: mean_and_square_sum(differences).0,
                statistic,
                df,
                n_used,
                p,
                p_method: p.map(|_| method),
                p_adjusted: None,
                reject: None,
                effect,
            };
            (name, pair)
        })
        .collect()
}

fn dz(tests: &Named<PairedT>) -> Vec<Effect> {
    let effect =
        |t: &PairedT| Effect { name: EffectName::Dz, value: t.dz, ci: t.dz_ci, confidence: 0.95 };
    tests.values().map(effect).collect()
}

fn rank_biserial(tests: &Named<Wilcoxon>) -> Vec<Effect> {
    let effect = |w: &Wilcoxon| Effect {
        name: EffectName::RankBiserial,
        value: w.rank_biserial,
        ci: w.rank_biserial_ci,
        confidence: 0.95,
    };
    tests.values().map(effect).collect()
}
