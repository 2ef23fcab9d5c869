//! What is measured, and what the dial turns.

use super::condition::Sign;
use crate::{condition::ConditionId, survey::subscale::without_items};
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// A score: `SCALE.SUBSCALE`.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
#[cfg_attr(feature = "schema", schemars(extend("pattern" = r"^[^.]+\.[^.]+$")))]
pub struct ScoreName {
    /// Code name of the scale.
    pub scale: String,
    /// Code name of the subscale.
    pub subscale: String,
}

impl fmt::Display for ScoreName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.scale, self.subscale)
    }
}

impl FromStr for ScoreName {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('.') {
            Some((scale, subscale))
                if !scale.is_empty() && !subscale.is_empty() && !subscale.contains('.') =>
            {
                Ok(Self { scale: scale.to_owned(), subscale: subscale.to_owned() })
            }
            _ => Err(format!("found `{text}`, expected SCALE.SUBSCALE, such as `adb.total`")),
        }
    }
}

crate::as_text::as_text!(ScoreName);

/// What an outcome is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Quantity {
    /// An objective measure, by its column.
    Measure(String),
    /// A score of what was answered after a condition.
    Score(ScoreName),
}

/// The test of an outcome, as its design declares it.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DeclaredTest {
    /// Chosen by what the data look like, without the period in which a condition was met.
    Auto,
    /// Mixed model of the condition, and of the period where orders are known, with the person at random.
    Mixed,
    /// Cumulative logit of the same.
    Ordinal,
    /// Analysis of variance and paired t tests.
    RmAnova,
    /// Friedman's test and Wilcoxon's.
    Friedman,
}

/// Something that is tested.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// What it is.
    pub quantity: Quantity,
    /// On the page, where it was given.
    pub label: Option<String>,
    /// Differences of at most this much count as none, in the unit of the page; half a standard deviation between people without.
    pub same_within: Option<f64>,
    /// Its test; without one the choice is the design's: with the period where orders are known, else by what the data look like.
    pub test: Option<DeclaredTest>,
    /// The contrast that decides, first less second: the outcome is then primary, and its test is declared.
    pub primary: Option<[ConditionId; 2]>,
    /// Items of the score that name what the conditions turn: everything is tested once more without them. Empty: no such item.
    pub drop_items: Vec<u32>,
}

impl Outcome {
    /// The score without the items that name what the conditions turn; none where there are no such items.
    pub fn score_without_items(&self) -> Option<ScoreName> {
        match &self.quantity {
            Quantity::Score(name) if !self.drop_items.is_empty() => Some(ScoreName {
                scale: name.scale.clone(),
                subscale: without_items(&name.subscale, &self.drop_items),
            }),
            _ => None,
        }
    }

    /// The measure's column, or `SCALE.SUBSCALE`.
    pub fn id(&self) -> String {
        match &self.quantity {
            Quantity::Measure(id) => id.clone(),
            Quantity::Score(name) => name.to_string(),
        }
    }
}

/// What the dial turns.
#[derive(Debug, Clone, PartialEq)]
pub struct Style {
    /// The score, asked before the drives.
    pub score: ScoreName,
    /// On the page.
    pub label: String,
    /// Lowest and highest score; the range of the scale's file without.
    pub range: Option<[f64; 2]>,
    /// A step of the dial, in points.
    pub points: Option<f64>,
    /// Which way a more aggressive driver scores: up without a word, down on a score of calmness.
    pub aggression: Sign,
}

/// Which traits are set against which ratings: one family, declared before looking.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Homophily {
    /// Scales, or `SCALE.SUBSCALE`, asked before the drives.
    pub factors: Vec<String>,
    /// Scores of the conditions.
    pub ratings: Vec<ScoreName>,
    /// The score by which people say how similar a drive is to their own: set against each rating.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub similarity: Option<ScoreName>,
}
