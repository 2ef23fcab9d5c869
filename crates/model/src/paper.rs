//! The paper's five networks, trained: their parameters and everything needed to read them.

use crate::{
    error::ModelError,
    losses::LossWeights,
    network::{Architecture, Networks},
    rows::{RowSettings, RowWeights},
    scaling::{Scaling, Standardization},
    whitening::Whitening,
    windows::{WindowBuffer, WindowSettings},
};
use serde::{Deserialize, Serialize};

/// Which networks had anything to learn from.
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

/// What a file holds of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PaperParts {
    pub(crate) architecture: Architecture,
    pub(crate) windows: WindowSettings,
    pub(crate) row_rate_hz: f64,
    pub(crate) loss_weights: LossWeights,
    pub(crate) scaling: Scaling,
    pub(crate) row_weights: RowWeights,
    pub(crate) learned: Learned,
    /// Lowest and highest ego speed learned from, in m/s.
    pub(crate) speed_range_mps: [f64; 2],
    pub(crate) whitening: Whitening,
    pub(crate) parameters: Vec<f32>,
}

/// F, C, V, S and M with their parameters.
///
/// # Source
/// Paper, "Network"; method section 3.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "PaperParts", into = "PaperParts")]
pub struct PaperNetworks {
    pub(crate) parts: PaperParts,
    pub(crate) networks: Networks,
}

impl TryFrom<PaperParts> for PaperNetworks {
    type Error = ModelError;

    /// Puts the parts together, if they belong together.
    fn try_from(parts: PaperParts) -> Result<Self, ModelError> {
        let bad = |problem: &str| ModelError::BadModelFile {
            problem: problem.to_owned(),
        };
        if parts.windows.steps() != parts.architecture.window_steps {
            return Err(bad("its windows are not those of its networks"));
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
        let Scaling {
            signals: [ego, lead, dx, dy],
            following_distance,
            aggression,
        } = parts.scaling;
        let usable = |s: &Standardization| s.mean.is_finite() && s.sd.is_normal() && s.sd > 0.0;
        let scales = [ego, lead, dx, dy, following_distance, aggression];
        if !scales.iter().all(usable) {
            return Err(bad("a mean or SD is not usable"));
        }
        let [low, high] = parts.speed_range_mps;
        if !(low.is_finite() && high.is_finite() && low <= high) {
            return Err(bad("its speed range is not a range"));
        }
        Ok(Self { parts, networks })
    }
}

impl From<PaperNetworks> for PaperParts {
    fn from(networks: PaperNetworks) -> Self {
        networks.parts
    }
}

impl PaperNetworks {
    pub(crate) fn row_settings(&self) -> RowSettings {
        RowSettings {
            row_rate_hz: self.parts.row_rate_hz,
            windows: self.parts.windows,
        }
    }

    /// Loss weights as trained, 0 where a loss had no data.
    pub(crate) fn active_weights(&self) -> LossWeights {
        active_weights(&self.parts.loss_weights, self.parts.learned)
    }

    /// Sizes of the networks.
    pub fn architecture(&self) -> &Architecture {
        &self.parts.architecture
    }

    /// The windows that they read.
    pub fn windows(&self) -> WindowSettings {
        self.parts.windows
    }

    /// An empty buffer for the windows that they read.
    pub fn window_buffer(&self) -> WindowBuffer {
        WindowBuffer::new(self.windows())
    }

    /// Means and SDs of the training set.
    pub fn scaling(&self) -> &Scaling {
        &self.parts.scaling
    }

    /// Which of them had anything to learn from.
    pub fn learned(&self) -> Learned {
        self.parts.learned
    }

    /// Lowest and highest ego speed learned from, in m/s.
    pub fn speed_range_mps(&self) -> [f64; 2] {
        self.parts.speed_range_mps
    }

    /// How embeddings were whitened.
    pub fn whitening(&self) -> &Whitening {
        &self.parts.whitening
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
