//! Following controller: f̂ behind a lead, and when it takes part.

use super::{idm, lead::Lead, safety};
use crate::scenario::{ControllerSettings, FollowingRule};

/// Opening speed asked for at most where the gap is too short, in m/s: a car that cut in is let go, not fled from.
const OPENS_AT_MPS: f64 = 3.0;

/// f̂': the distance asked for, or the safe one where that is longer, in m.
fn kept_distance_m(settings: &ControllerSettings, asked_m: f64, speed_mps: f64, lead: Lead) -> f64 {
    let safe = safety::safe_distance_m(settings, speed_mps, lead.speed_mps) + settings.margin_m;
    asked_m.max(safe)
}

/// Acceleration wanted behind `lead`, in m/s², to keep `asked_m` (m) or the safe distance where that is longer, at `speed_mps` (m/s), where
/// the velocity controller wants `cruise_mps2`: never more than that.
pub fn following_acceleration(
    settings: &ControllerSettings,
    asked_m: f64,
    speed_mps: f64,
    lead: Lead,
    cruise_mps2: f64,
) -> f64 {
    let kept = kept_distance_m(settings, asked_m, speed_mps, lead);
    match settings.following_rule {
        FollowingRule::AskedGap => settling(settings, kept, speed_mps, lead).min(cruise_mps2),
        FollowingRule::Idm => {
            idm::acceleration_mps2(settings, kept, speed_mps, lead).min(cruise_mps2)
        }
        FollowingRule::Paper => below_threshold(settings, kept, speed_mps, lead, cruise_mps2),
    }
}

/// Towards the gap `kept_m`, without going past it: the closing speed falls with what is left, linearly near the end and before that by a
/// braking of `approach_braking_mps2`.
///
/// With gains k on speed and c on the gap the gap obeys ë + k ė + k c e = 0: critically damped at c = k / 4.
fn settling(settings: &ControllerSettings, kept_m: f64, speed_mps: f64, lead: Lead) -> f64 {
    let left_m = lead.gap_m - kept_m;
    let linear = settings.approach_gain_per_s * left_m;
    let closing = if left_m > 0.0 {
        linear.min((2.0 * settings.approach_braking_mps2 * left_m).sqrt())
    } else {
        linear.max(-OPENS_AT_MPS)
    };
    settings.following_gain_per_s * (lead.speed_mps + closing - speed_mps)
}

/// λ: the gap below which the paper's following controller takes part, in m.
///
/// # Source
/// Calibration section 4: max(15 m, 0.7·f̂', safe distance + closing²/(2·2 m/s²)). A λ above the gap at which a
/// driver passes stops the car before the lane-change predictor may speak. The prototype's car was a point mass; ours
/// has lags and a jerk bound, so λ also covers the closing speed over `closing_response_s`.
fn threshold_m(settings: &ControllerSettings, kept_m: f64, speed_mps: f64, lead: Lead) -> f64 {
    let safe = safety::safe_distance_m(settings, speed_mps, lead.speed_mps) + settings.margin_m;
    let closing = (speed_mps - lead.speed_mps).max(0.0);
    let braking = closing * closing / (2.0 * settings.closing_braking_mps2)
        + closing * settings.closing_response_s;
    settings
        .following_threshold_m
        .max(settings.following_threshold_factor * kept_m)
        .max(safe + braking)
}

