//! The Intelligent Driver Model.

use super::Parametric;
use serde::{Deserialize, Serialize};

/// Gap below which the law reads this gap, in m, so that a collision is a hard braking and not infinity.
const LEAST_GAP_M: f64 = 0.1;

/// The Intelligent Driver Model: a·(1 − (v/v0)⁴ − (s*/gap)²), s* = s0 + max(0, v·T + v·(v − v_lead)/(2√(a·b))).
///
/// # Source
/// Treiber, Hennecke and Helbing 2000.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Idm {
    /// v0: speed on a free road, in m/s.
    pub desired_speed_mps: f64,
    /// T: time gap, in s.
    pub time_gap_s: f64,
    /// s0: gap at standstill, in m.
    pub standstill_gap_m: f64,
    /// a: greatest acceleration, in m/s².
    pub max_accel_mps2: f64,
    /// b: comfortable braking, in m/s².
    pub comfortable_braking_mps2: f64,
}

impl Idm {
    /// Acceleration, in m/s².
    pub fn accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        let v = ego_speed_mps;
        let braking = 2.0 * (self.max_accel_mps2 * self.comfortable_braking_mps2).sqrt();
        let dynamic = v * self.time_gap_s + v * (v - lead_speed_mps) / braking;
        let desired = self.standstill_gap_m + dynamic.max(0.0);
        let free = (v / self.desired_speed_mps).powi(4);
        self.max_accel_mps2 * (1.0 - free - (desired / gap_m.max(LEAST_GAP_M)).powi(2))
    }

    /// v0, T, s0, a and b, in the order of the bounds.
    pub(super) fn parameters(&self) -> [f64; 5] {
        [
            self.desired_speed_mps,
            self.time_gap_s,
            self.standstill_gap_m,
            self.max_accel_mps2,
            self.comfortable_braking_mps2,
        ]
    }

    /// The same driver with another time gap, in s.
    #[must_use]
    pub fn with_time_gap_s(self, time_gap_s: f64) -> Self {
        Self { time_gap_s, ..self }
    }
}

impl Parametric for Idm {
    // A desired speed below 20 m/s would let congestion pass for a wish to go slowly.
    const BOUNDS: &'static [(f64, f64)] = &[
        (20.0, 50.0),
        (0.1, 4.0),
        (0.1, 10.0),
        (0.1, 4.0),
        (0.1, 6.0),
    ];

    fn from_parameters(p: &[f64]) -> Self {
        Self {
            desired_speed_mps: p[0],
            time_gap_s: p[1],
            standstill_gap_m: p[2],
            max_accel_mps2: p[3],
            comfortable_braking_mps2: p[4],
        }
    }

    fn accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        Self::accel_mps2(self, gap_m, ego_speed_mps, lead_speed_mps)
    }
}

#[cfg(test)]
mod tests {
    use crate::made_up::DRIVER;

    #[test]
    fn the_gap_at_which_idm_keeps_its_speed_is_the_published_one() {
        let v: f64 = 20.0;
        let gap = (DRIVER.standstill_gap_m + v * DRIVER.time_gap_s)
            / (1.0 - (v / DRIVER.desired_speed_mps).powi(4)).sqrt();
        assert!(DRIVER.accel_mps2(gap, v, v).abs() < 1e-12);
    }

    #[test]
    fn a_gap_of_zero_is_a_hard_braking() {
        let accel = DRIVER.accel_mps2(0.0, 10.0, 10.0);
        assert!(accel.is_finite() && accel < -8.0);
    }
}
