//! What C and V share: an encoder of windows, and a head that reads the code and `w`.

use super::{
    Architecture, WINDOW_SIGNALS,
    mlp::{Mlp, MlpPass},
};
use crate::kernel::{Real, Tile, add_assign};

/// An encoder and its head; the head reads `[w, z]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Encoded {
    pub(crate) encoder: Mlp,
    pub(crate) head: Mlp,
}

/// A tile on its way through an [`Encoded`].
#[derive(Debug)]
pub(crate) struct EncodedPass<T> {
    pub(crate) encoder: MlpPass<T>,
    pub(crate) head: MlpPass<T>,
}

impl<T: Real> EncodedPass<T> {
    pub(crate) fn new(network: &Encoded) -> Self {
        Self {
            encoder: MlpPass::new(&network.encoder),
            head: MlpPass::new(&network.head),
        }
    }
}

impl Encoded {
    pub(crate) fn new(offset: &mut usize, a: &Architecture, outputs: usize) -> Self {
        let windows = WINDOW_SIGNALS * a.window_steps;
        let encoder = Mlp::new(offset, &[windows, a.encoder_units, a.encoding_size]);
        let sizes = a.head_sizes(a.embedding_size + a.encoding_size, outputs);
        Self {
            encoder,
            head: Mlp::new(offset, &sizes),
        }
    }

    /// From the code, which lies in the encoder's output, through the head.
    pub(crate) fn forward<T: Real>(
        &self,
        parameters: &[T],
        embedding: &Tile<T>,
        pass: &mut EncodedPass<T>,
    ) {
        let d = embedding.features();
        let code = pass.encoder.output();
        let end = d + code.features();
        let input = pass.head.input();
        input.range_mut(0..d).copy_from_slice(embedding.all());
        input.range_mut(d..end).copy_from_slice(code.all());
        self.head.forward(parameters, &mut pass.head);
    }

    /// Back through the head: adds to the code's gradient and to `embedding_gradient`.
    pub(crate) fn backward<T: Real>(
        &self,
        parameters: &[T],
        gradient: Option<&mut [T]>,
        pass: &mut EncodedPass<T>,
        embedding_gradient: &mut Tile<T>,
    ) {
        self.head
            .backward(parameters, gradient, &mut pass.head, true);
        let d = embedding_gradient.features();
        let input = pass.head.input_gradient();
        add_assign(embedding_gradient.all_mut(), input.range(0..d));
        let end = input.features();
        add_assign(
            pass.encoder.output_gradient().all_mut(),
            input.range(d..end),
        );
    }
}
