//! Gipps' law.

use serde::{Deserialize, Serialize};

/// Gipps' law: the speed at which ego can still stop behind a leader that brakes, reached within the reaction time.
///
/// # Source
/// Gipps 1981, with his choice of half a reaction time as margin. He steps by the reaction time; here the speed it
/// asks for at the end of that time is approached evenly, so that the law can be asked at any rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Gipps {
    /// Speed on a free road, in m/s.
    pub desired_speed_mps: f64,
    /// Reaction time, in s.
    pub reaction_s: f64,
    /// Gap at standstill, in m.
    pub standstill_gap_m: f64,
    /// Greatest wished acceleration, in m/s².
    pub max_accel_mps2: f64,
    /// Hardest braking that ego is ready for, in m/s².
    pub ego_braking_mps2: f64,
    /// Hardest braking that ego expects of the leader, in m/s².
    pub lead_braking_mps2: f64,
}

impl Gipps {
    /// Acceleration, in m/s².
    #[inline]
    pub fn accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        let (v, tau, b) = (ego_speed_mps, self.reaction_s, self.ego_braking_mps2);
        let share = v / self.desired_speed_mps;
        let free =
            v + 2.5 * self.max_accel_mps2 * tau * (1.0 - share) * (0.025 + share.max(0.0)).sqrt();
        let lead_stops = lead_speed_mps * lead_speed_mps / self.lead_braking_mps2;
        let room = 2.0 * (gap_m - self.standstill_gap_m) - v * tau + lead_stops;
        let safe = (b * b * tau * tau + b * room).max(0.0).sqrt() - b * tau;
        (free.min(safe.max(0.0)) - v) / tau
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIPPS: Gipps = Gipps {
        desired_speed_mps: 30.0,
        reaction_s: 1.0,
        standstill_gap_m: 2.0,
        max_accel_mps2: 1.5,
        ego_braking_mps2: 3.0,
        lead_braking_mps2: 3.0,
    };

    #[test]
    fn equal_brakings_keep_one_and_a_half_reaction_times() {
        // With b = b̂ the speed is kept where 2(gap - s0) = 3vτ.
        let gap = 2.0 + 1.5 * 20.0;
        assert!(GIPPS.accel_mps2(gap, 20.0, 20.0).abs() < 1e-9);
    }

    #[test]
    fn the_free_road_ends_at_the_desired_speed_and_no_gap_at_standstill() {
        assert!(GIPPS.accel_mps2(1e4, 30.0, 30.0).abs() < 1e-9);
        assert!(GIPPS.accel_mps2(2.0, 0.0, 0.0).abs() < 1e-9);
        assert!(GIPPS.accel_mps2(0.0, 10.0, 0.0) < -8.0);
    }

    #[test]
    fn free_and_behind_somebody_it_is_the_speed_worked_out_by_hand() {
        let gipps = Gipps {
            desired_speed_mps: 40.0,
            reaction_s: 0.5,
            max_accel_mps2: 1.6,
            ego_braking_mps2: 2.0,
            lead_braking_mps2: 4.0,
            ..GIPPS
        };
        // 2.5 · 1.6 · 0.5 (1 - 9/40) √(0.025 + 9/40) = 2 · 0.775 · 0.5 faster after half a second.
        assert!((gipps.accel_mps2(1e4, 9.0, 9.0) - 1.55).abs() < 1e-12);
        // √(1 + 2 (2 · 10.25 - 10 · 0.5 + 8²/4)) - 1 = 7 m/s after half a second.
        assert!((gipps.accel_mps2(12.25, 10.0, 8.0) - (7.0 - 10.0) / 0.5).abs() < 1e-12);
    }
}
