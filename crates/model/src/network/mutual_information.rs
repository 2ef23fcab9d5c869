//! M_α: a reading of `w` from the lead's speed, the two codes and the four outputs.
//!
//! `[v_lead, z_l, z_v, f̂, P(change), v̂, ŝ] → hidden → hidden → [μ (d), ln σ (d)]` of a normal over `w`, in the
//! coordinates `w` had while training (whitening does not touch M, see [`crate::whitening`]). Its gradient flows
//! on into every predictor.

use super::{Architecture, mlp::Mlp};

/// The sub-network M_α.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct MutualInformation {
    pub(crate) head: Mlp,
}

impl MutualInformation {
    pub(crate) fn new(offset: &mut usize, a: &Architecture) -> Self {
        let sizes = a.head_sizes(1 + 2 * a.encoding_size + 4, 2 * a.embedding_size);
        Self {
            head: Mlp::new(offset, &sizes),
        }
    }
}
