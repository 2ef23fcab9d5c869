//! What is simulated: the recorded rows of several segments abreast, and what all of them share.

use super::{
    controller::Scaling,
    lanes::{LANES, Lanes},
    layout::Layout,
};
use maveric_laws::{Real, Rss};

/// The recorded rows of up to [`LANES`] segments of equal length.
pub(super) struct Batch<T> {
    /// Which embedding drives each lane.
    pub(super) embeddings: [usize; LANES],
    /// Weight of each lane's error in the loss; 0 for a lane that only fills up.
    pub(super) weights: [f64; LANES],
    /// Shape `(steps + 1,)`.
    pub(super) rows: Vec<Row<T>>,
}

/// What was recorded at one moment of each segment.
#[derive(Clone, Copy)]
pub(super) struct Row<T> {
    /// Recorded distance to the leader, in m.
    pub(super) gap_m: Lanes<T>,
    /// Speed, in m/s.
    pub(super) speed_mps: Lanes<T>,
    /// Speed of the leader, in m/s.
    pub(super) lead_mps: Lanes<T>,
    /// How far the leader moved since the row before, in m.
    pub(super) lead_moved_m: Lanes<T>,
}

/// What all segments share.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct World<T = f64> {
    pub(super) layout: Layout,
    pub(super) scaling: Scaling<T>,
    pub(super) safety: Rss<T>,
    pub(super) step_s: T,
    /// Weight of a squared error of 1 m.
    pub(super) gap_weight: T,
    /// Weight of a squared error of 1 m/s.
    pub(super) speed_weight: T,
}

impl World {
    pub(super) fn reckoned_in<T: Real>(&self) -> World<T> {
        World {
            layout: self.layout,
            scaling: Scaling {
                speed_mean_mps: T::of(self.scaling.speed_mean_mps),
                speed_sd_mps: T::of(self.scaling.speed_sd_mps),
            },
            safety: self.safety.reckoned_in(),
            step_s: T::of(self.step_s),
            gap_weight: T::of(self.gap_weight),
            speed_weight: T::of(self.speed_weight),
        }
    }
}
