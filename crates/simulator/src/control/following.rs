//! Following controller: f̂ behind a lead, and when it takes part.

use super::safety;
use crate::scenario::ControllerSettings;

/// A vehicle ahead in a lane that ego uses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lead {
    /// Bumper to bumper, in m.
    pub(super) gap_m: f64,
    /// Its speed, in m/s.
    pub(super) speed_mps: f64,
}

/// f̂': the distance asked for, or the safe one where that is longer, in m.
pub(super) fn kept_distance_m(
    settings: &ControllerSettings,
    asked_m: f64,
    speed_mps: f64,
    lead: Lead,
) -> f64 {
    let safe = safety::safe_distance_m(settings, speed_mps, lead.speed_mps) + settings.margin_m;
    asked_m.max(safe)
}

/// λ: the gap below which the following controller takes part, in m.
///
/// # Source
/// Calibration section 4: max(15 m, 0.7·f̂', safe distance + closing²/(2·2 m/s²)). A λ above the gap at which a
/// driver passes stops the car before the lane-change predictor may speak. The prototype's car was a point mass; ours
/// has lags and a jerk bound, so λ also covers the closing speed over `closing_response_s`.
pub(super) fn threshold_m(
    settings: &ControllerSettings,
    kept_m: f64,
    speed_mps: f64,
    lead: Lead,
) -> f64 {
    let safe = safety::safe_distance_m(settings, speed_mps, lead.speed_mps) + settings.margin_m;
    let closing = (speed_mps - lead.speed_mps).max(0.0);
    let braking = closing * closing / (2.0 * settings.closing_braking_mps2)
        + closing * settings.closing_response_s;
    settings
        .following_threshold_m
        .max(settings.following_threshold_factor * kept_m)
        .max(safe + braking)
}

/// Acceleration wanted behind `lead`, in m/s², where the velocity controller wants `cruise_mps2`.
///
/// From λ down it is the smaller of the two, above λ and the hand-over band it is `cruise_mps2`, in between a mixture. Proportional on the
/// difference of speeds, whose integral is the error of the gap: a PI controller.
pub(super) fn command(
    settings: &ControllerSettings,
    asked_m: f64,
    speed_mps: f64,
    lead: Lead,
    cruise_mps2: f64,
    change_is_due: bool,
) -> f64 {
    let kept = kept_distance_m(settings, asked_m, speed_mps, lead);
    let below = threshold_m(settings, kept, speed_mps, lead) - lead.gap_m;
    let share = (1.0 + below / settings.handover_band_m).clamp(0.0, 1.0);
    let follow = settings.gap_gain_per_s2 * (lead.gap_m - kept)
        + settings.speed_difference_gain_per_s * (lead.speed_mps - speed_mps);
    let one_sided = cruise_mps2 + share * (follow.min(cruise_mps2) - cruise_mps2);
    let met = if change_is_due {
        0.0
    } else {
        met_share(settings, speed_mps, lead)
    };
    one_sided + met * (follow - one_sided)
}

/// How far ego has settled behind `lead`: 1 at equal speeds within a time gap of [`FOLLOWS_WITHIN_S`], 0 from
/// `met_within_mps` of difference up.
///
/// # Source
/// Method section 5: λ short while closing in, F alone once the speeds have met and no change is due.
fn met_share(settings: &ControllerSettings, speed_mps: f64, lead: Lead) -> f64 {
    let within = settings.met_within_mps;
    if within <= 0.0 || lead.gap_m > FOLLOWS_WITHIN_S * speed_mps {
        return 0.0;
    }
    (2.0 - 2.0 * (speed_mps - lead.speed_mps).abs() / within).clamp(0.0, 1.0)
}

/// Time gap within which ego counts as following, in s: that of the method's following rows.
const FOLLOWS_WITHIN_S: f64 = 3.0;

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: ControllerSettings = ControllerSettings::PAPER;

    #[test]
    fn it_stays_out_of_the_way_at_the_gap_where_people_pass() {
        let lead = Lead {
            gap_m: 45.0,
            speed_mps: 27.0,
        };
        let wanted = command(&SETTINGS, 40.0, 30.0, lead, 0.3, false);
        assert!((wanted - 0.3).abs() < 1e-12);
    }

    #[test]
    fn no_asked_gap_is_kept_below_the_safe_distance() {
        let lead = Lead {
            gap_m: 15.0,
            speed_mps: 28.0,
        };
        let kept = kept_distance_m(&SETTINGS, 0.0, 30.0, lead);
        assert!((kept - safety::safe_distance_m(&SETTINGS, 30.0, 28.0) - 2.0).abs() < 1e-12);
        assert!(command(&SETTINGS, 0.0, 30.0, lead, 2.0, false) < 0.0);
    }

    #[test]
    fn at_the_asked_gap_and_equal_speeds_it_asks_for_nothing() {
        let lead = Lead {
            gap_m: 14.9,
            speed_mps: 10.0,
        };
        let near = ControllerSettings {
            following_threshold_m: 30.0,
            ..SETTINGS
        };
        assert!(command(&near, 14.9, 10.0, lead, 2.0, false).abs() < 1e-12);
    }

    #[test]
    fn once_speeds_have_met_f_leads_both_ways_and_yields_to_a_change() {
        let met = ControllerSettings {
            met_within_mps: 1.0,
            ..SETTINGS
        };
        let lead = Lead {
            gap_m: 60.0,
            speed_mps: 28.0,
        };
        // 20 m too far: F speeds up although V asks for less; with a change due V's wish stands.
        let wanted = command(&met, 40.0, 28.0, lead, 0.1, false);
        assert!((wanted - 0.8).abs() < 1e-12);
        assert!((command(&met, 40.0, 28.0, lead, 0.1, true) - 0.1).abs() < 1e-12);
        // Still closing in at 3 m/s: as without the rule.
        assert!((command(&met, 40.0, 31.0, lead, 0.1, false) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn the_hand_over_does_not_jump() {
        let mut last = None;
        for tenth in 0..600 {
            let lead = Lead {
                gap_m: 60.0 - 0.1 * f64::from(tenth),
                speed_mps: 26.0,
            };
            let wanted = command(&SETTINGS, 40.0, 30.0, lead, 0.5, false);
            if let Some(last) = last.replace(wanted) {
                assert!((wanted - last).abs() < 0.15);
            }
        }
        assert!(last.unwrap() < -2.0);
    }
}
