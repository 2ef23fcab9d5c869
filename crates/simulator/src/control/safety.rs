//! Responsibility-sensitive safety: the distance that is always kept.

use crate::scenario::ControllerSettings;
use maveric_domain::{Metres, MetresPerSecond};
use maveric_laws::{LateralRss, Rss};

/// Distance at which the vehicle behind can still stop if the one ahead brakes as hard as it can.
///
/// [`Rss::distance_m`] plus the margin of the settings.
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
    let rule = Rss {
        reaction_s: s.reaction_s,
        reaction_accel_mps2: s.reaction_acceleration_mps2,
        ego_braking_mps2: s.own_braking_mps2,
        lead_braking_mps2: s.other_braking_mps2,
        standstill_gap_m: 0.0,
    };
    rule.distance_m(rear_mps, front_mps)
}

/// Distance in m between the sides of two vehicles that move towards each other with these lateral speeds in m/s, at which
/// both can still stop moving sideways without touching.
///
/// [`LateralRss::distance_m`].
///
/// # Source
/// Shalev-Shwartz, Shammah and Shashua 2017, Definition 6 (lateral safe distance); the numbers are chosen.
pub(super) fn lateral_safe_distance_m(s: &ControllerSettings, one_mps: f64, other_mps: f64) -> f64 {
    let rule = LateralRss {
        margin_m: s.lateral_margin_m,
        reaction_s: s.reaction_s,
        reaction_mps2: s.lateral_reaction_mps2,
        braking_mps2: s.lateral_braking_mps2,
    };
    rule.distance_m(one_mps, other_mps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_thirty_metres_per_second_it_is_the_eighteen_metres_of_calibration() {
        let settings = ControllerSettings::default();
        let bare = safe_distance_m(&settings, 30.0, 30.0);
        // Reacting 0.3 · 30.15, stopping 30.3² / 14, less the other's 30² / 16.
        assert!((bare - (9.045 + 918.09 / 14.0 - 56.25)).abs() < 1e-9);
        let v = MetresPerSecond(30.0);
        assert!((safe_distance(&settings, v, v).0 - bare - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_vehicle_that_draws_away_needs_the_margin_only() {
        let settings = ControllerSettings::default();
        let d = safe_distance(&settings, MetresPerSecond(20.0), MetresPerSecond(35.0));
        assert!((d.0 - settings.margin_m).abs() < 1e-12);
    }

    #[test]
    fn sideways_both_react_and_both_brake() {
        let settings = ControllerSettings::default();
        let found = lateral_safe_distance_m(&settings, 1.0, 0.5);
        // Within 0.3 s they are 0.06 m/s faster; then each brakes by 0.8 m/s².
        let reacting = 0.3 * (1.03 + 0.53);
        let stopping = (1.06 * 1.06 + 0.56 * 0.56) / 1.6;
        assert!((found - (0.2 + reacting + stopping)).abs() < 1e-12, "{found}");
    }
}
