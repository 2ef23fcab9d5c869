//! The test of one outcome, chosen by the design: what was varied, within whom and between whom, and what was answered.

use serde::{Deserialize, Serialize};

use crate::{
    AlignedRanks, AssumptionCheck, BetweenColumn, Comparison, Factorial, FactorialDesign, Formula,
    Friedman, GroupsAnalysis, Named, Ordinal, Predictor, RandomIntercept, Reasons, ShapiroWilk,
    StatsError, Wilcoxon, WithinColumn, WithinSubjects, aligned_ranks, compare,
    compare_without_exact, factorial, groups, normality::shapiro_wilk, ordinal, random_intercept,
    reasons::p_words, within, within_without_exact,
};

/// One outcome in a tidy table, a row a cell; all columns have shape `(rows,)`.
#[derive(Debug, Clone, Default)]
pub struct DesignColumns<'a> {
    /// Whose each row is.
    pub subjects: &'a [String],
    /// Up to two factors that change within subjects.
    pub within: Vec<WithinColumn<'a>>,
    /// Up to two factors that do not.
    pub between: Vec<BetweenColumn<'a>>,
    /// Covariates.
    pub covariates: Vec<(&'a str, &'a [Option<f64>])>,
    /// The outcome.
    pub values: &'a [Option<f64>],
}

/// What the numbers of an outcome are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum OutcomeScale {
    /// A measure: its distances count, even if it happens to be whole numbers.
    #[default]
    Measure,
    /// A rating: an item of few whole answers has an order alone, a mean of items has distances.
    Rating,
    /// Ordered answers, whatever they look like.
    Ordinal,
}

/// What becomes of a subject with a missing cell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum MissingCells {
    /// Left out whole, and named.
    #[default]
    Listwise,
    /// Kept, with the cells that are there, in a mixed model.
    Mixed,
}

/// How the test is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesignChoice {
    /// What the numbers are.
    pub scale: OutcomeScale,
    /// What becomes of a subject with a missing cell.
    pub missing: MissingCells,
    /// Level of significance.
    pub alpha: f64,
    /// Whether Friedman's p is exact where feasible; simulations do without.
    pub exact: bool,
}

impl Default for DesignChoice {
    fn default() -> Self {
        Self {
            scale: OutcomeScale::default(),
            missing: MissingCells::default(),
            alpha: 0.05,
            exact: true,
        }
    }
}

/// The test that a design calls for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ChosenTest {
    /// Factorial analysis of variance.
    Factorial,
    /// Aligned ranks.
    AlignedRanks,
    /// Welch's t of two groups.
    WelchT,
    /// Mann and Whitney's test of two groups.
    MannWhitney,
    /// Welch's analysis of variance of several groups.
    WelchAnova,
    /// Kruskal and Wallis' test of several groups.
    KruskalWallis,
    /// Mixed model with a random intercept.
    Mixed,
    /// Cumulative logit with a random intercept.
    Ordinal,
}

/// A chosen test with what it found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Chosen<T> {
    /// The test.
    pub chosen: ChosenTest,
    /// Why, one sentence a step.
    pub reasons: Vec<String>,
    /// Every check that was made.
    pub checks: Vec<AssumptionCheck>,
    /// What was found, under the names of its own call.
    #[serde(flatten)]
    pub found: T,
}

/// A factorial analysis, and the aligned ranks where they were chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactorialFinding {
    /// Analysis of variance, means, contrasts and simple effects.
    #[serde(flatten)]
    pub anova: Factorial,
    /// The effects by aligned ranks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ranks: Option<AlignedRanks>,
}

/// An ordinal model, and the rank test of the same subjects beside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OrdinalFinding {
    /// The model.
    #[serde(flatten)]
    pub model: Ordinal,
    /// The rank test of the complete subjects, as a check; `None` where too few are complete.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beside: Option<RankCheck>,
}

/// The rank tests beside an ordinal model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RankCheck {
    /// Of all conditions.
    pub friedman: Friedman,
    /// Of each pair.
    pub wilcoxon: Named<Wilcoxon>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// What a design called for, and what was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum ByDesign {
    /// One factor within subjects.
    OneFactor(Box<Comparison>),
    /// Several factors.
    Factorial(Box<Chosen<FactorialFinding>>),
    /// Independent groups.
    Groups(Box<Chosen<GroupsAnalysis>>),
    /// A covariate, or subjects with missing cells that stay.
    Mixed(Box<Chosen<RandomIntercept>>),
    /// Ordered answers.
    Ordinal(Box<Chosen<OrdinalFinding>>),
}

