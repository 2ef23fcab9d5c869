//! What is left out before anything is computed.

use crate::ids::{DriveId, ParticipantId};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, num::NonZeroUsize};

/// What is left out, and why; each rule is counted apart.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Exclude {
    /// Participant → reason: out of drives, answers, ratings, tests and tables alike.
    pub people: BTreeMap<ParticipantId, String>,
    /// Drive → reason: out with the answers after it.
    pub drives: BTreeMap<DriveId, String>,
    /// Drives that last less than so many seconds; none are left out for that where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drive_shorter_than_s: Option<f64>,
    /// People who gave one answer, and not the middle one, to every item of a questionnaire with items reversed and not.
    pub straight_lined: bool,
    /// People who gave another answer than was asked for to this many items that are there for attention, or more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attention_missed_at_least: Option<NonZeroUsize>,
    /// People with fewer conditions than this.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fewer_conditions_than: Option<usize>,
}

impl Exclude {
    /// Whether nothing is left out by name and no rule stands.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Whether a rule looks at what people answered.
    pub fn judges_answers(&self) -> bool {
        self.straight_lined || self.attention_missed_at_least.is_some()
    }

    /// Why a person is left out by name.
    pub fn person(&self, id: &ParticipantId) -> Option<&str> {
        self.people.get(id).map(String::as_str)
    }

    /// Why a drive is left out by name; a person's drives go with the person.
    pub fn drive(&self, drive: &DriveId, participant: &ParticipantId) -> Option<&str> {
        let named = self.drives.get(drive).map(String::as_str);
        named.or_else(|| self.person(participant))
    }
}
