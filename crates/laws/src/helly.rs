//! Helly's linear law.

use serde::{Deserialize, Serialize};

/// How hard ego steers to a speed and to a gap: k_v·(v_lead − v) + k_d·(gap − wanted gap).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Gains {
    /// k_v, in 1/s.
    pub speed_per_s: f64,
    /// k_d, in 1/s².
    pub gap_per_s2: f64,
}

impl Gains {
    /// Acceleration towards the leader's speed and `wanted_gap_m`, in m/s².
    #[inline]
    pub fn accel_mps2(
        self,
        gap_m: f64,
        wanted_gap_m: f64,
        ego_speed_mps: f64,
        lead_speed_mps: f64,
    ) -> f64 {
        self.speed_per_s * (lead_speed_mps - ego_speed_mps)
            + self.gap_per_s2 * (gap_m - wanted_gap_m)
    }
}

/// Helly's linear law: [`Gains`] towards a wanted gap that is a straight line in ego's speed.
///
/// # Source
/// Helly 1959. A line from below 0 m fits drivers whose time gap grows with speed better, and runs into the leader as they
/// stop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Helly {
    /// How hard it steers to the leader's speed and to the wanted gap.
    pub gains: Gains,
    /// Wanted gap at standstill, as the line has it, in m.
    pub standstill_gap_m: f64,
    /// Slope of the line, in s.
    pub time_gap_s: f64,
}

impl Helly {
    /// Acceleration, in m/s².
    #[inline]
    pub fn accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        let wanted = self.standstill_gap_m + self.time_gap_s * ego_speed_mps;
        self.gains
            .accel_mps2(gap_m, wanted, ego_speed_mps, lead_speed_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_metres_per_second_slower_and_five_metres_too_far_is_the_sum_of_both() {
        let helly = Helly {
            gains: Gains {
                speed_per_s: 0.5,
                gap_per_s2: 0.1,
            },
            standstill_gap_m: 2.0,
            time_gap_s: 1.5,
        };
        // Wanted: 2 + 1.5 · 10 = 17 m.
        assert!((helly.accel_mps2(22.0, 10.0, 12.0) - (0.5 * 2.0 + 0.1 * 5.0)).abs() < 1e-12);
    }
}
