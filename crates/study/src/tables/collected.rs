//! What the seat collects beside answers and drives: what happened on every page and in every drive, what was agreed to, what was noted.
//! What the columns are `columns.toml` says.

pub use maveric_analysis::{NotAdmitted, Stopped};

use super::{
    Table, TableName,
    embeddings::{coordinates, read_coordinates},
    write_rows,
};
use crate::error::StudyError;
use maveric_domain::{ConditionId, Embedding, Lent, ParticipantId};
use serde::{Deserialize, Serialize};
use std::path::Path;

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

/// A style that was lent to somebody in the seat.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "`columns.toml` says what they are")]
pub struct LentRow {
    pub participant: ParticipantId,
    pub condition: ConditionId,
    /// In a table its fields are columns of their own.
    pub lent: Lent,
    /// In a table its numbers are columns of their own.
    pub embedding: Embedding,
}

/// Writes the styles that were lent.
///
/// # Errors
/// As [`write_rows`].
pub fn write_lent(path: &Path, rows: &[LentRow]) -> Result<(), StudyError> {
    let written = rows
        .iter()
        .map(|row| (row, &row.lent, coordinates(&row.embedding)));
    write_rows(TableName::Lent, path, written)
}

/// Reads them back.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_lent(path: &Path) -> Result<Vec<LentRow>, StudyError> {
    #[derive(Deserialize)]
    struct Ridden {
        participant: ParticipantId,
        condition: ConditionId,
        embedding: Embedding,
    }
    let table = Table::read(path)?;
    table.each_once(&["participant", "condition"])?;
    let ridden: Vec<Ridden> = table.records_beside(&[("embedding", read_coordinates(&table)?)])?;
    let row = |(ridden, lent): (Ridden, Lent)| LentRow {
        participant: ridden.participant,
        condition: ridden.condition,
        lent,
        embedding: ridden.embedding,
    };
    Ok(ridden.into_iter().zip(table.records()?).map(row).collect())
}

/// Whom a platform pays.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PaymentRow {
    /// Who.
    pub participant: ParticipantId,
    /// Their id on the platform.
    pub platform_id: String,
    /// How their part ended; none while it goes on.
    pub ended: Option<String>,
}

/// Their files in the seat's folder.
pub const EVENTS: &str = "events.csv";
/// As [`EVENTS`].
pub const CONSENTS: &str = "consents.csv";
/// As [`EVENTS`].
pub const NOTES: &str = "notes.csv";
/// As [`EVENTS`]; of its owner alone.
pub const PAYMENT: &str = "payment.csv";
/// The drives and rides that people stopped, from the study's folder.
pub const STOPPED: &str = "seat/stopped.csv";
/// How many people were not admitted, from the study's folder.
pub const NOT_ADMITTED: &str = "seat/not_admitted.csv";
/// The styles that were lent, from the study's folder.
pub const LENT: &str = "seat/lent.csv";
