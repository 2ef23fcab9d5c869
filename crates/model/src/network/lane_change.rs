//! C_ψ: whether a lane change is being started, from `w` and windows of v_ego, v_lead and d_x.
//!
//! Windows `(3 × steps) → hidden → z_l`; then `[w, z_l] → hidden → hidden → logits {keep, change}`. The
//! softmax of the two logits is trained by L2 with weighted classes, so it is the probability of a world in
//! which both classes are equally frequent; [`crate::Model`] undoes that for whoever asks from outside.

use super::{
    Architecture,
    encoded::{Encoded, EncodedPass},
};
use crate::kernel::{ROWS, Real, Tile};

/// The sub-network C_ψ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct LaneChange {
    pub(crate) encoded: Encoded,
}

/// A tile on its way through C_ψ.
#[derive(Debug)]
pub(crate) struct LaneChangePass<T> {
    pub(crate) encoded: EncodedPass<T>,
    /// Softmax probability of a change, shape `(1, ROWS)`.
    pub(crate) probability: Tile<T>,
}

impl<T: Real> LaneChangePass<T> {
    pub(crate) fn new(network: &LaneChange) -> Self {
        Self {
            encoded: EncodedPass::new(&network.encoded),
            probability: Tile::zeros(1),
        }
    }
}

impl LaneChange {
    pub(crate) fn new(offset: &mut usize, architecture: &Architecture) -> Self {
        Self {
            encoded: Encoded::new(offset, architecture, 2),
        }
    }

    pub(crate) fn forward<T: Real>(
        &self,
        parameters: &[T],
        embedding: &Tile<T>,
        pass: &mut LaneChangePass<T>,
    ) {
        self.encoded
            .forward(parameters, embedding, &mut pass.encoded);
        let logits = pass.encoded.head.output();
        let (keep, change) = logits.all().split_at(ROWS);
        let probability = pass.probability.all_mut().iter_mut();
        for ((p, &keep), &change) in probability.zip(keep).zip(change) {
            *p = T::from_f64(1.0 / (1.0 + (keep - change).f64().exp()));
        }
    }
}
