//! What a design called for, and what was found.

use serde::{Deserialize, Serialize};

use super::effects::EffectTest;
use crate::{
    AssumptionCheck, Comparison, Factorial, Friedman, GroupsAnalysis, MarginalContrast, Named,
    Ordinal, RandomIntercept, Reasons, Wilcoxon, numerics::distributions::f_upper,
};

/// Name of the factor of the place in which a subject met a condition.
pub const PERIOD: &str = "period";

/// The test that a design calls for, where it is not one factor within subjects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ChosenTest {
    /// F of each effect of several factors, or of one with covariates.
    Factorial,
    /// Rank tests of the same effects.
    Ranks,
    /// Welch's t of two groups.
    WelchT,
    /// Mann and Whitney's test of two groups.
    MannWhitney,
    /// Welch's analysis of variance of several groups.
    WelchAnova,
    /// Kruskal and Wallis' test of several groups.
    KruskalWallis,
    /// Mixed model.
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

/// A factorial analysis, and the test that decides about each effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactorialFinding {
    /// The plain analysis of variance with its means, contrasts and simple effects, covariances pooled and without covariates. Those by the
    /// tests that count are [`FollowUp`](super::FollowUp).
    #[serde(flatten)]
    pub anova: Factorial,
    /// Each effect's test, covariates last: these count.
    pub tests: Named<EffectTest>,
}

/// A mixed model, and its tests within subjects without the assumption that all cells covary alike.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MixedFinding {
    /// The model.
    #[serde(flatten)]
    pub model: RandomIntercept,
    /// Terms with more than one degree of freedom within subjects, by Greenhouse and Geisser's ε of the complete subjects: these count.
    pub corrected: Named<CorrectedTerm>,
    /// The pairs of each term of factors over an error of their own each, cluster-robust with Bell and McCaffrey's degrees of freedom: these
    /// count before those of the model, of two levels too. Without p where a pair has no such error; none where each subject has a single row.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub own_error: Named<Named<MarginalContrast>>,
}

/// A term of a mixed model with its degrees of freedom times ε.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CorrectedTerm {
    /// Greenhouse and Geisser's ε.
    pub epsilon: f64,
    /// Degrees of freedom of the term.
    pub df1: f64,
    /// Satterthwaite's degrees of freedom.
    pub df2: f64,
    /// P(F' ≥ F).
    pub p: f64,
}

impl MixedFinding {
    /// p of a term, corrected where it has to be.
    pub fn p(&self, term: &str) -> Option<f64> {
        match self.corrected.get(term) {
            Some(corrected) => Some(corrected.p),
            None => self.model.anova.get(term)?.p,
        }
    }

    /// The pairs of a term that count; `None` of an unknown term.
    pub fn pairs(&self, term: &str) -> Option<&Named<MarginalContrast>> {
        let own_error = self.own_error.get(term);
        own_error.or_else(|| self.model.contrast.get(term))
    }
}

/// An ordinal model, and the rank test of the same subjects beside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OrdinalFinding {
    /// The model.
    #[serde(flatten)]
    pub model: Ordinal,
    /// The conditions, as few subjects ask; `None` without a likelihood ratio or without degrees of freedom.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub small_sample: Option<SmallSample>,
    /// The periods, held against F as the conditions are; `None` without periods.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period: Option<SmallSample>,
    /// Every pair of conditions with the period taken out, on the scale of the logit, by t with the degrees of freedom within subjects that
    /// the model leaves; empty without periods.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub contrast: Named<MarginalContrast>,
    /// The likelihood ratio of every pair of conditions that has no finite difference, as where everybody gives the same extreme answer in
    /// one of them, with the period taken out and held against F as the conditions are.
    #[serde(default, skip_serializing_if = "Named::is_empty")]
    pub ratio: Named<SmallSample>,
    /// The rank test of the complete subjects, as a check; `None` where too few are complete, or with periods, which ranks do not take out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beside: Option<RankCheck>,
}

