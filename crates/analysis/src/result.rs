//! What the analyses of a study give: everything that a figure, a table or a claim is made from.

mod by_factor;
mod correlation;
mod decided;
mod panel;
mod ratings;
mod style;

pub use by_factor::{ByFactor, FactorContrast, LevelMean, TestedFactor};
pub use correlation::Correlation;
pub use decided::{Judged, PrimaryOutcome};
pub use panel::{Contrast, ContrastTest, Group, Odds, Panel};
pub use ratings::{
    Above, CongruenceCurve, CongruenceRow, HomophilyRow, MixedRow, PerceivedStyle, Preference,
    SimilarityRow,
};
pub use style::{AggressionLine, Bias, Kept, LineRow, Nearer, Reproduction};

use crate::{
    balance::OrderBalance, finding::Finding, flow::Flow, lent::BesideLent,
    other_choice::Sensitivity, presses::Presses, retest::Repeats, which::WhichRide,
};
use maveric_domain::ConditionId;
use serde::{Deserialize, Serialize};

/// Every analysis of one study, as its design asks for it (method section 9).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Analysis {
    /// Whether the people are made up.
    pub synthetic: bool,
    /// Whether a script drove in place of a person.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub scripted: bool,
    /// People analysed.
    pub participants: usize,
    /// Those of them of whom nothing is there in some condition.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub partly: Vec<String>,
    /// How many there were at each step, and who was left out.
    pub flow: Flow,
    /// How evenly the conditions stand in the orders in which people met them; none where no order is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orders: Option<OrderBalance>,
    /// The primary outcomes in the order written, each tested if all before it were below .05.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub primary: Vec<PrimaryOutcome>,
    /// Outcomes by another choice than the one that decides.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensitivity: Vec<Sensitivity>,
    /// The hypotheses of the design, judged by their rules.
    pub hypotheses: Vec<Judged>,
    /// What became of each question that the study asks, in the order in which a reader asks; a page words them.
    pub findings: Vec<Finding>,
    /// 9.1, with the score in the fit of the embedding, as the paper does it; none without a style.
    pub line: Option<AggressionLine>,
    /// 9.1, fitted without the score: what driving alone tells.
    pub line_without_adb: Option<AggressionLine>,
    /// 9.2, a row a measure; empty without a condition at 0 on the dial, or without a baseline.
    pub reproduction: Vec<Reproduction>,
    /// Every outcome, every rating and what the drives met on their road, by condition, the baseline first.
    pub descriptives: Vec<Described>,
    /// 9.3, a panel an outcome, then one a group of people where the design divides them.
    pub panels: Vec<Panel>,
    /// 9.3, is the car at 0 on the dial nearer to the baseline than the others are?
    pub nearer: Vec<Nearer>,
    /// 9.4, a row a measure that aggression does not move; empty where no car moves across the dial.
    pub kept: Vec<Kept>,
    /// Each rating over the distance from the own style; empty with fewer than three places on the dial.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub congruence: Vec<CongruenceRow>,
    /// 9.5, a row a pair of factor and rating difference; empty where none was declared.
    pub homophily: Vec<HomophilyRow>,
    /// 9.5, perceived similarity against the ratings, over all answers.
    pub similarity: Vec<SimilarityRow>,
    /// 9.5, each rating on the shift of the dial, with people as random effects.
    pub mixed: Vec<MixedRow>,
    /// 9.5, who preferred another style to their own.
    pub preferences: Vec<Preference>,
    /// What people pressed during the rides; none where nothing could be pressed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub presses: Option<Presses>,
    /// Several sessions and rides; none where the design has one of each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeats: Option<Repeats>,
    /// The own style beside somebody else's of the same score, a condition with such a style a row.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lent: Vec<BesideLent>,
    /// Whether people tell which of two rides was in their own style; none where they are not asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub which: Option<WhichRide>,
    /// Share of embeddings away from 0 on the dial that lie further out than any training driver's.
    pub beyond_training: Option<f64>,
    /// What the design asks for and this analysis does in another way, or not at all, in sentences.
    pub notes: Vec<String>,
    /// Who or what was left out of an analysis, and why.
    pub exclusions: Vec<Exclusion>,
    /// Those analysed of whom nothing of the baseline is there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub without_baseline: Vec<String>,
    /// Those analysed who answered no questionnaire about a condition.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub without_answer: Vec<String>,
}

/// An outcome or a rating in one condition, or in the baseline drive.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Described {
    /// Code name of the measure, or `SCALE.SUBSCALE`.
    pub outcome: String,
    /// Name for people.
    pub title: String,
    /// Unit of the values; empty for counts and shares.
    pub unit: String,
    /// The condition, or the baseline, in which the values were taken.
    pub condition: ConditionId,
    /// People with a value.
    pub n: usize,
    /// Arithmetic mean.
    pub mean: Option<f64>,
    /// Standard deviation over people, over n − 1.
    pub sd: Option<f64>,
    /// Median over people; none without values.
    pub median: Option<f64>,
}

/// Who or what was left out.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Exclusion {
    /// The participant or drive.
    pub who: String,
    /// The analysis.
    pub what: String,
    /// The reason.
    pub why: String,
}
