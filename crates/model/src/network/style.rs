//! S_θ: the ADB score, from `w` by one linear layer, so that its gradient is one direction everywhere.
//!
//! `w (d) → ŝ (1)`, standardised. Trained by L4, one row a drive.

use super::{
    Architecture,
    mlp::{Dense, Mlp, MlpPass},
};
use crate::kernel::{Real, Tile, add_assign};

/// The sub-network S_θ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Style {
    pub(crate) layer: Mlp,
}

impl Style {
    pub(crate) fn new(offset: &mut usize, architecture: &Architecture) -> Self {
        Self {
            layer: Mlp::new(offset, &[architecture.embedding_size, 1]),
        }
    }

    /// S alone, its parameters from 0 on.
    pub(crate) fn of_size(embedding_size: usize) -> Self {
        Self {
            layer: Mlp::new(&mut 0, &[embedding_size, 1]),
        }
    }

    /// The one layer.
    pub(crate) fn dense(&self) -> Dense {
        self.layer.first()
    }

    /// ŝ of one embedding, standardised.
    pub(crate) fn value<T: Real>(&self, parameters: &[T], embedding: &[T]) -> T {
        let dense = self.dense();
        let weights = dense.weights(parameters);
        let bias = dense.biases(parameters)[0];
        weights
            .iter()
            .zip(embedding)
            .fold(bias, |sum, (&w, &x)| sum + w * x)
    }

    pub(crate) fn forward<T: Real>(
        &self,
        parameters: &[T],
        embedding: &Tile<T>,
        pass: &mut MlpPass<T>,
    ) {
        pass.input().all_mut().copy_from_slice(embedding.all());
        self.layer.forward(parameters, pass);
    }

    /// Adds the gradient of `w` to `embedding_gradient`.
    pub(crate) fn backward<T: Real>(
        &self,
        parameters: &[T],
        gradient: Option<&mut [T]>,
        pass: &mut MlpPass<T>,
        embedding_gradient: &mut Tile<T>,
    ) {
        self.layer.backward(parameters, gradient, pass, true);
        add_assign(embedding_gradient.all_mut(), pass.input_gradient().all());
    }
}
