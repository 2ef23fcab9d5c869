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
    /// Largest distance between the fits from different starts; none for training drives.
    pub start_spread: Option<f64>,
    /// Window rows used.
    pub rows: Option<usize>,
    /// How well the drive determines it; none for training drives.
    pub details: Option<FitDetails>,
    /// The embedding.
    pub embedding: Embedding,
}

/// How well a drive determines an embedding that was fitted to it, coordinate by coordinate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitDetails {
    /// Standard error of each coordinate, `se1`, `se2`, …; none where the drive is too short to tell.
    pub standard_error: Vec<Option<f64>>,
    /// Spread of the fits from different starts along each coordinate, `spread1`, …, in SDs of the training embeddings.
    pub start_spread: Vec<Option<f64>>,
    /// M's amortised guess of each coordinate, `guess1`, …; none without M.
    pub amortized_guess: Vec<Option<f64>>,
    /// Standard error of `line_position`.
    pub line_position_se: Option<f64>,
    /// Independent rows that would say as much as the rows fitted to.
    pub effective_rows: Option<f64>,
}
