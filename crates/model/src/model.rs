//! A trained model: the networks' parameters and everything needed to read them.

use crate::{
    error::ModelError,
    linear_algebra::norm,
    losses::{LossWeights, MutualInformationLoss},
    network::{Architecture, Networks},
    params::TrainSettings,
    rows::{RowSettings, RowWeights},
    scaling::Scaling,
    whitening::Whitening,
    windows::{WindowBuffer, WindowSettings},
};
use maveric_domain::{DriveId, Embedding};
use serde::{Deserialize, Serialize};

/// Which heads had anything to learn from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learned {
    /// F: there were following rows.
    pub following_distance: bool,
    /// C: there were rows with and without a lane change being started.
    pub lane_change: bool,
    /// S: there were ADB scores.
    pub aggression: bool,
}

/// A training drive in style space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingEmbedding {
    /// The drive.
    pub drive: DriveId,
    /// Where training put it, after whitening.
    pub embedding: Embedding,
    /// Mean ego speed over the rows learned from, in m/s.
    pub mean_speed_mps: f64,
}

/// What a model file holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModelParts {
    pub(crate) settings: TrainSettings,
    pub(crate) architecture: Architecture,
    pub(crate) scaling: Scaling,
    pub(crate) row_weights: RowWeights,
    pub(crate) learned: Learned,
    /// Lowest and highest ego speed learned from, in m/s.
    pub(crate) speed_range_mps: [f64; 2],
    pub(crate) whitening: Whitening,
    pub(crate) training: Vec<TrainingEmbedding>,
    pub(crate) parameters: Vec<f32>,
}

/// A trained model; made by [`crate::train()`] or read by [`crate::checkpoint::from_bytes`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ModelParts", into = "ModelParts")]
pub struct Model {
    parts: ModelParts,
    networks: Networks,
    mean_embedding: Embedding,
}

impl Model {
    /// Puts the parts together, if they belong together.
    pub(crate) fn from_parts(parts: ModelParts) -> Result<Self, ModelError> {
        let bad = |problem: &str| ModelError::BadModelFile {
            problem: problem.to_owned(),
        };
        let checked = crate::params::TrainParams::new(parts.settings.clone())?;
        if checked.settings().architecture() != parts.architecture {
            return Err(bad("its sizes are not those of its settings"));
        }
        let networks = Networks::new(parts.architecture);
        if parts.parameters.len() != networks.parameters {
            return Err(bad("its number of parameters is not that of its sizes"));
        }
        if parts.parameters.iter().any(|p| !p.is_finite()) {
            return Err(bad("a parameter is not a finite number"));
        }
        let d = parts.architecture.embedding_size;
        let w = &parts.whitening;
        if w.mean.len() != d || w.root.len() != d * d || w.inverse_root.len() != d * d {
            return Err(bad("its whitening is of another embedding size"));
        }
        if parts.training.iter().any(|t| t.embedding.size() != d) {
            return Err(bad("a training embedding is of another size"));
        }
        let Scaling {
            signals: [ego, lead, dx, dy],
            following_distance,
            aggression,
        } = parts.scaling;
        let usable = |s: &crate::scaling::Standardization| {
            s.mean.is_finite() && s.sd.is_normal() && s.sd > 0.0
        };
        let scales = [ego, lead, dx, dy, following_distance, aggression];
        if !scales.iter().all(usable) {
            return Err(bad("a mean or SD is not usable"));
        }
        let [low, high] = parts.speed_range_mps;
        if !(low.is_finite() && high.is_finite() && low <= high) {
            return Err(bad("its speed range is not a range"));
        }
        let n = parts.training.len().max(1) as f64;
        let mean = (0..d).map(|i| {
            let at = parts.training.iter();
            at.map(|t| t.embedding.coordinates()[i]).sum::<f64>() / n
        });
        let mean_embedding = Embedding::new(mean.collect())?;
        Ok(Self {
            parts,
            networks,
            mean_embedding,
        })
    }

    pub(crate) fn networks(&self) -> &Networks {
        &self.networks
    }

    pub(crate) fn parameters(&self) -> &[f32] {
        &self.parts.parameters
    }

