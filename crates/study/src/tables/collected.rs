//! What the seat collects beside answers and drives: what happened on every page and in every drive, what was agreed to, what was noted.
//! What the columns are `columns.toml` says.

pub use maveric_analysis::{ConsentRow, NotAdmitted, NotAgreed, Stopped};

use super::{
    Table, TableName,
    embeddings::{coordinates, read_coordinates},
    write_rows,
};
use crate::error::StudyError;
use maveric_domain::{ConditionId, Embedding, Lent, ParticipantId};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Something that happened on a page or in a drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// Reads the texts that were agreed to.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_consents(path: &Path) -> Result<Vec<ConsentRow>, StudyError> {
    #[derive(Deserialize)]
    struct Agreed {
        participant: ParticipantId,
        step: usize,
        text_sha256: String,
        at: Option<String>,
        style_lent: Option<bool>,
    }
    let table = Table::read(path)?;
    // Where nobody is asked there is no column `style_lent`.
    let agreed: Vec<Agreed> = table.records_beside(&table.absent(&["style_lent"]))?;
    let row = |row: Agreed| ConsentRow {
        participant: row.participant,
        step: row.step,
        text_sha256: row.text_sha256,
        at: row.at,
        style_lent: row.style_lent,
    };
    Ok(agreed.into_iter().map(row).collect())
}

/// What the experimenter noted, or was told by the seat.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NoteRow {
    pub at: Option<String>,
    pub participant: Option<ParticipantId>,
    pub by: String,
    pub text: String,
}

/// A style that was lent to somebody in the seat.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LentRow {
    pub participant: ParticipantId,
    pub condition: ConditionId,
    /// In a table its fields are columns of their own.
    pub lent: Lent,
    /// In a table its numbers are columns of their own.
    pub embedding: Embedding,
}

/// Writes the styles that were lent.
pub fn write_lent(path: &Path, rows: &[LentRow]) -> Result<(), StudyError> {
    let written = rows.iter().map(|row| (row, &row.lent, coordinates(&row.embedding)));
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

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PaymentRow {
    pub participant: ParticipantId,
    /// Their id on the platform.
    pub platform_id: String,
    /// How their part ended; none while it goes on.
    pub ended: Option<String>,
}

/// The seat's folder in the study's.
pub(crate) const SEAT: &str = "seat";
/// A file of the seat's folder.
pub const EVENTS: &str = "events.csv";
/// As [`EVENTS`].
pub const CONSENTS: &str = "consents.csv";
/// Where [`CONSENTS`] is, from the study's folder.
pub fn consents_of_study() -> PathBuf {
    Path::new(SEAT).join(CONSENTS)
}

/// As [`EVENTS`].
pub const NOTES: &str = "notes.csv";
/// As [`EVENTS`]; of its owner alone.
pub const PAYMENT: &str = "payment.csv";
/// The drives and rides that people stopped, from the study's folder.
pub const STOPPED: &str = "seat/stopped.csv";
/// How many people were not admitted, from the study's folder.
pub const NOT_ADMITTED: &str = "seat/not_admitted.csv";
/// How many people did not agree to the consent, from the study's folder.
pub const NOT_AGREED: &str = "seat/not_agreed.csv";
/// The styles that were lent, from the study's folder.
pub const LENT: &str = "seat/lent.csv";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_was_asked_for_their_style_and_who_was_not_come_back_from_one_table() {
        let row = |who: &str, style_lent| ConsentRow {
            participant: ParticipantId::new(who).unwrap(),
            step: 1,
            text_sha256: "aa".to_owned(),
            at: Some("2026-11-27T13:26:32Z".to_owned()),
            style_lent,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(CONSENTS);
        let mixed = [
            row("P001", None),
            row("P002", Some(true)),
            row("P003", None),
            row("P004", Some(false)),
            row("P005", None),
        ];
        write_rows(TableName::Consents, &path, &mixed).unwrap();
        assert_eq!(read_consents(&path).unwrap(), mixed);
        // Where nobody was asked there is no column.
        let nobody = [row("P001", None), row("P002", None)];
        write_rows(TableName::Consents, &path, &nobody).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(!text.contains("style_lent"), "{text}");
        assert_eq!(read_consents(&path).unwrap(), nobody);
    }
}
