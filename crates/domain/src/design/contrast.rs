//! What is compared, and what was predicted.

use super::condition::{Condition, Sign};
use crate::condition::ConditionId;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Which conditions are compared with which.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Compare {
    /// Each with each other.
    #[default]
    All,
    /// Each with this one.
    Against(ConditionId),
    /// These, and no others.
    Pairs(Vec<[ConditionId; 2]>),
}

impl Compare {
    /// The pairs, in the order of the conditions.
    pub(crate) fn pairs(&self, conditions: &[Condition]) -> Vec<[ConditionId; 2]> {
        let ids = || conditions.iter().map(|c| c.id);
        match self {
            Self::All => ids()
                .enumerate()
                .flat_map(|(at, first)| ids().skip(at + 1).map(move |second| [first, second]))
                .collect(),
            Self::Against(one) => ids().filter(|c| c != one).map(|other| [*one, other]).collect(),
            Self::Pairs(pairs) => pairs.clone(),
        }
    }
}

/// What a contrast takes of a factor.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(untagged, expecting = "two levels, such as [\"calm\", \"sporty\"], or one")]
pub enum Levels {
    /// The first less the second.
    Pair([String; 2]),
    /// One alone.
    At(String),
}

impl Levels {
    /// Those that it names.
    pub fn named(&self) -> &[String] {
        match self {
            Self::Pair(pair) => pair,
            Self::At(level) => std::slice::from_ref(level),
        }
    }
}

/// A contrast of levels: factor → what it takes of it; every other factor is averaged.
pub type LevelContrast = BTreeMap<String, Levels>;

/// What a hypothesis says of its contrast, first minus second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Claim {
    /// It is above or below 0.
    Direction(Sign),
    /// It lies within these bounds.
    Equivalent([f64; 2]),
}

/// Something that was predicted.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypothesis {
    /// In words.
    pub says: String,
    /// Id of the outcome.
    pub outcome: String,
    /// First minus second.
    pub contrast: [ConditionId; 2],
    /// The rule that decides.
    pub claim: Claim,
}
