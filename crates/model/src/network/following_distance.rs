//! F_φ: the distance a driver keeps, from `w` and the lead's speed now.
//!
//! `[w (d), v_lead (1)] → hidden → hidden → f̂ (1)`, all standardised. Trained by L1 over following rows.

use super::{Architecture, mlp::Mlp};

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
}
