//! What the seat collects beside answers and drives: what happened on every page and in every drive, what was agreed to, what was noted.

use maveric_domain::ParticipantId;
use serde::{Deserialize, Serialize};

/// Something that happened on a page or in a drive: a row of `events.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EventRow {
    /// To whom.
    pub participant: ParticipantId,
    /// Number of the step, from 1.
    pub step: usize,
    /// `consent`, the id of a scale, `practice`, the label of a drive, `end`.
    pub page: String,
    /// Of a scale: `pre`, or the condition it was asked after.
    pub moment: Option<String>,
    /// Of a drive: how often it had been begun, from 1.
    pub attempt: Option<u32>,
    /// In a drive: time since its beginning, in s.
    pub time_s: Option<f64>,
    /// What: `answered`, `agreed`, `begun`, `uncomfortable`, `dial`, `hidden`, …
    pub what: String,
    /// Time on a page in s; of the dial where it was turned to, in points.
    pub value: Option<f64>,
    /// When, in UTC; not of what happened in a drive, whose beginning is known.
    pub at: Option<String>,
}

/// A text that was agreed to: a row of `consents.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConsentRow {
    /// By whom.
    pub participant: ParticipantId,
    /// Number of the step, from 1.
    pub step: usize,
    /// Hash of the text as it was shown.
    pub text_sha256: String,
    /// When, in UTC; nothing where it is given away.
    pub at: Option<String>,
}

/// What the experimenter noted, or was told by the seat: a row of `notes.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NoteRow {
    /// When, in UTC; nothing where it is given away.
    pub at: Option<String>,
    /// Whom the seat says something of; nobody in a note.
    pub participant: Option<ParticipantId>,
    /// `experimenter` or `seat`.
    pub by: String,
    /// What.
    pub text: String,
}

/// Their files in the seat's folder.
pub const EVENTS: &str = "events.csv";
/// As [`EVENTS`].
pub const CONSENTS: &str = "consents.csv";
/// As [`EVENTS`].
pub const NOTES: &str = "notes.csv";
