//! What the seat collects beside answers and drives: what happened on every page and in every drive, what was agreed to, what was noted.
//! What the columns are `columns.toml` says.

pub use maveric_analysis::{NotAdmitted, Stopped};

use maveric_domain::ParticipantId;
use serde::{Deserialize, Serialize};

/// Something that happened on a page or in a drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "`columns.toml` says what they are")]
pub struct EventRow {
    pub participant: ParticipantId,
    pub step: usize,
    pub page: String,
    pub moment: Option<String>,
    pub attempt: Option<u32>,
    pub time_s: Option<f64>,
    pub what: String,
    pub value: Option<f64>,
    pub at: Option<String>,
}

/// A text that was agreed to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "`columns.toml` says what they are")]
pub struct ConsentRow {
    pub participant: ParticipantId,
    pub step: usize,
    pub text_sha256: String,
    pub at: Option<String>,
}

/// What the experimenter noted, or was told by the seat.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "`columns.toml` says what they are")]
pub struct NoteRow {
    pub at: Option<String>,
    pub participant: Option<ParticipantId>,
    pub by: String,
    pub text: String,
}

/// Their files in the seat's folder.
pub const EVENTS: &str = "events.csv";
/// As [`EVENTS`].
pub const CONSENTS: &str = "consents.csv";
/// As [`EVENTS`].
pub const NOTES: &str = "notes.csv";
/// The drives and rides that people stopped, from the study's folder.
pub const STOPPED: &str = "seat/stopped.csv";
/// How many people were not admitted, from the study's folder.
pub const NOT_ADMITTED: &str = "seat/not_admitted.csv";
