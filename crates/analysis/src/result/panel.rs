//! One outcome over the conditions, with the contrasts of these.

use super::by_factor::ByFactor;
use crate::balance::Balance;
use maveric_domain::{ConditionId, design::Sign};
use maveric_stats::{ByDesign, CarryOver, Effect};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A group of people, as the design's factors divide them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Group {
    /// The factor, or several joined by ×.
    pub factor: String,
    /// The level of this group.
    pub level: String,
    /// What pages call it.
    pub label: String,
}

/// One outcome over the conditions.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Panel {
    /// Code name of the measure, or `SCALE.SUBSCALE`.
    pub outcome: String,
    /// Name for people.
    pub title: String,
    /// Unit of the values; empty for counts and shares.
    pub unit: String,
    /// Whether it was measured; else people were asked.
    pub measured: bool,
    /// Value that means "the same as my own", where there is one.
    pub same: Option<f64>,
    /// Lowest and highest value that there can be, of a score.
    pub range: Option<(f64, f64)>,
    /// The values are differences from this drive; none where they are what was measured or answered.
    pub differences_from: Option<ConditionId>,
    /// Whose they are; none where they are everybody's. Where the design divides people, a panel of each group follows that of everybody.
    pub group: Option<Group>,
    /// The columns of `rows`.
    pub conditions: Vec<ConditionId>,
    /// A participant each.
    pub participants: Vec<String>,
    /// A row a participant, a column a condition.
    pub rows: Vec<Vec<Option<f64>>>,
    /// Participants in the test.
    pub n: usize,
    /// Participants left out for a missing value, for an order that is not known, or for a factor or a covariate of which they have none.
    pub dropped: Vec<String>,
    /// Those of them whose order is not known, where the test takes the period.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub without_order: Vec<String>,
    /// Those of them who have no value of a factor or a covariate that the test takes, each with its column; whose order is not known
    /// is not among them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub without_column: BTreeMap<String, String>,
    /// The test of the contrasts; none where nothing could be tested.
    pub test: Option<ContrastTest>,
    /// Why this test, a sentence a step.
    pub reasons: Vec<String>,
    /// The test that the design calls for, with every check that was made: over the conditions, and between people where it divides
    /// them and this panel is of everybody.
    pub comparison: Option<ByDesign>,
    /// How even the orders of those in the test are, where it takes the period.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub balance: Option<Balance>,
    /// The model with first-order carry-over, where the test takes the period: a look at how much rests on there being none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carry_over: Option<CarryOver>,
    /// The declared contrasts: one family over everybody, and one over all groups of this outcome.
    pub contrasts: Vec<Contrast>,
    /// Means, simple effects and declared contrasts of the factors' levels, where everybody was tested by several factors; the means alone
    /// where groups of people are compared with one another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_factor: Option<ByFactor>,
}

impl Panel {
    /// How many are not in the test for a missing value alone.
    pub fn lacking(&self) -> usize {
        let lacks = |who: &&String| {
            !self.without_order.contains(who) && !self.without_column.contains_key(*who)
        };
        self.dropped.iter().filter(lacks).count()
    }
}

/// The test of a panel's contrasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContrastTest {
    /// Paired t tests.
    T,
    /// Wilcoxon's signed ranks.
    Wilcoxon,
    /// Differences of a mixed model's means, each over its own error where everybody has every condition, by Satterthwaite's degrees of freedom.
    Mixed,
    /// Differences of an ordinal model's coefficients, by t.
    Ordinal,
}

/// Degrees of freedom: whole numbers but of a model.
#[expect(clippy::ref_option, reason = "as serde calls it")]
fn degrees<S: serde::Serializer>(df: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match *df {
        Some(df) if df.fract().abs() > 0.0 => serializer.serialize_f64(df),
        Some(df) => serializer.serialize_u64(df as u64),
        None => serializer.serialize_none(),
    }
}

/// Two conditions of a panel held against each other.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Contrast {
    /// First condition.
    pub first: ConditionId,
    /// Second condition; the difference is first minus second.
    pub second: ConditionId,
    /// Which way the difference is expected to lie.
    pub expected: Option<Sign>,
    /// People whose first value lies above the second, at it, and below it.
    pub people: [usize; 3],
    /// Mean of first minus second, in the unit of the panel.
    pub mean_difference: Option<f64>,
    /// t or W+ of the test.
    pub statistic: Option<f64>,
    /// Degrees of freedom of a t.
    #[serde(serialize_with = "degrees")]
    pub df: Option<f64>,
    /// Standard error of the mean difference, of a mixed model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub se: Option<f64>,
    /// Ends of the 95 % interval of the mean difference, of a mixed model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval: Option<(f64, f64)>,
    /// Effect size with its interval.
    pub effect: Option<Effect>,
    /// p value, two-sided.
    pub p: Option<f64>,
    /// Adjusted after Holm over the contrasts of the outcome.
    pub p_holm: Option<f64>,
    /// What the test is of, where the order of answers alone counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub odds: Option<Odds>,
    /// The odds grow without bound, as where everybody gives the lowest answer in one of the two: the likelihood ratio is tested in their
    /// place, and the statistic is its signed root.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub unbounded: bool,
}

/// The odds that one person's answer lies higher in the first condition, over those in the second: 1 is no difference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Odds {
    /// First over second.
    pub ratio: f64,
    /// Ends of its 95 % interval.
    pub interval: Option<(f64, f64)>,
}

impl Odds {
    /// Of a difference of logits with the ends of its interval; none where a number cannot hold it.
    pub(crate) fn of_logits(difference: f64, ends: Option<(f64, f64)>) -> Option<Self> {
        let odds = |logit: f64| Some(libm::exp(logit)).filter(|odds| odds.is_normal());
        Some(Self {
            ratio: odds(difference)?,
            interval: ends.and_then(|(low, high)| odds(low).zip(odds(high))),
        })
    }

    /// Second over first.
    pub(crate) fn turned(self) -> Self {
        Self {
            ratio: 1.0 / self.ratio,
            interval: self.interval.map(|(low, high)| (1.0 / high, 1.0 / low)),
        }
    }
}
