//! When a lane change starts, how long it takes, and whether it may.

use super::safety::safe_distance_m;
use crate::{
    neighbours::{Neighbour, ahead, ahead_or_entering, behind_or_entering},
    scenario::{ChangeRule, ControllerSettings},
};
use maveric_domain::{Reference, Road, Scene, VehicleId};

/// Collects P(change) until it suffices.
///
/// # Source
/// Calibration section 4: Λ = Σ −ln(1 − P) per second since this reference vehicle became the reference or the last change
/// ended. Without a reference vehicle there is nothing to pass and nothing is collected (ours).
#[derive(Debug, Clone, Default)]
pub(super) struct Wish {
    reference: Option<VehicleId>,
    hazard: f64,
}

/// P is taken as at most this, so that Λ stays finite.
const SUREST: f64 = 1.0 - 1e-9;

impl Wish {
    /// Forgets what was collected: a change has ended.
    pub(super) fn reset(&mut self) {
        self.hazard = 0.0;
    }

    /// Takes the present P(change) and says whether a change is due.
    pub(super) fn due(
        &mut self,
        settings: &ControllerSettings,
        reference: &Reference,
        probability: f64,
        moving_out: bool,
        step_s: f64,
    ) -> bool {
        if reference.vehicle != self.reference {
            self.reference = reference.vehicle;
            self.hazard = 0.0;
        }
        if reference.vehicle.is_some() {
            self.hazard -= (-probability.min(SUREST)).ln_1p() * step_s;
        }
        match settings.change_rule {
            ChangeRule::Accumulated if moving_out => self.hazard > settings.hazard_threshold,
            ChangeRule::Accumulated => self.hazard > settings.merge_back_hazard_threshold,
            ChangeRule::Paper => probability > settings.probability_threshold,
        }
    }
}

/// The lane that a change due now goes to, from `here`.
///
/// Out of the right lane to the left, out of the leftmost to the right, as on the paper's two lanes; in between to the
/// left while the reference vehicle is ahead in ego's lane, and back once it is not (ours).
pub(super) fn target_lane(road: &Road, here: u8, reference: &Reference) -> u8 {
    let own_lane = reference.dy_m.abs() < 0.5 * road.lane_width_m;
    let to_pass = reference.vehicle.is_some() && own_lane && reference.dx_m > 0.0;
    let leftmost = here + 1 >= road.lanes;
    if here == 0 || (to_pass && !leftmost) {
        here + 1
    } else {
        here - 1
    }
}

/// Whether the gaps in `lane` pass the safety rule with `margin_m` on top: to who is there and to who is about to be, by `claims`.
pub(super) fn gaps_are_safe(
    settings: &ControllerSettings,
    scene: &Scene,
    road: &Road,
    lane: u8,
    claims: &[Option<u8>],
    margin_m: f64,
) -> bool {
    let ego = scene.ego.speed_mps;
    let ahead_safe = ahead_or_entering(scene, road, lane, claims)
        .is_none_or(|n| n.gap_m > safe_distance_m(settings, ego, n.vehicle.speed_mps) + margin_m);
    let behind_safe = behind_or_entering(scene, road, lane, claims)
        .is_none_or(|n| n.gap_m > safe_distance_m(settings, n.vehicle.speed_mps, ego) + margin_m);
    ahead_safe && behind_safe
}

/// How long a change takes with `lead` ahead in the lane left; `None` if ego would meet it before half of that.
///
/// # Source
/// Calibration section 4. A fixed 4.8 s made Aggressive hit the lead that it was passing.
pub(super) fn duration_s(
    settings: &ControllerSettings,
    ego_mps: f64,
    lead: Option<Neighbour>,
) -> Option<f64> {
    let longest = settings.change_longest_s;
    let Some(lead) = lead else {
        return Some(longest);
    };
    let closing = ego_mps - lead.vehicle.speed_mps;
    let room = lead.gap_m - settings.change_reserve_m;
    if room <= 0.0 {
        return None;
    }
    if closing <= 0.0 {
        return Some(longest);
    }
    let meets_in = room / closing;
    let duration = (settings.change_time_factor * meets_in)
        .max(settings.change_shortest_s)
        .min(longest);
    (meets_in > 0.5 * duration).then_some(duration)
}

/// Counts how long the car has been in the passing lane with nobody to pass.
///
/// # Source
/// Calibration section 4, the return rule: the lane-change predictor does not read its lane, so once the tracker drops the passed
/// vehicle it sees free road and would stay left for ever.
#[derive(Debug, Clone, Default)]
pub(super) struct ReturnRule {
    idle_s: f64,
}

