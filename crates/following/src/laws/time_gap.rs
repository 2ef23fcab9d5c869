//! A constant time gap.

use super::helly::Gains;
use serde::{Deserialize, Serialize};

/// Keeps one time gap at every speed: [`Gains`] towards T·v.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ConstantTimeGap {
    /// T, in s.
    pub time_gap_s: f64,
    /// The gains.
    pub gains: Gains,
}

impl ConstantTimeGap {
    /// Gains of the adaptive cruise control of Milanés and Shladover 2014: 0.23 1/s² on the gap, 0.07 1/s on the speed.
    pub const GAINS: Gains = Gains {
        speed_per_s: 0.07,
        gap_per_s2: 0.23,
    };

    /// The time gap `time_gap_s` (s) with [`ConstantTimeGap::GAINS`].
    pub fn new(time_gap_s: f64) -> Self {
        Self {
            time_gap_s,
            gains: Self::GAINS,
        }
    }

    /// Acceleration, in m/s².
    pub fn accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        let wanted = self.time_gap_s * ego_speed_mps;
        self.gains
            .accel_mps2(gap_m, wanted, ego_speed_mps, lead_speed_mps)
    }
}
