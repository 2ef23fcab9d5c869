//! The paper's five networks, trained: their parameters and everything needed to read them.

use crate::{
    error::ModelError,
    heads::{FittedHead, check},
    linear_algebra::dot,
    losses::LossWeights,
    network::{Architecture, Networks},
    rows::{RowSettings, RowWeights},
    scaling::{Scaling, Standardization},
    whitening::Whitening,
    windows::{WindowBuffer, WindowSettings},
};
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

/// Which networks had anything to learn from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learned {
    /// F: there were following rows.
    pub following_distance: bool,
    /// C: there were rows with and without a lane change being started.
    pub lane_change: bool,
    /// S: there were scores of the style.
    pub aggression: bool,
}

/// F, C, V, S and M with their parameters.
///
/// # Source
/// Paper, "Network"; method section 3.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaperNetworks {
    pub(crate) architecture: Architecture,
    pub(crate) windows: WindowSettings,
    pub(crate) row_rate_hz: f64,
    /// 0 where a loss had no data.
    pub(crate) loss_weights: LossWeights,
    pub(crate) scaling: Scaling,
    pub(crate) row_weights: RowWeights,
    pub(crate) learned: Learned,
    /// Lowest and highest ego speed learned from, in m/s.
    pub(crate) speed_range_mps: [f64; 2],
    pub(crate) whitening: Whitening,
    /// How the habits of the people learned from differ, for what these networks say of nobody: whether they have met such a
    /// driver.
    pub(crate) habits: Vec<FittedHead>,
    pub(crate) parameters: Vec<f32>,
}

impl PaperNetworks {
    /// Whether its parts belong together, and to embeddings of that size.
    pub(crate) fn check(&self, d: usize) -> Result<(), ModelError> {
        let Scaling { signals: [ego, lead, dx, dy], following_distance, aggression } = self.scaling;
        let usable = |s: &Standardization| s.mean.is_finite() && s.sd.is_normal() && s.sd > 0.0;
        let scales = [ego, lead, dx, dy, following_distance, aggression];
        let [low, high] = self.speed_range_mps;
        let problem = if self.architecture.embedding_size != d || !self.whitening.is_of(d) {
            "its networks read another embedding size"
        } else if self.windows.steps() != self.architecture.window_steps {
            "its windows are not those of its networks"
        } else if self.parameters.len() != self.networks().parameters {
            "its number of parameters is not that of its sizes"
        } else if self.parameters.iter().any(|p| !p.is_finite()) {
            "a parameter is not a finite number"
        } else if !scales.iter().all(usable) {
            "a mean or SD is not usable"
        } else if !(low.is_finite() && high.is_finite() && low <= high) {
            "its speed range is not a range"
        } else {
            return check(&self.habits, d);
        };
        Err(ModelError::bad_file(problem))
    }

    pub(crate) fn networks(&self) -> Networks {
        Networks::new(self.architecture)
    }

    pub(crate) fn row_settings(&self) -> RowSettings {
        RowSettings { row_rate_hz: self.row_rate_hz, windows: self.windows }
    }

    /// S as slopes and level in points of the score, of whitened embeddings.
    pub(crate) fn style_points(&self) -> (Vec<f64>, f64) {
        let layer = self.networks().style[0];
        let raw: Vec<f64> = layer.weights(&self.parameters).iter().map(|&w| f64::from(w)).collect();
        let level = f64::from(layer.biases(&self.parameters)[0]);
        let zero = self.whitening.undo(&vec![0.0; raw.len()]);
        let offset = self.scaling.aggression.undo(level + dot(&raw, zero.as_slice()));
        let gradient = self.whitening.root() * DVector::from_vec(raw) * self.scaling.aggression.sd;
        (gradient.iter().copied().collect(), offset)
    }

    /// Sizes of the networks.
    pub fn architecture(&self) -> &Architecture {
        &self.architecture
    }

    /// An empty buffer for the windows that they read.
    pub fn window_buffer(&self) -> WindowBuffer {
        WindowBuffer::new(self.windows)
    }

    /// Which of them had anything to learn from.
    pub fn learned(&self) -> Learned {
        self.learned
    }
}
