//! How a network is made and trained in closed loop.

use crate::FollowingError;
use serde::{Deserialize, Serialize};

/// How a network is made and trained in closed loop.
///
/// # Source
/// Ours, chosen on fit rows alone: each half of them predicted from the other, their first third and their last from the
/// rest. Segments of a minute and more fit slow drifts that do not recur; 15 s are too short.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClosedLoopSettings {
    /// Numbers in an embedding, d.
    pub embedding_size: usize,
    /// Units of each of the two hidden layers.
    pub hidden_units: usize,
    /// Length of a simulated segment, in s; at most that of the shortest driver's rows.
    pub segment_s: f64,
    /// Steps of the optimiser, each through all rows.
    pub iterations: usize,
    /// Its rate for the weights; it falls to 0 along half a cosine.
    pub learning_rate: f64,
    /// Its rate for the embeddings.
    pub embedding_rate: f64,
    /// How strongly weights are drawn to 0, and so the driver to a usual one.
    pub weight_decay: f64,
    /// How strongly an embedding is drawn to 0 in training and to the mean afterwards: a weight of the prior N(0, I)
    /// beside each second of the driver's rows, so that a short drive moves an embedding less than a long one.
    pub embedding_prior: f64,
    /// Weight of a squared error of 1 m/s beside that of one standard deviation of the gap.
    pub speed_weight: f64,
}

impl ClosedLoopSettings {
    pub(super) const DEFAULT: Self = Self {
        embedding_size: 3,
        hidden_units: 8,
        segment_s: 30.0,
        iterations: 400,
        learning_rate: 0.01,
        embedding_rate: 0.03,
        weight_decay: 0.001,
        embedding_prior: 2.0,
        speed_weight: 0.01,
    };

    pub(super) fn check(&self) -> Result<(), FollowingError> {
        let above = f64::MIN_POSITIVE;
        check(&[
            ("embedding_size", self.embedding_size as f64, 1.0),
            ("hidden_units", self.hidden_units as f64, 1.0),
            ("segment_s", self.segment_s, above),
            ("iterations", self.iterations as f64, 1.0),
            ("learning_rate", self.learning_rate, above),
            ("embedding_rate", self.embedding_rate, above),
            ("weight_decay", self.weight_decay, 0.0),
            ("embedding_prior", self.embedding_prior, 0.0),
            ("speed_weight", self.speed_weight, 0.0),
        ])
    }
}

impl Default for ClosedLoopSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Whether each setting (name, value, least value) is finite and not below its least value.
pub(crate) fn check(settings: &[(&'static str, f64, f64)]) -> Result<(), FollowingError> {
    for &(name, value, least) in settings {
        if !(value.is_finite() && value >= least) {
            let expected = match least {
                1.0.. => "at least 1",
                0.0 => "a finite number, 0 or above",
                _ => "a finite number above 0",
            };
            return Err(FollowingError::BadSetting {
                name,
                found: value,
                expected,
            });
        }
    }
    Ok(())
}