impl ByDesign {
    /// Why this test, one sentence a step.
    pub fn reasons(&self) -> &[String] {
        match self {
            Self::OneFactor(found) => &found.reasons,
            Self::Factorial(found) => &found.reasons,
            Self::Groups(found) => &found.reasons,
            Self::Mixed(found) => &found.reasons,
            Self::Ordinal(found) => &found.reasons,
        }
    }

    /// p of each effect by its name; of one factor, of groups and of answers the single one is `omnibus`.
    pub fn effects(&self) -> Vec<(String, Option<f64>)> {
        let named = |all: Vec<(&str, Option<f64>)>| {
            all.into_iter().map(|(n, p)| (n.to_owned(), p)).collect()
        };
        let single = |p| named(vec![("omnibus", p)]);
        match self {
            Self::OneFactor(found) => single(found.omnibus.p),
            Self::Factorial(found) => match &found.found.ranks {
                Some(ranks) => named(ranks.art.iter().map(|(name, e)| (name, e.p)).collect()),
                None => {
                    let anova = &found.found.anova;
                    named(
                        anova
                            .anova
                            .iter()
                            .map(|(name, _)| (name, corrected(anova, name)))
                            .collect(),
                    )
                }
            },
            Self::Groups(found) => single(group_p(found.chosen, &found.found)),
            Self::Mixed(found) => named(
                found
                    .found
                    .anova
                    .iter()
                    .map(|(name, t)| (name, t.p))
                    .collect(),
            ),
            Self::Ordinal(found) => single(found.found.model.quadrature.lr.p),
        }
    }
}

/// p of an effect, after Greenhouse and Geisser's correction where its within part has more than one degree of freedom.
fn corrected(found: &Factorial, effect: &str) -> Option<f64> {
    match found.sphericity.get(effect) {
        Some(sphericity) => sphericity.p_gg,
        None => found.anova.get(effect)?.p,
    }
}

fn group_p(chosen: ChosenTest, found: &GroupsAnalysis) -> Option<f64> {
    let several = found.several.as_ref();
    match chosen {
        ChosenTest::WelchT => found.welch_t.values().next()?.p,
        ChosenTest::MannWhitney => found.mann_whitney.values().next()?.p,
        ChosenTest::WelchAnova => several?.welch_anova.p,
        _ => several?.kruskal.p,
    }
}

/// Chooses the test that the design calls for, runs it, and says why.
///
/// | design | test |
/// | --- | --- |
/// | a covariate; or missing cells with [`MissingCells::Mixed`] | mixed model with a random intercept, Satterthwaite |
/// | one factor within, ordered answers | cumulative logit with a random intercept; the rank test beside it |
/// | one factor within | [`compare`] |
/// | groups | Welch's t or analysis of variance; Mann-Whitney or Kruskal-Wallis where residuals are not normal |
/// | anything else | factorial analysis of variance, Greenhouse-Geisser by effect; aligned ranks where residuals are not normal |
///
/// Residuals are judged by Shapiro and Wilk at 5 %, each over the root mean square of its cell, as in [`compare`]; with factors of
/// both kinds those within subjects and those of the subjects' means both have to pass.
///
/// # Errors
/// Those of the test chosen; [`StatsError::BadParameter`] if `alpha` is not between 0 and 1 or there is nothing to compare.
///
/// # Example
/// ```
/// use maveric_stats::{ByDesign, ChosenTest, DesignChoice, DesignColumns, compare_by_design};
/// let people: Vec<String> = (0..12).map(|i| i.to_string()).collect();
/// let vehicle: Vec<Option<String>> = (0..12).map(|i| Some(["car", "truck"][i % 2].to_owned())).collect();
/// let speed: Vec<Option<f64>> = (0..12).map(|i| Some(20.0 + f64::from(i % 2) + 0.1 * f64::from(i * i % 7))).collect();
/// let data = DesignColumns { subjects: &people, between: vec![("vehicle", &vehicle)], values: &speed, ..Default::default() };
/// let ByDesign::Groups(found) = compare_by_design(&data, &DesignChoice::default())? else { unreachable!() };
/// assert_eq!(found.chosen, ChosenTest::WelchT);
/// assert!(found.reasons[0].starts_with("independent groups"));
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn compare_by_design(
    data: &DesignColumns<'_>,
    choice: &DesignChoice,
) -> Result<ByDesign, StatsError> {
    if !(choice.alpha > 0.0 && choice.alpha < 1.0) {
        return Err(StatsError::BadParameter {
            name: "alpha".to_owned(),
            expected: "between 0 and 1".to_owned(),
            found: choice.alpha,
        });
    }
    let mut reasons = Vec::new();
    if let Some((name, _)) = data.covariates.first() {
        reasons.push(format!(
            "a covariate ({name}): mixed model with a random intercept of the subject, by Satterthwaite's degrees of freedom"
        ));
        return mixed(data, reasons);
    }
    if choice.missing == MissingCells::Mixed {
        if let Some(who) = incomplete(data) {
            reasons.push(format!(
                "{who} of the subjects have a missing cell and are kept: mixed model with a random intercept of the subject"
            ));
            return mixed(data, reasons);
        }
        reasons.push("no cell is missing, so nobody needs a mixed model to stay".to_owned());
    }
    match (&data.within[..], &data.between[..]) {
        ([(_, conditions)], []) => one_factor(data, conditions, choice, reasons),
        ([], [(_, group)]) => independent(data, group, reasons),
        _ => several(data, choice, reasons),
    }
}