/// A likelihood ratio held against F in place of chi-squared, which finds too much where subjects are few.
///
/// # Source
/// The ratio over its degrees of freedom against F with those and the degrees of freedom within subjects that the model leaves
/// (rows less subjects less `df1`), as in Wald's F tests; ours for cumulative logits: how often it errs is counted in the crate's README.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SmallSample {
    /// The ratio over `df1`.
    #[serde(rename = "F")]
    pub f: f64,
    /// Conditions less 1.
    pub df1: usize,
    /// Rows less subjects less `df1`.
    pub df2: usize,
    /// P(F ≥ `f`).
    pub p: f64,
}

impl SmallSample {
    pub(super) fn from_model(model: &Ordinal) -> Option<Self> {
        let lr = &model.quadrature.lr;
        Self::of_ratio(model, lr.chi2?, lr.df, 0)
    }

    /// A ratio of `df1` degrees of freedom beside `other` coefficients more.
    pub(super) fn of_ratio(model: &Ordinal, chi2: f64, df1: usize, other: usize) -> Option<Self> {
        let df2 = model.n_obs.checked_sub(model.n_subjects + df1 + other)?;
        if df1 == 0 || df2 == 0 {
            return None;
        }
        let f = chi2 / df1 as f64;
        let p = f_upper(f, df1 as f64, df2 as f64);
        Some(Self { f, df1, df2, p })
    }
}

/// The rank tests beside an ordinal model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RankCheck {
    /// Complete subjects.
    pub n: usize,
    /// Subjects left out of the rank tests because a cell is missing.
    pub left_out: Vec<String>,
    /// Of all conditions.
    pub friedman: Friedman,
    /// Of each pair, corrected by Holm.
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
    Mixed(Box<Chosen<MixedFinding>>),
    /// Ordered answers.
    Ordinal(Box<Chosen<OrdinalFinding>>),
}

impl ByDesign {
    /// Why this test, one sentence a step.
    pub fn reasons(&self) -> &[String] {
        self.reasons_and_checks().0
    }

    /// Every check that was made.
    pub fn checks(&self) -> &[AssumptionCheck] {
        self.reasons_and_checks().1
    }

    fn reasons_and_checks(&self) -> (&[String], &[AssumptionCheck]) {
        match self {
            Self::OneFactor(comparison) => (&comparison.reasons[..], &comparison.checks[..]),
            Self::Factorial(chosen) => (&chosen.reasons[..], &chosen.checks[..]),
            Self::Groups(chosen) => (&chosen.reasons[..], &chosen.checks[..]),
            Self::Mixed(chosen) => (&chosen.reasons[..], &chosen.checks[..]),
            Self::Ordinal(chosen) => (&chosen.reasons[..], &chosen.checks[..]),
        }
    }

    /// The comparison of one factor within subjects, if that is what it is.
    pub fn one_factor(&self) -> Option<&Comparison> {
        match self {
            Self::OneFactor(comparison) => Some(comparison),
            _ => None,
        }
    }

    /// p of each effect by its name; of one factor, of groups and of answers without periods the single one is `omnibus`.
    pub fn effects(&self) -> Vec<(&str, Option<f64>)> {
        match self {
            Self::OneFactor(comparison) => vec![("omnibus", comparison.omnibus.p)],
            Self::Factorial(chosen) => {
                let tests = chosen.found.tests.iter();
                tests.map(|(name, test)| (name, test.p)).collect()
            }
            Self::Groups(chosen) => vec![("omnibus", group_p(chosen.chosen, &chosen.found))],
            Self::Mixed(chosen) => {
                let terms = chosen.found.model.anova.iter();
                terms.map(|(name, _)| (name, chosen.found.p(name))).collect()
            }
            Self::Ordinal(chosen) => {
                let p = chosen.found.small_sample.as_ref().map(|test| test.p);
                match &chosen.found.period {
                    None => vec![("omnibus", p)],
                    Some(period) => vec![("conditions", p), (PERIOD, Some(period.p))],
                }
            }
        }
    }
}

fn group_p(chosen: ChosenTest, groups: &GroupsAnalysis) -> Option<f64> {
    let several = groups.several.as_ref();
    match chosen {
        ChosenTest::WelchT => groups.welch_t.values().next()?.p,
        ChosenTest::MannWhitney => groups.mann_whitney.values().next()?.p,
        ChosenTest::WelchAnova => several?.welch_anova.p,
        _ => several?.kruskal.p,
    }
}
