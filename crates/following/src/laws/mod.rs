//! Acceleration laws: from gap, ego speed and lead speed to an acceleration.

pub mod gipps;
pub mod helly;
pub mod idm;
pub mod idm_directions;
pub mod keep_distance;
pub mod newell;
pub mod time_gap;

/// A law with a few numbers to calibrate, each within bounds.
pub(super) trait Parametric: Copy + Sync {
    /// Lower and upper bound of each parameter.
    const BOUNDS: &'static [(f64, f64)];
    /// The law of `parameters`, in the order of [`Parametric::BOUNDS`].
    fn from_parameters(parameters: &[f64]) -> Self;
    /// Acceleration, in m/s².
    fn accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64;
}
