//! C_ψ: whether a lane change is being started, from `w` and windows of v_ego, v_lead and d_x.
//!
//! Windows `(3 × steps) → hidden → z_l`; then `[w, z_l] → hidden → hidden → logits {keep, change}`. The
//! softmax of the two logits is trained by L2 with weighted classes, so it is the probability of a world in
//! which both classes are equally frequent; [`crate::Model`] undoes that for whoever asks from outside.

use super::{Architecture, encoded::Encoded};

/// The sub-network C_ψ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct LaneChange {
    pub(crate) encoded: Encoded,
}

impl LaneChange {
    pub(crate) fn new(offset: &mut usize, architecture: &Architecture) -> Self {
        Self {
            encoded: Encoded::new(offset, architecture, 2),
        }
    }
}
