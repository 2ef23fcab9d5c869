//! How long a lane change takes, and whether it may start.

use super::safety::safe_distance_m;
use crate::{
    neighbours::{Neighbour, ahead, ahead_or_entering, behind_or_entering},
    scenario::ControllerSettings,
};
use maveric_domain::{Reference, Road, Scene};

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
    let duration =
        (settings.change_time_factor * meets_in).max(settings.change_shortest_s).min(longest);
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
        let ego_lane = road.nearest_lane(scene.ego.y_m);
        let passing =
            reference.vehicle.is_some() && reference_lane.is_some_and(|lane| lane < ego_lane);
        if ego_lane == 0 || passing {
            self.idle_s = 0.0;
            return false;
        }
        self.idle_s += step_s;
        self.idle_s > settings.return_after_s
            && ahead(scene, road, ego_lane - 1)
                .is_none_or(|n| n.gap_m > settings.return_free_s * scene.ego.speed_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{AT_ONCE, other, scene};
    use maveric_domain::{VehicleId, VehicleState};
    use std::sync::LazyLock;

    static SETTINGS: LazyLock<ControllerSettings> = LazyLock::new(ControllerSettings::default);

    fn lead(gap_m: f64, speed_mps: f64) -> Neighbour {
        let vehicle =
            VehicleState { id: VehicleId(1), x_m: 0.0, y_m: 0.0, speed_mps, length_m: 4.7 };
        Neighbour { vehicle, gap_m }
    }

    #[test]
    fn a_change_is_quicker_near_the_lead_and_refused_too_near() {
        assert_eq!(duration_s(&SETTINGS, 30.0, Some(lead(60.0, 27.0))), Some(4.8));
        let quick = duration_s(&SETTINGS, 30.0, Some(lead(13.0, 25.0))).unwrap();
        assert!((quick - 3.0).abs() < 1e-9, "{quick}");
        assert_eq!(duration_s(&SETTINGS, 30.0, Some(lead(8.0, 25.0))), None);
        assert_eq!(duration_s(&SETTINGS, 30.0, Some(lead(2.0, 35.0))), None);
    }

    #[test]
    fn a_change_lasts_half_again_the_way_to_the_lead_between_its_bounds() {
        for (gap_m, lead_mps, expected) in [
            // 20 m to go at 10 m/s; 13 m, for which 2.5 s are the least; 12 m, where ego would be there before half of them.
            (23.0, 20.0, Some(3.0)),
            (16.0, 20.0, Some(2.5)),
            (15.0, 20.0, None),
            // Who is no slower is never met, but for one that is within the reserve already.
            (3.1, 30.0, Some(4.8)),
            (3.0, 40.0, None),
        ] {
            let found = duration_s(&SETTINGS, 30.0, Some(lead(gap_m, lead_mps)));
            assert_eq!(found, expected, "{gap_m}");
        }
        assert_eq!(duration_s(&SETTINGS, 30.0, None), Some(4.8));
    }

    #[test]
    fn gaps_are_safe_where_both_are_beyond_distance_and_margin() {
        // Ahead (20² - 12²) / 16 and 3 m, behind (28² - 20²) / 16 and 3 m.
        let safe = |ahead_m: f64, behind_m: f64, claims: [Option<u8>; 3]| {
            let left = 3.66;
            let vehicles = [
                other(1, ahead_m, left, 12.0),
                other(2, -behind_m, left, 28.0),
                other(3, 10.0, 0.0, 12.0),
            ];
            let scene = scene(0.0, 20.0, &vehicles);
            gaps_are_safe(&AT_ONCE, &scene, &Road::PAPER, 1, &claims, 3.0)
        };
        assert!(safe(19.1, 27.1, [None; 3]));
        assert!(!safe(18.9, 27.1, [None; 3]) && !safe(19.1, 26.9, [None; 3]));
        assert!(!safe(19.1, 27.1, [None, None, Some(1)]), "the third means to go there");
    }

    #[test]
    fn with_nobody_to_pass_the_car_goes_back_after_a_while_where_there_is_room() {
        let road = Road::PAPER;
        let free = Reference::free_road(&road);
        let passed = |dy_m: f64| Reference { vehicle: Some(VehicleId(1)), dy_m, ..free };
        let steps = |y_m: f64, ahead_m: f64, reference: Reference| {
            let scene = scene(y_m, 20.0, &[other(1, ahead_m, 0.0, 20.0)]);
            let mut rule = ReturnRule::default();
            (1..100).find(|_| rule.due(&SETTINGS, &scene, &road, &reference, 0.5))
        };
        // Above 8 s; 4 s at 20 m/s must be free on the right.
        assert_eq!(steps(3.66, 80.1, free), Some(17));
        assert_eq!(steps(3.66, 80.0, free), None);
        assert_eq!(steps(3.66, 80.1, passed(0.0)), Some(17), "ahead in the same lane");
        assert_eq!(steps(3.66, 80.1, passed(-3.66)), None);
        assert_eq!(steps(0.0, 80.1, free), None);
        // Whoever is passed meanwhile starts the time anew.
        let scene = scene(3.66, 20.0, &[]);
        let mut rule = ReturnRule::default();
        let mut due = |reference: &Reference| rule.due(&SETTINGS, &scene, &road, reference, 5.0);
        assert!(!due(&free) && !due(&passed(-3.66)) && !due(&free) && due(&free));
    }
}
