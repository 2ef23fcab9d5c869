//! What a follower sees of the vehicle ahead.

/// A vehicle ahead in a lane that ego uses.
#[derive(Debug, Clone, Copy)]
pub struct Lead {
    /// Bumper to bumper, in m.
    pub gap_m: f64,
    /// Its speed, in m/s.
    pub speed_mps: f64,
}
