//! One procedure from data to finding: check, choose, test, compare pairs, and say why.

mod omnibus;

pub use omnibus::{Omnibus, OmnibusP, OmnibusTest};

use omnibus::{of_anova, of_friedman, of_pair};
use serde::{Deserialize, Serialize};

use crate::{
    Adjustment, ConditionSummary, Mauchly, Named, Posthoc, PosthocTest, Reasons, ShapiroWilk,
    Sphericity, SphericityCorrection, StatsError, WithinSubjects, analysis, apa,
    friedman::{self, Exact, RankTable},
    normality::shapiro_wilk,
    posthoc::all_pairs,
    rm_anova,
};

/// One assumption that was looked at.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AssumptionCheck {
    /// What was checked, in words.
    pub name: String,
    /// W of Shapiro and Wilk, or of Mauchly.
    pub statistic: Option<f64>,
    /// p of the check.
    pub p: Option<f64>,
    /// Whether the assumption stands; `None` if it could not be tested.
    pub passed: Option<bool>,
}

/// Level of the checks of assumptions.
const CHECK_ALPHA: f64 = 0.05;

impl AssumptionCheck {
    fn new(name: impl Into<String>, statistic: Option<f64>, p: Option<f64>) -> Self {
        Self { name: name.into(), statistic, p, passed: p.map(|p| p >= CHECK_ALPHA) }
    }

    pub(crate) fn of_normality(what: &str, test: &ShapiroWilk) -> Self {
        let name = format!("normality of {what} (Shapiro-Wilk)");
        Self::new(name, test.w, test.p)
    }
}

/// What p of Shapiro and Wilk's test says of a sample.
pub(crate) fn normality_in_words(what: &str, p: Option<f64>) -> String {
    match p {
        Some(p) if p >= CHECK_ALPHA => {
            format!("normality of {what} is not rejected ({})", apa::p(p))
        }
        Some(p) => format!("{what} are not normal ({})", apa::p(p)),
        None => format!("{what} cannot be tested for normality"),
    }
}

/// What was checked, chosen and found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Complete subjects.
    pub n: usize,
    /// Conditions.
    pub k: usize,
    /// Subjects left out because a cell is missing.
    pub dropped: Vec<String>,
    /// Mean and spread by condition.
    pub desc: Named<ConditionSummary>,
    /// The omnibus test.
    pub chosen: OmnibusTest,
    /// Why, one sentence a step.
    pub reasons: Vec<String>,
    /// Every check that was made.
    pub checks: Vec<AssumptionCheck>,
    /// The finding.
    pub omnibus: Omnibus,
    /// All pairs: paired t or Wilcoxon, Holm's correction.
    pub posthoc: Posthoc,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Checks assumptions, then chooses between analysis of variance and Friedman's test.
///
/// 1. Shapiro and Wilk on the residuals of the additive model (value - subject mean -
///    condition mean + grand mean), each over the root mean square of its condition:
///    conditions that vary unequally are the business of step 2. Rejected at 5 %, or not
///    testable: Friedman's test, then Wilcoxon's.
/// 2. Else the analysis of variance, then paired t tests. With more than two conditions the
///    degrees of freedom are multiplied by Huynh and Feldt's ε if Greenhouse and Geisser's
///    is above .75, else by Greenhouse and Geisser's (Girden, 1992), whatever Mauchly's
///    test says: it is reported among the checks, but as a gate it lets through what it is
///    too weak to see. With 24 x 4 values and ε of .7, pooled residuals and that gate
///    would find differences in 6 of 100 null data sets; this procedure keeps to 5
///    (`examples/false_positives.rs`).
///
/// Two conditions have differences, which Shapiro and Wilk's test looks at: the paired t test, or Wilcoxon's.
///
/// Pairs are corrected by Holm's method, whatever the omnibus test says. Each step is
/// recorded in `checks` and `reasons`.
///
/// # Errors
/// [`StatsError::BadParameter`] if `alpha` is not between 0 and 1.
///
/// # Example
/// ```
/// use maveric_stats::{OmnibusTest, WithinSubjects, compare};
/// let rows = [[1.0, 4.0, 2.0], [2.0, 6.0, 3.0], [3.0, 6.5, 3.5], [1.5, 5.0, 4.0]].map(Vec::from);
/// let data = WithinSubjects::from_rows(&["a", "b", "c"], &["1", "2", "3", "4"], &rows)?;
/// let result = compare(&data, 0.05)?;
/// assert_eq!(result.chosen, OmnibusTest::RmAnova);
/// assert!(result.omnibus.reject == Some(true) && result.reasons.len() == 2);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn compare(data: &WithinSubjects, alpha: f64) -> Result<Comparison, StatsError> {
    run(data, alpha, Exact::Feasible, None)
}

