//! V_β: ego's speed, from `w` and windows of v_lead, d_x and d_y.
//!
//! Windows `(3 × steps) → hidden → z_v`; then `[w, z_v] → hidden → hidden → v̂ (1)`, standardised. Trained by
//! L3. V never reads ego's own speed: that would teach it to copy.

use super::{Architecture, encoded::Encoded};

/// The sub-network V_β.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Velocity {
    pub(crate) encoded: Encoded,
}

impl Velocity {
    pub(crate) fn new(offset: &mut usize, architecture: &Architecture) -> Self {
        Self {
            encoded: Encoded::new(offset, architecture, 1),
        }
    }
}
