//! M_α: a reading of `w` from the lead's speed, the two codes and the four outputs.
//!
//! `[v_lead, z_l, z_v, f̂, P(change), v̂, ŝ] → hidden → hidden → [μ (d), ln σ (d)]` of a normal over `w`, in the
//! coordinates `w` had while training (whitening does not touch M, see [`crate::whitening`]). Its gradient flows
//! on into every predictor.

use super::{
    Architecture,
    mlp::{Mlp, MlpPass},
};
use crate::kernel::{Real, Tile, add_assign};

/// The sub-network M_α.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct MutualInformation {
    pub(crate) head: Mlp,
    encoding_size: usize,
}

/// What M reads; `(features, ROWS)` each.
pub(crate) struct Reads<'a, T> {
    pub(crate) lead_speed: &'a Tile<T>,
    pub(crate) lane_context: &'a Tile<T>,
    pub(crate) speed_context: &'a Tile<T>,
    pub(crate) following_distance: &'a Tile<T>,
    pub(crate) probability: &'a Tile<T>,
    pub(crate) speed: &'a Tile<T>,
    pub(crate) aggression: &'a Tile<T>,
}

/// Where each output lies among M's inputs, counted after the two codes.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Output {
    FollowingDistance,
    Probability,
    Speed,
    Aggression,
}

impl MutualInformation {
    pub(crate) fn new(offset: &mut usize, a: &Architecture) -> Self {
        let sizes = a.head_sizes(1 + 2 * a.encoding_size + 4, 2 * a.embedding_size);
        Self {
            head: Mlp::new(offset, &sizes),
            encoding_size: a.encoding_size,
        }
    }

    pub(crate) fn forward<T: Real>(
        &self,
        parameters: &[T],
        reads: &Reads<'_, T>,
        pass: &mut MlpPass<T>,
    ) {
        let input = pass.input();
        let mut at = 0;
        for tile in [
            reads.lead_speed,
            reads.lane_context,
            reads.speed_context,
            reads.following_distance,
            reads.probability,
            reads.speed,
            reads.aggression,
        ] {
            let end = at + tile.features();
            input.range_mut(at..end).copy_from_slice(tile.all());
            at = end;
        }
        self.head.forward(parameters, pass);
    }

    pub(crate) fn backward<T: Real>(
        &self,
        parameters: &[T],
        gradient: Option<&mut [T]>,
        pass: &mut MlpPass<T>,
    ) {
        self.head.backward(parameters, gradient, pass, true);
    }

    /// Gradient of z_l after [`Self::backward`].
    pub(crate) fn lane_context_gradient<'a, T: Real>(&self, pass: &'a MlpPass<T>) -> &'a [T] {
        pass.input_gradient().range(1..1 + self.encoding_size)
    }

    /// Gradient of z_v after [`Self::backward`].
    pub(crate) fn speed_context_gradient<'a, T: Real>(&self, pass: &'a MlpPass<T>) -> &'a [T] {
        let first = 1 + self.encoding_size;
        pass.input_gradient()
            .range(first..first + self.encoding_size)
    }

    /// Gradient of one output, shape `(ROWS,)`, after [`Self::backward`].
    pub(crate) fn output_gradient<'a, T: Real>(
        &self,
        pass: &'a MlpPass<T>,
        output: Output,
    ) -> &'a [T] {
        pass.input_gradient()
            .feature(1 + 2 * self.encoding_size + output as usize)
    }

    /// Adds the gradient of one output to `to`.
    pub(crate) fn add_output_gradient<T: Real>(
        &self,
        pass: &MlpPass<T>,
        output: Output,
        to: &mut Tile<T>,
    ) {
        add_assign(to.all_mut(), self.output_gradient(pass, output));
    }
}
