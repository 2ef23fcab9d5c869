//! Embeddings that were fitted to drives.

use crate::{
    condition::ConditionId,
    embedding::Embedding,
    ids::{DriveId, ParticipantId},
};
use serde::Serialize;

/// One fitted embedding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EmbeddingRow {
    /// The drive it was fitted to.
    pub drive: DriveId,
    /// Its driver.
    pub participant: ParticipantId,
    /// The style the drive shows.
    pub condition: ConditionId,
    /// Whether the ADB score took part in the fit.
    pub adb_used: bool,
    /// ADB score, in points, where there is one.
    pub adb: Option<f64>,
    /// Ŝ(w), in points; none for a model that saw no scores.
    pub adb_hat: Option<f64>,
    /// Position on the aggression line; none for a model that saw no scores.
    pub line_position: Option<f64>,
    /// Events or rows that it was solved from; none for training drives.
    pub readings: Option<usize>,
    /// Its covariance, shape `(d, d)`, row by row; none for training drives, and where a drive is too short to tell.
    pub covariance: Option<Vec<f64>>,
    /// SD of `line_position`.
    pub line_position_se: Option<f64>,
    /// The embedding.
    pub embedding: Embedding,
}
