//! The speeds and steps that a car can have.

/// Speed above which no car drives, in m/s.
pub(crate) const FASTEST_MPS: f64 = 90.0;
/// Speed below which a sample says little about units, in m/s.
pub(crate) const MOVING_MPS: f64 = 2.0;
/// Distance beyond the fastest drive from which a step is a jump, in m. Positions are known to some metres.
pub(crate) const JUMP_M: f64 = 10.0;