/// How many subjects lack a cell that others have, if any.
fn incomplete(data: &DesignColumns<'_>) -> Option<usize> {
    let cell = |row: usize| {
        data.within
            .iter()
            .map(move |(_, cells)| cells[row].as_str())
            .collect::<Vec<_>>()
    };
    let rows = data.values.len().min(data.subjects.len());
    if data.within.iter().any(|(_, cells)| cells.len() < rows) {
        return None;
    }
    let cells: std::collections::BTreeSet<Vec<&str>> = (0..rows).map(cell).collect();
    let mut filled: std::collections::BTreeMap<&str, std::collections::BTreeSet<Vec<&str>>> =
        std::collections::BTreeMap::new();
    for row in 0..rows {
        let own = filled.entry(data.subjects[row].as_str()).or_default();
        if data.values[row].is_some() {
            own.insert(cell(row));
        }
    }
    let short = filled
        .values()
        .filter(|own| own.len() < cells.len())
        .count();
    (short > 0).then_some(short)
}

fn mixed(data: &DesignColumns<'_>, reasons: Vec<String>) -> Result<ByDesign, StatsError> {
    let within: Vec<Vec<Option<String>>> = data
        .within
        .iter()
        .map(|(_, cells)| cells.iter().cloned().map(Some).collect())
        .collect();
    let factors = data
        .within
        .iter()
        .map(|(name, _)| *name)
        .zip(within.iter().map(Vec::as_slice));
    let between = data.between.iter().map(|(name, cells)| (*name, *cells));
    let factors: Vec<(&str, &[Option<String>])> = between.chain(factors).collect();
    let product: Vec<&str> = factors.iter().map(|(name, _)| *name).collect();
    let product = (!product.is_empty()).then(|| product.join("*"));
    let covariates = data.covariates.iter().map(|(name, _)| (*name).to_owned());
    let terms: Vec<String> = product.into_iter().chain(covariates).collect();
    let formula: Formula = terms.join(" + ").parse()?;
    let mut predictors: Vec<(&str, Predictor<'_>)> = factors
        .iter()
        .map(|(name, cells)| (*name, Predictor::Factor(cells)))
        .collect();
    predictors.extend(
        data.covariates
            .iter()
            .map(|(name, v)| (*name, Predictor::Covariate(v))),
    );
    let found = random_intercept(data.subjects, &formula, &predictors, data.values)?;
    Ok(ByDesign::Mixed(Box::new(Chosen {
        chosen: ChosenTest::Mixed,
        reasons,
        checks: Vec::new(),
        found,
    })))
}

/// Different answers at most of an item.
const MOST_ANSWERS: usize = 7;

/// Whether the answers are of few whole numbers; and what speaks for or against, in words.
fn few_whole_answers(values: &[Option<f64>]) -> Result<String, String> {
    let mut different: Vec<f64> = values.iter().flatten().copied().collect();
    different.sort_by(f64::total_cmp);
    different.dedup_by(|a, b| (*a - *b).abs() <= 0.0);
    if let Some(part) = different.iter().find(|v| v.fract().abs() > 0.0) {
        return Err(format!(
            "{part} is no whole number: a mean of items, not an item"
        ));
    }
    if different.len() > MOST_ANSWERS {
        return Err(format!(
            "{} different answers are more than {MOST_ANSWERS}",
            different.len()
        ));
    }
    Ok(format!("{} different whole answers", different.len()))
}

fn one_factor(
    data: &DesignColumns<'_>,
    conditions: &[String],
    choice: &DesignChoice,
    mut reasons: Vec<String>,
) -> Result<ByDesign, StatsError> {
    let few = few_whole_answers(data.values);
    let as_answers = match (choice.scale, &few) {
        (OutcomeScale::Measure, Ok(words)) => {
            reasons.push(format!(
                "{words}, but a measure: its distances count; ordered answers have to be asked for"
            ));
            false
        }
        (OutcomeScale::Measure, Err(_)) => false,
        (OutcomeScale::Rating, Ok(words)) => {
            reasons.push(format!("an item ({words}), of which only the order counts: cumulative logit with a random intercept of the subject"));
            true
        }
        (OutcomeScale::Rating, Err(why)) => {
            reasons.push(format!("a scale, not an item ({why}): its distances count"));
            false
        }
        (OutcomeScale::Ordinal, _) => {
            reasons.push("ordered answers, as asked: cumulative logit with a random intercept of the subject".to_owned());
            true
        }
    };
    let complete = WithinSubjects::from_long(data.subjects, conditions, data.values);
    if as_answers {
        let model = ordinal(data.subjects, conditions, data.values)?;
        reasons
            .push("the rank test of the complete subjects stands beside it, as a check".to_owned());
        let beside = complete.ok().map(|data| rank_check(&data, choice.exact));
        return Ok(ByDesign::Ordinal(Box::new(Chosen {
            chosen: ChosenTest::Ordinal,
            reasons,
            checks: Vec::new(),
            found: OrdinalFinding { model, beside },
        })));
    }
    let complete = complete?;
    let mut found = if choice.exact {
        compare(&complete, choice.alpha)?
    } else {
        compare_without_exact(&complete, choice.alpha)?
    };
    found.reasons.splice(0..0, reasons);
    Ok(ByDesign::OneFactor(Box::new(found)))
}

fn rank_check(data: &WithinSubjects, exact: bool) -> RankCheck {
    let all = if exact {
        within(data)
    } else {
        within_without_exact(data)
    };
    let mut undefined = Reasons::default();
    for (name, reason) in all.undefined.iter() {
        if name.starts_with("friedman") || name.starts_with("wilcoxon") {
            undefined.note(name, reason);
        }
    }
    RankCheck {
        friedman: all.friedman,
        wilcoxon: all.wilcoxon,
        undefined,
    }
}

/// Level of the checks of assumptions.
const CHECK_ALPHA: f64 = 0.05;

fn check(name: &str, found: &ShapiroWilk) -> AssumptionCheck {
    AssumptionCheck {
        name: format!("normality of {name} (Shapiro-Wilk)"),
        statistic: found.w,
        p: found.p,
        passed: found.p.map(|p| p >= CHECK_ALPHA),
    }
}

/// What the checks say together: all stand, and the words for it.
fn judged(checks: &[AssumptionCheck]) -> (bool, String) {
    match checks.iter().find(|check| check.passed != Some(true)) {
        None => {
            let p: Vec<String> = checks.iter().filter_map(|c| c.p).map(p_words).collect();
            (
                true,
                format!(
                    "normality of the standardised residuals is not rejected ({})",
                    p.join("; ")
                ),
            )
        }
        Some(check) => {
            let what = check
                .name
                .trim_start_matches("normality of ")
                .trim_end_matches(" (Shapiro-Wilk)");
            let why = check.p.map_or_else(
                || format!("{what} cannot be tested for normality"),
                |p| format!("{what} are not normal ({})", p_words(p)),
            );
            (false, why)
        }
    }
}

/// Values less their group's mean, over its root mean square.
fn of_groups(values: &[f64], group: &[usize]) -> Vec<f64> {
    let most = group.iter().max().map_or(0, |g| g + 1);
    let mut out = vec![0.0; values.len()];
    for g in 0..most {
        let own: Vec<usize> = (0..group.len()).filter(|&i| group[i] == g).collect();
        let n = own.len() as f64;
        let mean = own.iter().map(|&i| values[i]).sum::<f64>() / n;
        let spread = (own.iter().map(|&i| (values[i] - mean).powi(2)).sum::<f64>() / n).sqrt();
        for i in own {
            out[i] = if spread > 0.0 {
                (values[i] - mean) / spread
            } else {
                0.0
            };
        }
    }
    out
}

fn independent(
    data: &DesignColumns<'_>,
    group: &[Option<String>],
    mut reasons: Vec<String>,
) -> Result<ByDesign, StatsError> {
    if let (Some(twice), true) = (
        crate::within_subjects::Index::of(data.subjects).repeated,
        !data.subjects.is_empty(),
    ) {
        return Err(StatsError::DoubleName {
            what: "subject".to_owned(),
            name: twice,
        });
    }
    let rows = || {
        group
            .iter()
            .zip(data.values)
            .filter_map(|(g, v)| Some((g.clone()?, *v)))
    };
    let (names, values): (Vec<String>, Vec<Option<f64>>) = rows().unzip();
    let found = groups(&names, &values)?;
    let index = crate::within_subjects::Index::of(&names);
    let (own, kept): (Vec<usize>, Vec<f64>) = index
        .rows
        .iter()
        .zip(&values)
        .filter_map(|(g, v)| Some((*g, (*v)?)))
        .unzip();
    let (test, _) = shapiro_wilk(&of_groups(&kept, &own));
    let checks = vec![check("the standardised residuals", &test)];
    let (normal, words) = judged(&checks);
    let (chosen, name) = match (normal, found.several.is_some()) {
        (true, false) => (ChosenTest::WelchT, "Welch's t"),
        (false, false) => (ChosenTest::MannWhitney, "Mann-Whitney"),
        (true, true) => (
            ChosenTest::WelchAnova,
            "Welch's analysis of variance, pairs after Games and Howell",
        ),
        (false, true) => (
            ChosenTest::KruskalWallis,
            "Kruskal-Wallis, pairs after Dunn",
        ),
    };
    reasons.push(format!("independent groups; {words}: {name}"));
    Ok(ByDesign::Groups(Box::new(Chosen {
        chosen,
        reasons,
        checks,
        found,
    })))
}

fn several(
    data: &DesignColumns<'_>,
    choice: &DesignChoice,
    mut reasons: Vec<String>,
) -> Result<ByDesign, StatsError> {
    if choice.scale == OutcomeScale::Ordinal {
        reasons.push("ordered answers have a model of one factor within subjects alone: their ranks are aligned instead".to_owned());
    }
    let design =
        FactorialDesign::from_columns(data.subjects, &data.within, &data.between, data.values)?;
    let [inside, people] = design.standardised_residuals();
    let mut checks = Vec::new();
    for (name, residuals) in [
        ("the standardised residuals", inside),
        ("the subjects' standardised means", people),
    ] {
        if !residuals.is_empty() {
            checks.push(check(name, &shapiro_wilk(&residuals).0));
        }
    }
    let (normal, words) = judged(&checks);
    let normal = normal && choice.scale != OutcomeScale::Ordinal;
    let (chosen, name) = if normal {
        (
            ChosenTest::Factorial,
            "analysis of variance with type III sums of squares, Greenhouse-Geisser by effect",
        )
    } else {
        (ChosenTest::AlignedRanks, "aligned ranks")
    };
    let kinds = match (data.within.len(), data.between.len()) {
        (0, k) => format!("{k} factors between subjects"),
        (k, 0) => format!("{k} factors within subjects"),
        (w, b) => format!("{w} within and {b} between subjects"),
    };
    reasons.push(format!("{kinds}; {words}: {name}"));
    let found = FactorialFinding {
        anova: factorial(&design),
        ranks: (!normal).then(|| aligned_ranks(&design)),
    };
    Ok(ByDesign::Factorial(Box::new(Chosen {
        chosen,
        reasons,
        checks,
        found,
    })))
}