impl ReturnRule {
    /// Whether to go back one lane to the right now.
    pub(super) fn due(
        &mut self,
        settings: &ControllerSettings,
        scene: &Scene,
        road: &Road,
        reference: &Reference,
        step_s: f64,
    ) -> bool {
        let reference_lane = road.lane_at(scene.ego.y_m + reference.dy_m);
        let here = road.lane_at(scene.ego.y_m);
        let passing = reference.vehicle.is_some() && reference_lane < here;
        if here == 0 || passing {
            self.idle_s = 0.0;
            return false;
        }
        self.idle_s += step_s;
        self.idle_s > settings.return_after_s
            && ahead(scene, road, here - 1)
                .is_none_or(|n| n.gap_m > settings.return_free_s * scene.ego.speed_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::VehicleState;

    const SETTINGS: ControllerSettings = ControllerSettings::PAPER;

    fn lead(gap_m: f64, speed_mps: f64) -> Neighbour {
        let vehicle = VehicleState {
            id: VehicleId(1),
            x_m: 0.0,
            y_m: 0.0,
            speed_mps,
            length_m: 4.7,
        };
        Neighbour { vehicle, gap_m }
    }

    fn reference(id: u32) -> Reference {
        Reference {
            vehicle: Some(VehicleId(id)),
            ..Reference::free_road(&Road::PAPER)
        }
    }

    #[test]
    fn small_probabilities_add_up_to_a_change() {
        let mut wish = Wish::default();
        let due = |wish: &mut Wish| wish.due(&SETTINGS, &reference(1), 0.1, true, 0.05);
        let ticks = (0..1000).take_while(|_| !due(&mut wish)).count();
        // 0.4 / -ln(0.9) = 3.8 s.
        assert!((ticks as f64 * 0.05 - 3.8).abs() < 0.1, "{ticks}");
    }

    #[test]
    fn moving_out_and_merging_back_have_their_own_thresholds() {
        let later = ControllerSettings {
            merge_back_hazard_threshold: 0.8,
            ..SETTINGS
        };
        let ticks = |moving_out| {
            let mut wish = Wish::default();
            let due = |wish: &mut Wish| wish.due(&later, &reference(1), 0.1, moving_out, 0.05);
            (0..1000).take_while(|_| !due(&mut wish)).count()
        };
        assert!(ticks(false).abs_diff(2 * ticks(true)) <= 2);
    }

    #[test]
    fn another_reference_vehicle_starts_the_count_again() {
        let mut wish = Wish::default();
        for _ in 0..70 {
            assert!(!wish.due(&SETTINGS, &reference(1), 0.1, true, 0.05));
        }
        for _ in 0..70 {
            assert!(!wish.due(&SETTINGS, &reference(2), 0.1, true, 0.05));
        }
    }

    #[test]
    fn the_rule_of_the_paper_looks_at_this_moment_only() {
        let settings = ControllerSettings {
            change_rule: ChangeRule::Paper,
            ..SETTINGS
        };
        let mut wish = Wish::default();
        for _ in 0..2000 {
            assert!(!wish.due(&settings, &reference(1), 0.19, true, 0.05));
        }
        assert!(wish.due(&settings, &reference(1), 0.21, true, 0.05));
    }

    #[test]
    fn between_two_lanes_a_change_passes_what_is_ahead_and_else_goes_back() {
        let road = Road {
            lanes: 4,
            ..Road::PAPER
        };
        let seen = |dx_m, dy_m| Reference {
            dx_m,
            dy_m,
            ..reference(1)
        };
        assert_eq!(target_lane(&road, 0, &Reference::free_road(&road)), 1);
        assert_eq!(target_lane(&road, 1, &seen(30.0, 0.1)), 2);
        assert_eq!(target_lane(&road, 2, &seen(-30.0, -3.6)), 1);
        assert_eq!(target_lane(&road, 3, &seen(30.0, 0.0)), 2);
        assert_eq!(target_lane(&Road::PAPER, 1, &seen(30.0, 0.0)), 0);
    }

    #[test]
    fn a_change_is_quicker_near_the_lead_and_refused_too_near() {
        assert_eq!(
            duration_s(&SETTINGS, 30.0, Some(lead(60.0, 27.0))),
            Some(4.8)
        );
        let quick = duration_s(&SETTINGS, 30.0, Some(lead(13.0, 25.0))).unwrap();
        assert!((quick - 3.0).abs() < 1e-9, "{quick}");
        assert_eq!(duration_s(&SETTINGS, 30.0, Some(lead(8.0, 25.0))), None);
        assert_eq!(duration_s(&SETTINGS, 30.0, Some(lead(2.0, 35.0))), None);
    }
}
