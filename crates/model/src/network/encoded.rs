//! What C and V share: an encoder of windows, and a head that reads the code and `w`.

use super::{Architecture, WINDOW_SIGNALS, mlp::Mlp};

/// An encoder and its head; the head reads `[w, z]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Encoded {
    pub(crate) encoder: Mlp,
    pub(crate) head: Mlp,
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
}
