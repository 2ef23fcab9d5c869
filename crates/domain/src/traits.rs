//! What a synthetic person is like.

use serde::{Deserialize, Serialize};

/// The latent traits behind a synthetic person's driving, each N(0, 1) in the population.
///
/// # Source
/// Method section 7 and calibration section 2: three independent latents. The driver model
/// and the questionnaire answers both start from these, and neither sees the other.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LatentTraits {
    /// a: how aggressive the person is, apart from spacing and pace.
    pub aggressiveness: f64,
    /// b: spacing, how much room the person leaves.
    pub spacing: f64,
    /// c: pace and fondness of the left lane.
    pub pace: f64,
}

impl LatentTraits {
    /// A person of the population, by draws from N(0, 1).
    pub fn draw(mut normal: impl FnMut() -> f64) -> Self {
        Self { aggressiveness: normal(), spacing: normal(), pace: normal() }
    }
}
