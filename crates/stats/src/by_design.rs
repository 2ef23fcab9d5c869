//! The test of one outcome, chosen by the design: what was varied, within whom and between whom, and what was answered.

mod carry_over;
mod effects;
mod factors;
mod follow_up;
mod found;
mod groups;
mod kept;
mod level_contrast;
mod one_factor;
mod parts;
mod period;
mod plan;
mod table;

pub use carry_over::{CarriedOver, CarryOver, NoCarryOver, carry_over};
pub use effects::EffectTest;
pub use follow_up::{CellMean, FollowUp, LevelPair, SimplePairs, follow_up};
pub use found::{
    ByDesign, Chosen, ChosenTest, CorrectedTerm, FactorialFinding, MixedFinding, OrdinalFinding,
    PERIOD, RankCheck, SmallSample,
};
pub use level_contrast::{LevelChoice, LevelContrast, level_contrast};
pub use parts::{SimpleTest, simple_effects};
pub use plan::{DesignPlan, DesignShape, EffectMethod, PlannedEffect};
pub use table::DesignTable;

use crate::{
    AssumptionCheck, BetweenColumn, StatsError, WithinColumn, apa, compare::normality_in_words,
    friedman::Exact, within_subjects::Index,
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
    /// Covariates: of the subjects where each has one value, else of the rows.
    pub covariates: Vec<(&'a str, &'a [Option<f64>])>,
    /// The effects within subjects (`a`, `a:t`) that a covariate of the subjects is multiplied by, as declared.
    pub with: Vec<(&'a str, Vec<&'a str>)>,
    /// In which place of the subject's order each row was met, from 1; empty where orders are not known.
    pub periods: &'a [usize],
    /// The outcome.
    pub values: &'a [Option<f64>],
    /// What reasons call a column, where that is not its name.
    pub labels: Vec<(&'a str, &'a str)>,
}

impl DesignColumns<'_> {
    /// Whether condition and period can be told apart within people, in the orders that there are.
    pub fn tells_period(&self) -> bool {
        carry_over::is_connected(self)
    }

    /// Rows with a value, by subject.
    fn filled_rows(&self) -> Vec<Vec<usize>> {
        let filled = |row: &usize| self.values.get(*row).is_some_and(Option::is_some);
        let mut people = Index::from_labels(self.subjects).members();
        for rows in &mut people {
            rows.retain(filled);
        }
        people.retain(|rows| !rows.is_empty());
        people
    }

    /// An effect (`a:b`) as reasons call it.
    fn called(&self, effect: &str) -> String {
        if self.labels.is_empty() {
            return effect.to_owned();
        }
        let label = |name: &str| {
            let known = self.labels.iter().find(|(n, _)| *n == name);
            known.map_or(name, |(_, label)| label).to_owned()
        };
        let labels: Vec<String> = effect.split(':').map(label).collect();
        labels.join(" × ")
    }
}

/// What the numbers of an outcome are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum OutcomeScale {
    /// A measure: its distances count, even if it happens to be whole numbers.
    #[default]
    Measure,
    /// A rating: an item of at most seven whole answers has an order alone, a mean of items has distances.
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

/// Which test is asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AskedTest {
    /// The one that the design, the scale and the checks choose.
    #[default]
    Chosen,
    /// Mixed model.
    Mixed,
    /// Cumulative logit with a random intercept; of one factor within subjects.
    Ordinal,
    /// Analysis of variance and paired t tests; of one factor within subjects, without periods.
    RmAnova,
    /// Friedman's and Wilcoxon's tests; of the same.
    Friedman,
}

/// How the test is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesignChoice {
    /// Which test is asked for.
    pub test: AskedTest,
    /// What the numbers are.
    pub scale: OutcomeScale,
    /// What becomes of a subject with a missing cell.
    pub missing: MissingCells,
    /// Level of significance.
    pub alpha: f64,
    /// Whether Friedman's p is exact where feasible; simulations do without.
    pub exact: bool,
}

impl DesignChoice {
    fn exact(&self) -> Exact {
        if self.exact { Exact::Feasible } else { Exact::No }
    }
}

impl Default for DesignChoice {
    fn default() -> Self {
        Self {
            test: AskedTest::default(),
            scale: OutcomeScale::default(),
            missing: MissingCells::default(),
            alpha: 0.05,
            exact: true,
        }
    }
}

