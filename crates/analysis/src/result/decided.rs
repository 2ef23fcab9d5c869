//! What was declared before the data and decides: primary outcomes and hypotheses.

use super::Odds;
use crate::verdict::Verdict;
use maveric_domain::{
    ConditionId,
    design::{DeclaredTest, Sign},
};
use serde::{Deserialize, Serialize};

/// What became of a primary outcome.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PrimaryOutcome {
    /// Id of the outcome.
    pub outcome: String,
    /// Name for people.
    pub title: String,
    /// Unit of the difference; empty for counts and shares.
    pub unit: String,
    /// First condition of the contrast that decides.
    pub first: ConditionId,
    /// Second; the difference is first minus second.
    pub second: ConditionId,
    /// The declared test.
    pub test: DeclaredTest,
    /// People in it.
    pub n: usize,
    /// The outcome before it at which the gate closed: then there is neither p nor verdict.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closed_by: Option<String>,
    /// Mean difference, of a mixed model with the period taken out; as it was measured where there is no test.
    pub mean_difference: Option<f64>,
    /// Ends of its 95 % interval, of a mixed model.
    pub interval: Option<(f64, f64)>,
    /// What p is of, where the order of answers alone counts.
    pub odds: Option<Odds>,
    /// Whether p is of the likelihood ratio, as the odds grow without bound.
    pub unbounded: bool,
    /// p of the contrast, two-sided, not adjusted: it is the only one that decides.
    pub p: Option<f64>,
    /// Whether p is below α.
    pub verdict: Verdict,
    /// Why there is no p, where it cannot be tested.
    pub why_not: Option<String>,
}

/// A hypothesis of the design, judged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// In words, as declared.
    pub says: String,
    /// Id of the outcome.
    pub outcome: String,
    /// First condition of the contrast.
    pub first: ConditionId,
    /// Second; the difference is first minus second.
    pub second: ConditionId,
    /// The rule, in words.
    pub rule: String,
    /// What became of it.
    pub verdict: Verdict,
    /// People whom the tests of the outcome are of: those with a value of every condition.
    pub n: usize,
    /// Mean of first minus second, in the unit of the panel.
    pub mean_difference: Option<f64>,
    /// Ends of the interval of that mean: 95 %; of a claim that the two are the same 90 %, which lies within the bounds where both one-sided
    /// tests are below .05. None where `p` is of odds.
    pub interval: Option<(f64, f64)>,
    /// What `p` is of, where the order of answers alone counts.
    pub odds: Option<Odds>,
    /// Which way the difference is claimed to lie; none of a claim that the two are the same.
    pub expected: Option<Sign>,
    /// Bounds within which the two count as the same, of a claim that they are.
    pub bounds: Option<(f64, f64)>,
    /// The p by which it is shown: of the contrast, or the larger of the two one-sided tests.
    pub p: Option<f64>,
    /// Whether `p` is adjusted after Holm over the contrasts of the outcome; else it is of this contrast alone.
    pub holm: bool,
    /// Of a claim that the two are the same: the p by which it fails, that the difference lies outside the bounds.
    pub p_outside: Option<f64>,
    /// Whether `p` is of the likelihood ratio, as the odds grow without bound.
    pub unbounded: bool,
    /// Why there is no p, where it cannot be tested.
    pub why_not: Option<String>,
}