/// From λ down it is the smaller of following and velocity, above λ and the hand-over band it is `cruise_mps2`, in between a mixture.
/// Proportional on the difference of speeds, whose integral is the error of the gap: a PI controller.
fn below_threshold(
    settings: &ControllerSettings,
    kept_m: f64,
    speed_mps: f64,
    lead: Lead,
    cruise_mps2: f64,
) -> f64 {
    let below = threshold_m(settings, kept_m, speed_mps, lead) - lead.gap_m;
    let share = (1.0 + below / settings.handover_band_m).clamp(0.0, 1.0);
    let follow = settings.gap_gain_per_s2 * (lead.gap_m - kept_m)
        + settings.speed_difference_gain_per_s * (lead.speed_mps - speed_mps);
    cruise_mps2 + share * (follow.min(cruise_mps2) - cruise_mps2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::AT_ONCE;
    use std::sync::LazyLock;

    static ASKED: LazyLock<ControllerSettings> = LazyLock::new(ControllerSettings::default);

    fn paper() -> ControllerSettings {
        ASKED.literal()
    }

    #[test]
    fn the_papers_rule_stays_out_of_the_way_at_the_gap_where_people_pass() {
        let lead = Lead { gap_m: 45.0, speed_mps: 27.0 };
        let wanted = following_acceleration(&paper(), 40.0, 30.0, lead, 0.3);
        assert!((wanted - 0.3).abs() < 1e-12);
    }

    #[test]
    fn no_asked_gap_is_kept_below_the_safe_distance() {
        let lead = Lead { gap_m: 15.0, speed_mps: 28.0 };
        let kept = kept_distance_m(&ASKED, 0.0, 30.0, lead);
        assert!((kept - safety::safe_distance_m(&ASKED, 30.0, 28.0) - 2.0).abs() < 1e-12);
        for settings in [ASKED.clone(), paper()] {
            assert!(following_acceleration(&settings, 0.0, 30.0, lead, 2.0) < 0.0);
        }
    }

    #[test]
    fn at_the_asked_gap_and_equal_speeds_it_asks_for_nothing() {
        let lead = Lead { gap_m: 14.9, speed_mps: 10.0 };
        for settings in [ASKED.clone(), paper()] {
            let near = ControllerSettings { following_threshold_m: 30.0, ..settings };
            assert!(following_acceleration(&near, 14.9, 10.0, lead, 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn it_never_asks_for_more_than_the_velocity_controller() {
        let far = Lead { gap_m: 150.0, speed_mps: 33.0 };
        assert!((following_acceleration(&ASKED, 40.0, 30.0, far, 0.1) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn the_papers_hand_over_does_not_jump() {
        let mut last = None;
        for tenth in 0..600 {
            let lead = Lead { gap_m: 60.0 - 0.1 * f64::from(tenth), speed_mps: 26.0 };
            let wanted = following_acceleration(&paper(), 40.0, 30.0, lead, 0.5);
            if let Some(last) = last.replace(wanted) {
                assert!((wanted - last).abs() < 0.15);
            }
        }
        assert!(last.unwrap() < -2.0);
    }

    #[test]
    fn the_closing_speed_falls_with_what_is_left_of_the_way() {
        for (gap_m, asked_m, ego, closing) in [
            // 3 m left, 0.3 of it a second; 48 m left, from where 1.5 m/s² lead to a stop.
            (33.0, 30.0, 20.0, 0.9),
            (88.0, 40.0, 30.0, 12.0),
            // Too near by 5 m, and by 20, for which 3 m/s must do.
            (25.0, 30.0, 20.0, -1.5),
            (10.0, 30.0, 20.0, -3.0),
            // The safe distance is the longer one: (30² - 20²) / 16 and 2 m.
            (33.25, 10.0, 30.0, 0.0),
        ] {
            let speed_mps = 20.0;
            let wanted =
                following_acceleration(&AT_ONCE, asked_m, ego, Lead { gap_m, speed_mps }, 9.0);
            let expected = 1.2 * (speed_mps + closing - ego);
            assert!((wanted - expected).abs() < 1e-9, "{gap_m}: {wanted}");
        }
    }

    #[test]
    fn the_papers_rule_takes_over_within_its_band() {
        let rule = AT_ONCE.literal();
        for (gap_m, asked_m, ego, expected) in [
            // λ is 15 m, and half a band of 3 m above it half of each counts.
            (16.5, 20.0, 20.0, 1.0 + 0.5 * (0.04 * -3.5 - 1.0)),
            // λ is 0.7 of what is asked.
            (21.0, 30.0, 20.0, 0.04 * -9.0),
            (24.0, 30.0, 20.0, 1.0),
            // λ is the safe distance of 11 + 2 m and 4² / 4 + 4 · 0.3 for closing in.
            (19.7, 20.0, 24.0, 1.0 + 0.5 * (0.04 * -0.3 - 2.0 - 1.0)),
            (18.2, 20.0, 24.0, 0.04 * -1.8 - 2.0),
        ] {
            let speed_mps = 20.0;
            let wanted =
                following_acceleration(&rule, asked_m, ego, Lead { gap_m, speed_mps }, 1.0);
            assert!((wanted - expected).abs() < 1e-9, "{gap_m}: {wanted}");
        }
    }
}
