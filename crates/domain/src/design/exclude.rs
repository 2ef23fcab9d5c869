//! What is left out before anything is computed.

use crate::ids::{DriveId, ParticipantId};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, num::NonZeroUsize};

/// What is left out, and why; each rule is counted apart.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Exclude {
    /// Participant = reason: out of drives, answers, ratings, tests and tables alike.
    #[cfg_attr(feature = "schema", schemars(with = "BTreeMap<String, String>"))]
    pub people: BTreeMap<ParticipantId, String>,
    /// Drive = reason: out with the answers after it.
    #[cfg_attr(feature = "schema", schemars(with = "BTreeMap<String, String>"))]
    pub drives: BTreeMap<DriveId, String>,
    /// Drives that last less than so many seconds, from their first sample to their last, holes included; none are left out for that where it is not
    /// given.
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drive_shorter_than_s: Option<f64>,
    /// Whoever gave one answer, and not the middle one, to every item of a questionnaire with items reversed and not, of six answers or more.
    pub straight_lined: bool,
    /// Whoever gave another answer than was asked for to so many items with `expected`, or more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attention_missed_at_least: Option<NonZeroUsize>,
    /// Whoever drove, answered or was measured in fewer conditions, but in one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fewer_conditions_than: Option<usize>,
}

impl Exclude {
    /// Whether a rule looks at what people answered.
    pub fn judges_answers(&self) -> bool {
        self.straight_lined || self.attention_missed_at_least.is_some()
    }

    /// Why a person is left out by name.
    pub fn person(&self, id: &ParticipantId) -> Option<&str> {
        self.people.get(id).map(String::as_str)
    }
}
