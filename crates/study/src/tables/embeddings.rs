//! Fitted embeddings: a row a drive and fit.

use super::{Table, TableBuilder};
use crate::error::StudyError;
use maveric_domain::{Condition, DriveId, Embedding, ParticipantId, Study};
use std::path::Path;

/// One fitted embedding.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct EmbeddingRow {
    /// The drive it was fitted to.
    pub drive: DriveId,
    /// Its driver.
    pub participant: ParticipantId,
    /// The drive's study.
    pub study: Study,
    /// The style the drive shows.
    pub condition: Condition,
    /// Whether the ADB score took part in the fit.
    pub adb_used: bool,
    /// ADB score, in points, where there is one.
    pub adb: Option<f64>,
    /// Ŝ(w), in points; none for a model that saw no scores.
    pub adb_hat: Option<f64>,
    /// Position on the aggression line; none for a model that saw no scores.
    pub line_position: Option<f64>,
    /// Largest distance between the fits from different starts; none for training drives.
    pub start_spread: Option<f64>,
    /// Window rows used.
    pub rows: Option<usize>,
    /// The embedding.
    pub embedding: Embedding,
}

pub(super) fn with_coordinates(builder: TableBuilder, embeddings: &[&Embedding]) -> TableBuilder {
    let size = embeddings.first().map_or(0, |e| e.size());
    (0..size).fold(builder, |b, i| {
        b.numbers(
            &format!("w{}", i + 1),
            embeddings.iter().map(|e| Some(e.coordinates()[i])),
        )
    })
}

pub(super) fn read_coordinates(table: &Table) -> Result<Vec<Embedding>, StudyError> {
    let mut columns = Vec::new();
    while table.has(&format!("w{}", columns.len() + 1)) {
        columns.push(table.all_numbers(&format!("w{}", columns.len() + 1))?);
    }
    if columns.is_empty() {
        table.all_numbers("w1")?; // says which columns there are
    }
    (0..table.rows())
        .map(|row| Ok(Embedding::new(columns.iter().map(|c| c[row]).collect())?))
        .collect()
}

/// Writes embeddings, one row each; `w1`, `w2`, … are the coordinates.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_embeddings(path: &Path, rows: &[EmbeddingRow]) -> Result<(), StudyError> {
    let builder = TableBuilder::default()
        .text("drive", rows.iter().map(|r| r.drive.as_str()))
        .text("participant", rows.iter().map(|r| r.participant.as_str()))
        .text("study", rows.iter().map(|r| r.study.as_str()))
        .text("condition", rows.iter().map(|r| r.condition.as_str()))
        .flags("adb_used", rows.iter().map(|r| r.adb_used))
        .numbers("adb", rows.iter().map(|r| r.adb))
        .numbers("adb_hat", rows.iter().map(|r| r.adb_hat))
        .numbers("line_position", rows.iter().map(|r| r.line_position))
        .numbers("start_spread", rows.iter().map(|r| r.start_spread))
        .integers(
            "rows",
            rows.iter()
                .map(|r| r.rows.and_then(|n| i64::try_from(n).ok())),
        );
    let embeddings: Vec<&Embedding> = rows.iter().map(|r| &r.embedding).collect();
    with_coordinates(builder, &embeddings).write(path)
}

/// Reads embeddings back.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_embeddings(path: &Path) -> Result<Vec<EmbeddingRow>, StudyError> {
    let table = Table::read(path)?;
    let drive: Vec<DriveId> = table.ids("drive")?;
    let participant: Vec<ParticipantId> = table.ids("participant")?;
    let study: Vec<Study> = table.parsed("study")?;
    let condition: Vec<Condition> = table.parsed("condition")?;
    let adb_used: Vec<bool> = table.parsed("adb_used")?;
    let adb = table.numbers("adb")?;
    let adb_hat = table.numbers("adb_hat")?;
    let line_position = table.numbers("line_position")?;
    let start_spread = table.numbers("start_spread")?;
    let rows = table.numbers("rows")?;
    let embedding = read_coordinates(&table)?;
    Ok((0..table.rows())
        .map(|i| EmbeddingRow {
            drive: drive[i].clone(),
            participant: participant[i].clone(),
            study: study[i],
            condition: condition[i],
            adb_used: adb_used[i],
            adb: adb[i],
            adb_hat: adb_hat[i],
            line_position: line_position[i],
            start_spread: start_spread[i],
            rows: rows[i].map(|n| n as usize),
            embedding: embedding[i].clone(),
        })
        .collect())
}
