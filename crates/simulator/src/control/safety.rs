//! Responsibility-sensitive safety: the distance that is always kept.

use crate::scenario::ControllerSettings;
use maveric_domain::{Metres, MetresPerSecond};

/// Distance at which the vehicle behind can still stop if the one ahead brakes as hard as it can.
///
/// d = v_r ρ + a ρ²/2 + (v_r + a ρ)²/(2 b_own) − v_f²/(2 b_other), at least 0, with `rear` v_r and `front` v_f; plus
/// the margin of the settings.
///
/// # Source
/// Shalev-Shwartz, Shammah and Shashua 2017, Definition 1; numbers from calibration section 4. The usual ones
/// (reaction 1 s, braking 4 against 8) give 94 m at 30 m/s and erase every style.
pub fn safe_distance(
    settings: &ControllerSettings,
    rear: MetresPerSecond,
    front: MetresPerSecond,
) -> Metres {
    Metres(safe_distance_m(settings, rear.0, front.0) + settings.margin_m)
}

/// The same without the margin, in m and m/s.
pub(crate) fn safe_distance_m(s: &ControllerSettings, rear_mps: f64, front_mps: f64) -> f64 {
    let reaction = s.reaction_s;
    let fastest = rear_mps + s.reaction_acceleration_mps2 * reaction;
    let rolled = rear_mps * reaction + 0.5 * s.reaction_acceleration_mps2 * reaction * reaction;
    let braked = fastest * fastest / (2.0 * s.own_braking_mps2);
    let front = front_mps * front_mps / (2.0 * s.other_braking_mps2);
    (rolled + braked - front).max(0.0)
}

/// Distance between the sides of two vehicles that move towards each other with these lateral speeds, at which both can still
/// stop moving sideways without touching.
///
/// d = μ + Σ over both of (t + t_ρ)/2 · ρ + t_ρ |t_ρ| / (2 b), with t the speed towards the other, t_ρ = t + ρ a, at least μ.
///
/// # Source
/// Shalev-Shwartz, Shammah and Shashua 2017, Definition 6 (lateral safe distance); the numbers are chosen.
pub fn lateral_safe_distance(
    settings: &ControllerSettings,
    one: MetresPerSecond,
    other: MetresPerSecond,
) -> Metres {
    Metres(lateral_safe_distance_m(settings, one.0, other.0))
}

/// The same in m and m/s.
pub(super) fn lateral_safe_distance_m(s: &ControllerSettings, one_mps: f64, other_mps: f64) -> f64 {
    let needs = |towards_mps: f64| {
        let then = towards_mps + s.reaction_s * s.lateral_reaction_mps2;
        0.5 * (towards_mps + then) * s.reaction_s
            + then * then.abs() / (2.0 * s.lateral_braking_mps2)
    };
    s.lateral_margin_m + (needs(one_mps) + needs(other_mps)).max(0.0)
}

/// Braking that is needed not to come nearer than `margin_m`, in m/s², positive.
///
/// Counts on the lead keeping its braking `lead_braking_mps2` (positive) until it stands.
pub(crate) fn needed_braking_mps2(
    gap_m: f64,
    margin_m: f64,
    ego_mps: f64,
    lead_mps: f64,
    lead_braking_mps2: f64,
) -> f64 {
    let room = (gap_m - margin_m).max(0.1);
    let closing = ego_mps - lead_mps;
    if lead_braking_mps2 > 0.5 {
        let lead_stops_in = lead_mps * lead_mps / (2.0 * lead_braking_mps2);
        let to_stand = ego_mps * ego_mps / (2.0 * (room + lead_stops_in));
        // If the speeds meet before the lead stands, only that counts: stopping behind its last place would not help.
        let meets_first = closing > 0.0 && 2.0 * room / closing < lead_mps / lead_braking_mps2;
        return if meets_first {
            lead_braking_mps2 + closing * closing / (2.0 * room)
        } else if closing > 0.0 {
            to_stand
        } else {
            0.0
        };
    }
    if closing > 0.0 {
        closing * closing / (2.0 * room)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_thirty_metres_per_second_it_is_the_eighteen_metres_of_calibration() {
        let settings = ControllerSettings::PAPER;
        let bare = safe_distance_m(&settings, 30.0, 30.0);
        assert!((bare - 18.0).abs() < 0.6, "{bare}");
        let v = MetresPerSecond(30.0);
        assert!((safe_distance(&settings, v, v).0 - bare - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_vehicle_that_draws_away_needs_the_margin_only() {
        let settings = ControllerSettings::PAPER;
        let d = safe_distance(&settings, MetresPerSecond(20.0), MetresPerSecond(35.0));
        assert!((d.0 - settings.margin_m).abs() < 1e-12);
    }

    #[test]
    fn two_that_brake_sideways_in_time_come_no_nearer_than_the_lateral_margin() {
        let s = ControllerSettings::PAPER;
        for (mut one, mut other) in [(1.2_f64, 0.0_f64), (0.6, 0.9), (1.0, -0.3)] {
            let mut apart = lateral_safe_distance_m(&s, one, other);
            let step = 1e-4;
            for tick in 0..40_000 {
                let reacting = f64::from(tick) * step < s.reaction_s;
                for speed in [&mut one, &mut other] {
                    *speed += step
                        * if reacting {
                            s.lateral_reaction_mps2
                        } else {
                            -s.lateral_braking_mps2 * speed.signum()
                        };
                }
                apart -= (one + other) * step;
                assert!(apart > s.lateral_margin_m - 1e-3, "{apart}");
            }
        }
    }

    #[test]
    fn the_needed_braking_just_avoids_the_margin() {
        let needed = needed_braking_mps2(52.0, 2.0, 30.0, 20.0, 0.0);
        assert!((needed - 1.0).abs() < 1e-12);
    }
}
