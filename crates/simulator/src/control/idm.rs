//! The intelligent-driver model as the car's follower.

use super::lead::Lead;
use crate::scenario::ControllerSettings;
use maveric_laws::Idm;

/// a: greatest acceleration of the model, in m/s²; chosen, so that a car whose lead drives off stays below 2 m/s².
const MAX_ACCEL_MPS2: f64 = 1.5;

/// Acceleration towards `kept_m` (m) behind `lead`, in m/s²: a·(1 − (s*/gap)²), 0 at that gap and at the lead's speed.
///
/// The planner asks for a gap, not for a time gap: it stands in the place of s0 + v·T. The speed on a free road is the
/// velocity controller's, so the model's term for it is left out. Comfortable braking is `approach_braking_mps2`.
///
/// # Source
/// Treiber, Hennecke and Helbing 2000; the two replacements are ours.
pub(super) fn acceleration_mps2(
    settings: &ControllerSettings,
    kept_m: f64,
    speed_mps: f64,
    lead: Lead,
) -> f64 {
    let idm = Idm {
        desired_speed_mps: f64::INFINITY,
        time_gap_s: 0.0,
        standstill_gap_m: kept_m,
        max_accel_mps2: MAX_ACCEL_MPS2,
        comfortable_braking_mps2: settings.approach_braking_mps2,
    };
    idm.accel_mps2(lead.gap_m, speed_mps, lead.speed_mps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{control::following_acceleration, scenario::FollowingRule, testing::AT_ONCE};

    fn wanted(gap_m: f64, ego_mps: f64, cruise_mps2: f64) -> f64 {
        let settings = ControllerSettings { following_rule: FollowingRule::Idm, ..AT_ONCE.clone() };
        let lead = Lead { gap_m, speed_mps: 20.0 };
        following_acceleration(&settings, 30.0, ego_mps, lead, cruise_mps2)
    }

    #[test]
    fn it_is_the_law_worked_out_by_hand() {
        for (gap_m, ego_mps, expected) in [
            // At the asked gap and the lead's speed nothing is missing.
            (30.0, 20.0, 0.0),
            // Twice as far: 1.5 (1 - 1/4); at half the gap: 1.5 (1 - 4).
            (60.0, 20.0, 1.125),
            (15.0, 20.0, -4.5),
            // 3 m/s faster: s* = 30 + 23 · 3 / (2 · 1.5) = 53 m.
            (53.0, 23.0, 0.0),
            (26.5, 23.0, -4.5),
        ] {
            let found = wanted(gap_m, ego_mps, 9.0);
            assert!((found - expected).abs() < 1e-9, "{gap_m}: {found}");
        }
    }

    #[test]
    fn it_never_asks_for_more_than_the_velocity_controller() {
        assert!((wanted(150.0, 20.0, 0.1) - 0.1).abs() < 1e-12);
        assert!(wanted(15.0, 20.0, 0.1) < -4.0);
    }
}