/// Chooses the test that the design calls for, runs it, and says why.
///
/// | design | test |
/// | --- | --- |
/// | a test that is asked for | that one; with the period where orders are known |
/// | periods | of one factor within, ordered answers: cumulative logit with a random intercept; else mixed model; both with the period as a factor, whatever its p |
/// | a covariate that changes within subjects; or missing cells with [`MissingCells::Mixed`] | mixed model with a variance of the subject and of the subject at each level of each factor, Satterthwaite, Greenhouse-Geisser by term, each pair over its own error |
/// | one row a subject and a covariate | linear model (analysis of covariance) |
/// | one factor within, ordered answers | cumulative logit with a random intercept; the rank test beside it |
/// | one factor within | [`compare`](crate::compare) |
/// | one factor between | Welch's t or analysis of variance; Mann-Whitney or Kruskal-Wallis where residuals are not normal |
/// | anything else | each effect as its [`DesignPlan`] has it |
///
/// Residuals are judged by Shapiro and Wilk at 5 %, each over the root mean square of its cell, as in [`compare`](crate::compare);
/// with factors of both kinds those within subjects and those of the subjects' means both have to pass.
///
/// # Errors
/// Those of the test chosen; [`StatsError::BadParameter`] if `alpha` is not between 0 and 1 or there is nothing to compare.
///
/// # Example
/// ```
/// use maveric_stats::{ByDesign, ChosenTest, DesignChoice, DesignColumns, compare_by_design};
/// let people: Vec<String> = (0..12).map(|i| i.to_string()).collect();
/// let vehicle: Vec<Option<String>> = (0..12).map(|i| Some(["car", "truck"][i % 2].to_owned())).collect();
/// let speed: Vec<Option<f64>> = (0..12).map(|i| Some(20.0 + (i % 2) as f64 + 0.1 * (i * i % 7) as f64)).collect();
/// let data = DesignColumns { subjects: &people, between: vec![("vehicle", &vehicle)], values: &speed, ..Default::default() };
/// let ByDesign::Groups(found) = compare_by_design(&data, &DesignChoice::default())? else { panic!("one factor between") };
/// assert_eq!(found.chosen, ChosenTest::WelchT);
/// assert!(found.reasons[0].starts_with("independent groups"));
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn compare_by_design(
    data: &DesignColumns<'_>,
    choice: &DesignChoice,
) -> Result<ByDesign, StatsError> {
    StatsError::between_0_and_1("alpha", choice.alpha)?;
    // Declared and not there is an error, whatever test comes.
    kept::products(data)?;
    if choice.test != AskedTest::Chosen || !data.periods.is_empty() {
        return period::with_period_or_declared(data, choice);
    }
    let with_covariate = |kind: &str, name: &str| {
        let (name, model) = (data.called(name), kept::model_of(data));
        kept::mixed(data, choice, vec![format!("{kind} ({name}): {model}")])
    };
    if let Some(name) = kept::varying(data)? {
        return with_covariate("a covariate that changes within subjects", name);
    }
    if let (true, Some((name, _))) = (data.within.is_empty(), data.covariates.first()) {
        return with_covariate("a covariate", name);
    }
    let mut reasons = Vec::new();
    if choice.missing == MissingCells::Mixed {
        match kept::subjects_with_gaps(data).len() {
            0 => {
                reasons
                    .push("no cell is missing, so nobody needs a mixed model to stay".to_owned());
            }
            who => {
                reasons.push(format!(
                    "{who} of the subjects have a missing cell and are kept: {}",
                    kept::model_of(data)
                ));
                return kept::mixed(data, choice, reasons);
            }
        }
    }
    match (&data.within[..], &data.between[..]) {
        ([(_, conditions)], []) if data.covariates.is_empty() => {
            one_factor::one_factor(data, conditions, choice, reasons)
        }
        ([], [(_, group)]) => groups::independent(data, group, choice, reasons),
        _ => factors::several(data, choice, reasons),
    }
}

/// Whether all checks of normality stand, and the words for it.
fn judged(checks: &[AssumptionCheck]) -> (bool, String) {
    let Some(failed) = checks.iter().find(|check| check.passed != Some(true)) else {
        let p = checks.iter().filter_map(|c| c.p);
        let words: Vec<String> = p.map(|p| apa::p(p).to_string()).collect();
        let words = words.join("; ");
        return (
            true,
            format!("normality of the standardised residuals is not rejected ({words})"),
        );
    };
    let what = failed.name.trim_start_matches("normality of ");
    let what = what.trim_end_matches(" (Shapiro-Wilk)");
    (false, normality_in_words(what, failed.p))
}

/// What a scale means where no model of ordered answers fits the design.
fn said_of_ordinal(choice: &DesignChoice, what: &str) -> Option<String> {
    (choice.scale == OutcomeScale::Ordinal).then(|| {
        format!("ordered answers, as asked, have a model of one factor within subjects alone: {what} instead")
    })
}

#[cfg(test)]
mod tests;
