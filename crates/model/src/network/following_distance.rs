//! F_φ: the distance a driver keeps, from `w` and the lead's speed now.
//!
//! `[w (d), v_lead (1)] → hidden → hidden → f̂ (1)`, all standardised. Trained by L1 over following rows.

use super::{
    Architecture,
    mlp::{Mlp, MlpPass},
};
use crate::kernel::{Real, Tile, add_assign};

/// The sub-network F_φ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct FollowingDistance {
    pub(crate) head: Mlp,
}

impl FollowingDistance {
    pub(crate) fn new(offset: &mut usize, architecture: &Architecture) -> Self {
        let sizes = architecture.head_sizes(architecture.embedding_size + 1, 1);
        Self {
            head: Mlp::new(offset, &sizes),
        }
    }

    pub(crate) fn forward<T: Real>(
        &self,
        parameters: &[T],
        embedding: &Tile<T>,
        lead_speed: &Tile<T>,
        pass: &mut MlpPass<T>,
    ) {
        let d = embedding.features();
        let input = pass.input();
        input.range_mut(0..d).copy_from_slice(embedding.all());
        input.range_mut(d..d + 1).copy_from_slice(lead_speed.all());
        self.head.forward(parameters, pass);
    }

    /// Adds the gradient of `w` to `embedding_gradient`.
    pub(crate) fn backward<T: Real>(
        &self,
        parameters: &[T],
        gradient: Option<&mut [T]>,
        pass: &mut MlpPass<T>,
        embedding_gradient: &mut Tile<T>,
    ) {
        self.head.backward(parameters, gradient, pass, true);
        let d = embedding_gradient.features();
        add_assign(
            embedding_gradient.all_mut(),
            pass.input_gradient().range(0..d),
        );
    }
}