/// [`compare`] with Iman and Davenport's p of Friedman's test in the place of the exact one,
/// which takes hundreds of times longer than all the rest together: for simulations.
///
/// # Errors
/// As [`compare`].
///
/// # Example
/// ```
/// use maveric_stats::{OmnibusP, WithinSubjects, compare_without_exact};
/// // One wild value among eight subjects.
/// let mut rows: Vec<_> = (1..=8).map(f64::from).map(|i| vec![i, i + 0.5 + 0.1 * (i % 3.0), i + 1.0]).collect();
/// rows[3][1] = 90.0;
/// let people = ["1", "2", "3", "4", "5", "6", "7", "8"];
/// let data = WithinSubjects::from_rows(&["a", "b", "c"], &people, &rows)?;
/// assert_eq!(compare_without_exact(&data, 0.05)?.omnibus.p_method, OmnibusP::ImanDavenport);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn compare_without_exact(data: &WithinSubjects, alpha: f64) -> Result<Comparison, StatsError> {
    run(data, alpha, Exact::No, None)
}

/// [`compare`], or the test that was declared, whatever the residuals look like.
pub(crate) fn run(
    data: &WithinSubjects,
    alpha: f64,
    exact: Exact,
    declared: Option<PosthocTest>,
) -> Result<Comparison, StatsError> {
    StatsError::between_0_and_1("alpha", alpha)?;
    let parts = rm_anova::decompose(data);
    let mut trace = Trace::default();
    let (chosen, several) = if data.k() == 2 {
        let tests = [OmnibusTest::PairedT, OmnibusTest::Wilcoxon];
        let chosen = trace.choose("the differences", &of_differences(data), None, tests);
        (declared.map_or(chosen, |test| trace.declared(test, true)), None)
    } else {
        let mut inner = Reasons::default();
        let (anova, mauchly, sphericity) = analysis::variance_part(data, &parts, &mut inner);
        let (normal, _) = shapiro_wilk(&standardised(&parts.residuals, data.k()));
        let no_error = "the error sum of squares is zero, so there is no F";
        let no_error = anova.f.is_none().then_some(no_error);
        let tests = [OmnibusTest::RmAnova, OmnibusTest::Friedman];
        let chosen = trace.choose("the standardised residuals", &normal, no_error, tests);
        let chosen = declared.map_or(chosen, |test| trace.declared(test, false));
        let omnibus = if chosen == OmnibusTest::RmAnova {
            let correction = trace.correction(&mauchly, &sphericity);
            of_anova(&anova, &sphericity, correction)
        } else {
            let (friedman, _) = friedman::test(&RankTable::new(data), exact);
            of_friedman(&friedman)
        };
        (chosen, Some(omnibus))
    };
    let test = match chosen {
        OmnibusTest::RmAnova | OmnibusTest::PairedT => PosthocTest::T,
        OmnibusTest::Friedman | OmnibusTest::Wilcoxon => PosthocTest::Wilcoxon,
    };
    let mut posthoc = all_pairs(data, test, Adjustment::Holm, alpha);
    let omnibus = several.unwrap_or_else(|| of_pair(chosen, &posthoc));
    let omnibus = Omnibus { reject: omnibus.p.map(|p| p < alpha), ..omnibus };
    let mut undefined = Reasons::default();
    say_why(&omnibus, &trace.checks, &mut undefined);
    undefined.absorb("posthoc", std::mem::take(&mut posthoc.undefined));
    Ok(Comparison {
        n: data.n(),
        k: data.k(),
        dropped: data.dropped().to_vec(),
        desc: analysis::summaries(data, &parts),
        chosen,
        reasons: trace.reasons,
        checks: trace.checks,
        omnibus,
        posthoc,
        undefined,
    })
}

/// Residuals over the root mean square of their condition.
fn standardised(residuals: &[f64], k: usize) -> Vec<f64> {
    let mut squares = vec![0.0; k];
    for row in residuals.chunks_exact(k) {
        for (sum, r) in squares.iter_mut().zip(row) {
            *sum += r * r;
        }
    }
    let n = (residuals.len() / k) as f64;
    let scale: Vec<f64> = squares.iter().map(|s| (s / n).sqrt()).collect();
    let over = |(r, s): (&f64, &f64)| if *s > 0.0 { r / s } else { 0.0 };
    let rows = residuals.chunks_exact(k);
    rows.flat_map(|row| row.iter().zip(&scale).map(over)).collect()
}

/// The checks made so far, and what followed from each.
#[derive(Default)]
struct Trace {
    checks: Vec<AssumptionCheck>,
    reasons: Vec<String>,
}

