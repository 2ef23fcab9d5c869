//! Where each weight stands in one vector.

use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use std::ops::Range;

/// What the network reads beside the embedding: a speed.
pub(super) const INPUTS: usize = 1;
/// What it gives: time gap, gap at standstill, acceleration and sensitivity to closing speed.
pub(super) const OUTPUTS: usize = 4;

/// Sizes of the network and the place of each part in the vector of its weights; weights run output by output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) struct Layout {
    /// Numbers in an embedding, d.
    pub(super) embedding: usize,
    /// Units of each of the two hidden layers, h.
    pub(super) hidden: usize,
}

impl Layout {
    /// From the embedding to the first layer, shape `(h, d)`.
    pub(super) fn style(self) -> Range<usize> {
        0..self.hidden * self.embedding
    }

    /// From the inputs to the first layer, shape `(h, 1)`.
    pub(super) fn first(self) -> Range<usize> {
        after(self.style(), self.hidden * INPUTS)
    }

    /// Biases of the first layer.
    pub(super) fn first_bias(self) -> Range<usize> {
        after(self.first(), self.hidden)
    }

    /// Second layer, shape `(h, h)`.
    pub(super) fn second(self) -> Range<usize> {
        after(self.first_bias(), self.hidden * self.hidden)
    }

    /// Its biases.
    pub(super) fn second_bias(self) -> Range<usize> {
        after(self.second(), self.hidden)
    }

    /// Output layer, shape `(4, h)`.
    pub(super) fn last(self) -> Range<usize> {
        after(self.second_bias(), OUTPUTS * self.hidden)
    }

    /// Its biases.
    pub(super) fn last_bias(self) -> Range<usize> {
        after(self.last(), OUTPUTS)
    }

    /// From the embedding straight to the outputs, shape `(4, d)`.
    pub(super) fn direct(self) -> Range<usize> {
        after(self.last_bias(), OUTPUTS * self.embedding)
    }

    /// Number of weights and biases.
    pub(super) fn len(self) -> usize {
        self.direct().end
    }

    /// Random weights; the outputs start near their biases, which are 0.
    pub(super) fn draw(self, rng: &mut impl Rng) -> Vec<f64> {
        let mut weights = vec![0.0; self.len()];
        let mut fill = |range: Range<usize>, sd: f64| {
            for weight in &mut weights[range] {
                *weight = sd * rng.sample::<f64, _>(StandardNormal);
            }
        };
        let inputs = (INPUTS + self.embedding) as f64;
        fill(self.style(), 1.0 / inputs.sqrt());
        fill(self.first(), 1.0 / inputs.sqrt());
        fill(self.first_bias(), 0.3);
        fill(self.second(), 1.0 / (self.hidden as f64).sqrt());
        fill(self.last(), 0.1 / (self.hidden as f64).sqrt());
        fill(self.direct(), 0.1);
        weights
    }
}

fn after(before: Range<usize>, count: usize) -> Range<usize> {
    before.end..before.end + count
}
