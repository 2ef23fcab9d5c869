//! How a person's driving wanders within one drive.

use serde::{Deserialize, Serialize};

/// A value that wanders about its mean without a jump: white noise through two equal lags of `time_s`.
///
/// Its correlation after h seconds is (1 + h / `time_s`) e^(−h / `time_s`), and its rate of change has the SD `sd` / `time_s`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Wander {
    /// Standard deviation, in the value's unit.
    pub sd: f64,
    /// Time of each lag, in s.
    pub time_s: f64,
}

/// What wanders while one person drives; none where the drive did not show it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Variability {
    /// Speed on free road about the drive's mean, in m/s.
    pub free_speed: Option<Wander>,
    /// Logarithm of the time gap while following, about the mean behind each vehicle.
    pub gap: Option<Wander>,
    /// Place in the lane about the drive's mean, in m.
    pub place: Option<Wander>,
    /// Mean place in the lane, in m to the left of its centre.
    pub place_m: Option<f64>,
}
