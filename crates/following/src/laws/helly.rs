//! Helly's linear law.

use super::Parametric;
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
/// Helly 1959. The bounds of the calibration are ours: gains 0.01-2 1/s and 0.001-0.5 1/s², at standstill
/// 0-10 m, slope 0.1-4 s. A line from below 0 m fits drivers
/// whose time gap grows with speed better, and runs into the leader as they stop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Helly {
    /// The gains.
    pub gains: Gains,
    /// Wanted gap at standstill, as the line has it, in m.
    pub standstill_gap_m: f64,
    /// Slope of the line, in s.
    pub time_gap_s: f64,
}

impl Helly {
    /// Acceleration, in m/s².
    pub fn accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        let wanted = self.standstill_gap_m + self.time_gap_s * ego_speed_mps;
        self.gains
            .accel_mps2(gap_m, wanted, ego_speed_mps, lead_speed_mps)
    }
}

impl Parametric for Helly {
    // Gains by their logarithm: soft steering (0.01 1/s²) fits some drivers best and is a sliver of the straight range.
    const BOUNDS: &'static [(f64, f64)] = &[(-4.6, 0.7), (-6.9, -0.7), (0.0, 10.0), (0.1, 4.0)];

    fn from_parameters(p: &[f64]) -> Self {
        Self {
            gains: Gains {
                speed_per_s: p[0].exp(),
                gap_per_s2: p[1].exp(),
            },
            standstill_gap_m: p[2],
            time_gap_s: p[3],
        }
    }

    fn accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        Self::accel_mps2(self, gap_m, ego_speed_mps, lead_speed_mps)
    }
}