    pub(crate) fn row_weights(&self) -> &RowWeights {
        &self.parts.row_weights
    }

    pub(crate) fn row_settings(&self) -> RowSettings {
        RowSettings {
            row_rate_hz: self.parts.settings.row_rate_hz,
            windows: self.windows(),
        }
    }

    /// Loss weights as trained, 0 where a loss had no data.
    pub(crate) fn active_weights(&self) -> LossWeights {
        active_weights(&self.parts.settings.loss_weights, self.parts.learned)
    }

    /// The settings it was trained with.
    pub fn settings(&self) -> &TrainSettings {
        &self.parts.settings
    }

    /// Sizes of its networks.
    pub fn architecture(&self) -> &Architecture {
        &self.parts.architecture
    }

    /// Numbers in an embedding, d.
    pub fn embedding_size(&self) -> usize {
        self.parts.architecture.embedding_size
    }

    /// The windows it reads.
    pub fn windows(&self) -> WindowSettings {
        self.parts.settings.windows()
    }

    /// An empty buffer for the windows it reads.
    pub fn window_buffer(&self) -> WindowBuffer {
        WindowBuffer::new(self.windows())
    }

    /// Means and SDs of its training set.
    pub fn scaling(&self) -> &Scaling {
        &self.parts.scaling
    }

    /// Which heads had anything to learn from.
    pub fn learned(&self) -> Learned {
        self.parts.learned
    }

    /// Lowest and highest ego speed it was trained on, in m/s.
    pub fn speed_range_mps(&self) -> [f64; 2] {
        self.parts.speed_range_mps
    }

    /// How embeddings were whitened.
    pub fn whitening(&self) -> &Whitening {
        &self.parts.whitening
    }

    /// The training drives in style space, in the order they were given.
    pub fn training(&self) -> &[TrainingEmbedding] {
        &self.parts.training
    }

    /// How L5 was taken.
    pub fn mutual_information_loss(&self) -> MutualInformationLoss {
        self.parts.settings.mutual_information_loss
    }

    /// The mean of the training embeddings: what is known of a driver not met yet.
    pub fn mean_embedding(&self) -> &Embedding {
        &self.mean_embedding
    }

    /// The largest distance of a training embedding from their mean.
    pub fn training_radius(&self) -> f64 {
        let mean = self.mean_embedding();
        let distance = |t: &TrainingEmbedding| {
            let difference = t.embedding.coordinates().iter().zip(mean.coordinates());
            norm(&difference.map(|(x, m)| x - m).collect::<Vec<_>>())
        };
        self.parts.training.iter().map(distance).fold(0.0, f64::max)
    }

    /// f̂: the gap that a driver keeps behind a lead at `lead_speed_mps` (m/s), in m; 0 or more.
    ///
    /// A model that saw no following rows answers 0, which leaves the gap to the safety rule.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`], or [`ModelError::NotFinite`] for the speed.
    pub fn following_distance(
        &self,
        embedding: &Embedding,
        lead_speed_mps: f64,
    ) -> Result<f64, ModelError> {
        Ok(crate::predict::FollowingHead::new(self, embedding)?.distance_m(lead_speed_mps))
    }

    /// Takes coordinates of the model's size.
    pub(crate) fn check(&self, embedding: &Embedding) -> Result<(), ModelError> {
        let (found, expected) = (embedding.size(), self.embedding_size());
        if found == expected {
            Ok(())
        } else {
            Err(ModelError::EmbeddingSize { found, expected })
        }
    }
}

pub(crate) fn active_weights(weights: &LossWeights, learned: Learned) -> LossWeights {
    let keep = |weight: f64, learned: bool| if learned { weight } else { 0.0 };
    LossWeights {
        following_distance: keep(weights.following_distance, learned.following_distance),
        lane_change: keep(weights.lane_change, learned.lane_change),
        aggression: keep(weights.aggression, learned.aggression),
        ..*weights
    }
}

impl TryFrom<ModelParts> for Model {
    type Error = ModelError;
    fn try_from(parts: ModelParts) -> Result<Self, ModelError> {
        Self::from_parts(parts)
    }
}

impl From<Model> for ModelParts {
    fn from(model: Model) -> Self {
        model.parts
    }
}