impl Trace {
    /// The first of both tests where a check lets normality stand and `impossible` gives no reason against it.
    fn choose(
        &mut self,
        what: &str,
        normal: &ShapiroWilk,
        impossible: Option<&str>,
        [by_means, by_ranks]: [OmnibusTest; 2],
    ) -> OmnibusTest {
        let check = AssumptionCheck::of_normality(what, normal);
        let stands = check.passed == Some(true) && impossible.is_none();
        let chosen = if stands { by_means } else { by_ranks };
        let why = impossible.map_or_else(|| normality_in_words(what, check.p), str::to_owned);
        self.reasons.push(format!("{why}: {}", chosen.words()));
        self.checks.push(check);
        chosen
    }

    /// The test of a design that declares one: no check has a say.
    fn declared(&mut self, test: PosthocTest, of_two: bool) -> OmnibusTest {
        let test = match (test, of_two) {
            (PosthocTest::T, true) => OmnibusTest::PairedT,
            (PosthocTest::T, false) => OmnibusTest::RmAnova,
            (_, true) => OmnibusTest::Wilcoxon,
            (_, false) => OmnibusTest::Friedman,
        };
        let words = test.words();
        self.reasons = vec![format!("{words}, as declared, whatever the residuals look like")];
        test
    }

    fn correction(&mut self, mauchly: &Mauchly, sphericity: &Sphericity) -> SphericityCorrection {
        let check = AssumptionCheck::new("sphericity (Mauchly)", mauchly.w, mauchly.p);
        self.checks.push(check);
        let gg = sphericity.gg.unwrap_or(sphericity.lower_bound);
        let tested = match mauchly.p {
            Some(p) if p >= CHECK_ALPHA => {
                format!("Mauchly's test does not reject it, {}", apa::p(p))
            }
            Some(p) => format!("Mauchly's test rejects it, {}", apa::p(p)),
            None => "it cannot be tested".to_owned(),
        };
        let correction = sphericity.correction();
        let times = match correction {
            SphericityCorrection::None => "Huynh and Feldt's epsilon is 1: no correction",
            SphericityCorrection::HuynhFeldt => "above .75: Huynh-Feldt correction",
            SphericityCorrection::GreenhouseGeisser => {
                "not above .75: Greenhouse-Geisser correction"
            }
        };
        self.reasons.push(format!(
            "sphericity is allowed for in any case ({tested}); Greenhouse-Geisser epsilon is {gg:.2}, {times}"
        ));
        correction
    }
}

/// Differences of two conditions.
fn of_differences(data: &WithinSubjects) -> ShapiroWilk {
    let differences: Vec<f64> = data.rows().map(|row| row[0] - row[1]).collect();
    shapiro_wilk(&differences).0
}

fn say_why(omnibus: &Omnibus, checks: &[AssumptionCheck], undefined: &mut Reasons) {
    for (i, check) in checks.iter().enumerate() {
        if check.p.is_none() {
            undefined.note(&format!("checks.{i}"), "the data do not allow this check");
        }
    }
    let of_two = matches!(omnibus.test, OmnibusTest::PairedT | OmnibusTest::Wilcoxon);
    if omnibus.statistic.is_none() || omnibus.p.is_none() && of_two {
        let reason = "neither test has a value: the conditions do not differ for any subject";
        undefined.note("omnibus", reason);
    }
    if of_two {
        let reason = "a test of two conditions has neither";
        undefined.note_below("omnibus", &["df2", "epsilon"], reason);
        if omnibus.test == OmnibusTest::Wilcoxon {
            undefined.note("omnibus.df1", "Wilcoxon's test has no degrees of freedom");
        }
        if omnibus.effect.value.is_some() && omnibus.effect.ci.low.is_none() {
            let reason = "the differences do not vary, or the effect is at its limit";
            undefined.note_ends(&["omnibus.effect.ci"], reason);
        }
        return;
    }
    let corrected = omnibus.test != OmnibusTest::Friedman;
    if corrected && omnibus.statistic.is_some() && omnibus.epsilon.is_none() {
        let reason = "the covariances of the conditions are too small for an epsilon, and so for its degrees of freedom";
        let parts = ["df1", "df2", "epsilon", "p", "reject"];
        undefined.note_below("omnibus", &parts, reason);
    }
    if omnibus.test == OmnibusTest::Friedman {
        let reason = "Friedman's chi-squared has neither";
        undefined.note_below("omnibus", &["df2", "epsilon"], reason);
        if omnibus.effect.ci.low.is_none() {
            let reason =
                "all subjects order the conditions alike, so there is no F of the ranks to invert";
            undefined.note_ends(&["omnibus.effect.ci"], reason);
        }
    }
}
