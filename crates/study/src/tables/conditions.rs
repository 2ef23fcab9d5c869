//! The AV conditions of each participant: where in style space the car should drive.

use super::{
    Table, TableBuilder,
    embeddings::{read_coordinates, with_coordinates},
};
use crate::error::StudyError;
use maveric_domain::{Condition, Embedding, ParticipantId};
use std::path::Path;

/// One participant in one condition.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ConditionRow {
    /// The participant.
    pub participant: ParticipantId,
    /// The condition.
    pub condition: Condition,
    /// Ŝ at the embedding, in points.
    pub adb_hat: f64,
    /// How far Ŝ moved from the participant's own, in points, after clamping.
    pub moved_points: f64,
    /// Angle on the perpendicular ellipse, in rad; only there.
    pub angle_rad: Option<f64>,
    /// Whether the embedding lies further out than any training driver's.
    pub beyond_training: bool,
    /// The embedding.
    pub embedding: Embedding,
}

/// Writes conditions, one row each.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_conditions(path: &Path, rows: &[ConditionRow]) -> Result<(), StudyError> {
    let builder = TableBuilder::default()
        .text("participant", rows.iter().map(|r| r.participant.as_str()))
        .text("condition", rows.iter().map(|r| r.condition.as_str()))
        .numbers("adb_hat", rows.iter().map(|r| Some(r.adb_hat)))
        .numbers("moved_points", rows.iter().map(|r| Some(r.moved_points)))
        .numbers("angle_rad", rows.iter().map(|r| r.angle_rad))
        .flags("beyond_training", rows.iter().map(|r| r.beyond_training));
    let embeddings: Vec<&Embedding> = rows.iter().map(|r| &r.embedding).collect();
    with_coordinates(builder, &embeddings).write(path)
}

/// Reads conditions back.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_conditions(path: &Path) -> Result<Vec<ConditionRow>, StudyError> {
    let table = Table::read(path)?;
    let participant: Vec<ParticipantId> = table.ids("participant")?;
    let condition: Vec<Condition> = table.parsed("condition")?;
    let adb_hat = table.all_numbers("adb_hat")?;
    let moved_points = table.all_numbers("moved_points")?;
    let angle_rad = table.numbers("angle_rad")?;
    let beyond_training: Vec<bool> = table.parsed("beyond_training")?;
    let embedding = read_coordinates(&table)?;
    Ok((0..table.rows())
        .map(|i| ConditionRow {
            participant: participant[i].clone(),
            condition: condition[i],
            adb_hat: adb_hat[i],
            moved_points: moved_points[i],
            angle_rad: angle_rad[i],
            beyond_training: beyond_training[i],
            embedding: embedding[i].clone(),
        })
        .collect())
}
