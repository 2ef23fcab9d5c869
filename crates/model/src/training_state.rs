//! A training that can go on where it stopped: everything an epoch starts from, as bytes.
//!
//! Weights and moments are written as their bits, so that a training that goes on gives the bytes of one that was
//! never stopped. Every draw of an epoch comes from a stream of that epoch, so no generator is part of the state.

use crate::{checkpoint, error::ModelError, quality::Quality, train::EpochReport};
use serde::{Deserialize, Serialize};

/// Version of the format.
const VERSION: u32 = 1;
const MAGIC: &str = "maveric-training";

/// Where a training stands after an epoch; see [`crate::train_resumable`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingState {
    /// Of settings, seed and data: a state goes on with the same only.
    pub(crate) fingerprint: u64,
    /// What the run with validation said, once it is over.
    pub(crate) selection: Option<Selection>,
    pub(crate) weights: Weights,
    /// Moments of the weights and of the embeddings.
    pub(crate) moments: [Moments; 2],
    pub(crate) epochs: Vec<EpochReport>,
    pub(crate) best: Option<Best>,
}

/// What the run that kept the last part of every drive for validation found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Selection {
    /// Its epochs, with their losses on validation rows.
    pub epochs: Vec<EpochReport>,
    /// The epoch whose weights were kept, from 1: the one with the lowest validation loss where stopping early was
    /// asked for, else the last.
    pub kept_epoch: usize,
    /// Whether it stopped before the last epoch, the loss having not improved for `patience` epochs.
    pub stopped_early: bool,
    /// Rows learned from.
    pub training_rows: usize,
    /// Rows kept back.
    pub validation_rows: usize,
    /// How good the predictions for those were, with the weights of `kept_epoch`.
    pub quality: Quality,
}

/// Weights and embeddings, as bits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Weights {
    pub(crate) packed: Bits,
    pub(crate) embeddings: Bits,
}

/// Adam's moments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Moments {
    pub(crate) first: Bits,
    pub(crate) second: Bits,
    pub(crate) steps: i32,
}

/// The epoch with the lowest validation loss so far.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Best {
    pub(crate) epoch: usize,
    pub(crate) total: f64,
    pub(crate) weights: Weights,
}

/// Numbers as their bits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Bits(Vec<u32>);

impl From<&[f32]> for Bits {
    fn from(values: &[f32]) -> Self {
        Self(values.iter().map(|v| v.to_bits()).collect())
    }
}

impl Bits {
    /// Writes the numbers to `to`, if they are as many and all finite.
    pub(crate) fn write(&self, to: &mut [f32]) -> Result<(), ModelError> {
        if self.0.len() != to.len() {
            return Err(bad(format!(
                "it has {} numbers where this training has {}",
                self.0.len(),
                to.len()
            )));
        }
        for (to, &bits) in to.iter_mut().zip(&self.0) {
            *to = f32::from_bits(bits);
        }
        if to.iter().all(|v| v.is_finite()) {
            Ok(())
        } else {
            Err(bad("one of its numbers is not finite".to_owned()))
        }
    }
}

pub(crate) fn bad(problem: String) -> ModelError {
    ModelError::BadCheckpoint { problem }
}

impl TrainingState {
    /// Epochs that are over, in the run that is under way.
    pub fn epochs_done(&self) -> usize {
        self.epochs.len()
    }

    /// The state as bytes; equal states give equal bytes.
    ///
    /// # Errors
    /// [`ModelError::BadCheckpoint`] if it cannot be written, which no state that exists should cause.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ModelError> {
        checkpoint::frame(MAGIC, VERSION, self).map_err(|e| bad(e.to_string()))
    }

    /// The state that [`Self::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`ModelError::BadCheckpoint`] for anything else: other files, other versions, cut or changed bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ModelError> {
        checkpoint::unframe(MAGIC, VERSION, bytes).map_err(|error| {
            bad(match error {
                ModelError::NotAModelFile => "it does not start like one".to_owned(),
                ModelError::OtherVersion { found, expected } => {
                    format!("it has version {found}, this program reads {expected}")
                }
                ModelError::WrongLength { found, expected } => {
                    format!("it has {found} bytes after its header, expected {expected}")
                }
                ModelError::Damaged { .. } => "its checksum is wrong".to_owned(),
                other => other.to_string(),
            })
        })
    }
}
