//! The safety layer's brake: harder than the controllers asked, where that alone avoids a vehicle.

use super::{
    intervention::{Intervention, InterventionKind},
    safety::safe_distance_m,
};
use crate::{
    neighbours::{ahead_or_entering, in_the_way},
    planner::PLANNING_STEP_S,
    scenario::{ControllerSettings, VehicleSettings},
};
use maveric_domain::{Road, Scene, VehicleId};
use maveric_laws::needed_braking_mps2;

/// Sideways room beside a vehicle below which it is in the way, in m.
const SIDE_CLEARANCE_M: f64 = 0.2;
/// How much harder than needed it brakes: the brake has a lag.
const RESERVE: f64 = 1.3;
/// Share of the braking at which it takes over below which it lets go again.
const RELEASE: f64 = 0.5;
/// Share of the safe distance that must be missing for the braking that the rule reckons with.
const FULL_AT: f64 = 0.3;

/// Watches what is in the way, whatever its lane, and brakes for it.
#[derive(Debug, Clone, Default)]
pub(super) struct EmergencyBrake {
    seen: Option<(VehicleId, f64)>,
    braking: bool,
}

impl EmergencyBrake {
    /// Whether it brakes now.
    pub(super) fn braking(&self) -> bool {
        self.braking
    }

    /// The command that the car gets where the controllers ask for `wanted_mps2`, and a note where it begins to differ.
    ///
    /// Behind the vehicle `driven_up_to` the safe distance alone is no reason to brake.
    pub(super) fn override_command(
        &mut self,
        settings: &ControllerSettings,
        vehicle: &VehicleSettings,
        scene: &Scene,
        road: &Road,
        claims: &[Option<u8>],
        (wanted_mps2, driven_up_to): (f64, Option<VehicleId>),
    ) -> (f64, Option<Intervention>) {
        let needed = self
            .needed_mps2(settings, vehicle, scene)
            .max(needed_for_entering_mps2(settings, scene, road, claims));
        let threshold = if self.braking {
            RELEASE * settings.intervenes_above_mps2
        } else {
            settings.intervenes_above_mps2
        };
        let command = if needed > threshold {
            wanted_mps2.min(-(RESERVE * needed).min(vehicle.braking_limit_mps2))
        } else {
            wanted_mps2
        };
        let command = command.min(rule_allows_mps2(settings, scene, road, claims, driven_up_to));
        let overrides = command < wanted_mps2;
        let begins = (overrides && !self.braking).then_some(Intervention {
            time_s: scene.time_s,
            vehicle: self.seen.map(|(id, _)| id),
            kind: InterventionKind::Braked { asked_mps2: wanted_mps2, given_mps2: command },
        });
        self.braking = overrides;
        (command, begins)
    }

    fn needed_mps2(
        &mut self,
        settings: &ControllerSettings,
        vehicle: &VehicleSettings,
        scene: &Scene,
    ) -> f64 {
        let Some(n) = in_the_way(scene, vehicle.width_m, SIDE_CLEARANCE_M) else {
            self.seen = None;
            return 0.0;
        };
        let speed = n.vehicle.speed_mps;
        let lead_braking = match self.seen {
            Some((id, before)) if id == n.vehicle.id => (before - speed) / PLANNING_STEP_S,
            _ => 0.0,
        };
        self.seen = Some((n.vehicle.id, speed));
        let ego = scene.ego.speed_mps;
        needed_braking_mps2(n.gap_m, settings.margin_m, ego, speed, lead_braking)
    }
}

/// Highest acceleration that the rule allows, in m/s²: any while the vehicle ahead is beyond the safe distance; below it the
/// rule's proper response, braking, less hard where
/// little is missing (ours), so that a car that cuts in a metre too near is not an emergency.
fn rule_allows_mps2(
    settings: &ControllerSettings,
    scene: &Scene,
    road: &Road,
    claims: &[Option<u8>],
    driven_up_to: Option<VehicleId>,
) -> f64 {
    let lane = road.nearest_lane(scene.ego.y_m);
    ahead_or_entering(scene, road, lane, claims).map_or(f64::INFINITY, |n| {
        let safe = safe_distance_m(settings, scene.ego.speed_mps, n.vehicle.speed_mps);
        if n.gap_m >= safe || driven_up_to == Some(n.vehicle.id) {
            return f64::INFINITY;
        }
        -settings.own_braking_mps2 * ((1.0 - n.gap_m / safe) / FULL_AT).min(1.0)
    })
}

/// Braking for a vehicle that is about to take ego's lane, in m/s², positive.
///
/// One that is beside ego with its centre ahead gets room: ego is the one behind, and the rule has that one brake.
fn needed_for_entering_mps2(
    settings: &ControllerSettings,
    scene: &Scene,
    road: &Road,
    claims: &[Option<u8>],
) -> f64 {
    let lane = road.nearest_lane(scene.ego.y_m);
    if claims.iter().all(|claim| *claim != Some(lane)) {
        return 0.0;
    }
    ahead_or_entering(scene, road, lane, claims).map_or(0.0, |n| {
        if n.gap_m <= 0.0 {
            return 1.1 * settings.intervenes_above_mps2;
        }
        let (ego, other) = (scene.ego.speed_mps, n.vehicle.speed_mps);
        needed_braking_mps2(n.gap_m, settings.margin_m, ego, other, 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        scenario::Scenario,
        testing::{AT_ONCE, other, scene},
    };

    #[test]
    fn it_brakes_for_a_car_that_cuts_in_and_counts_that_once() {
        let scenario = Scenario::paper();
        let s = scenario.settings();
        let mut brake = EmergencyBrake::default();
        let mut noted = Vec::new();
        let mut command = |gap_m: f64| {
            let scene = scene(0.0, 30.0, &[other(1, gap_m, 1.5, 22.0)]);
            let road = scenario.road();
            let (command, note) = brake.override_command(
                &s.controllers,
                &s.vehicle,
                &scene,
                &road,
                &[None],
                (0.5, None),
            );
            noted.extend(note);
            command
        };
        // The safe distance is 44 m: beyond it nothing happens, a metre inside it a little, far inside it everything.
        assert!((command(60.0) - 0.5).abs() < 1e-12);
        assert!((-1.5..0.5).contains(&command(43.0)));
        command(60.0);
        assert!(command(9.0) < -5.0 && command(8.9) < -5.0);
        assert_eq!(noted.len(), 2);
        let InterventionKind::Braked { asked_mps2, given_mps2 } = noted[1].kind else {
            panic!("{noted:?}");
        };
        assert!(asked_mps2 > 0.4 && given_mps2 < -5.0 && noted[1].vehicle == Some(VehicleId(1)));
    }

    /// What the car gets where nothing but the scene asks for braking.
    fn given(brake: &mut EmergencyBrake, scene: &Scene, claims: &[Option<u8>]) -> f64 {
        let scenario = Scenario::paper();
        let vehicle = &scenario.settings().vehicle;
        let asked = (0.5, None);
        let road = Road::PAPER;
        brake.override_command(&AT_ONCE, vehicle, scene, &road, claims, asked).0
    }

    #[test]
    fn it_brakes_a_third_harder_than_needed_and_lets_go_at_half_of_what_it_began_at() {
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found}");
        let standing = |gap_m: f64| scene(0.0, 20.0, &[other(1, gap_m, 0.0, 0.0)]);
        let mut brake = EmergencyBrake::default();
        // 20² / 2 over what is left before the margin of 2 m: 2 m/s² are no emergency, 4 are, and then 2 are braked for, too.
        near(given(&mut brake, &standing(102.0), &[None]), 0.5);
        near(given(&mut brake, &standing(52.0), &[None]), -1.3 * 4.0);
        near(given(&mut brake, &standing(102.0), &[None]), -1.3 * 2.0);
        near(given(&mut brake, &standing(127.0), &[None]), 0.5);
        near(given(&mut brake, &standing(102.0), &[None]), 0.5);
        // More than the brakes have is not given.
        near(given(&mut brake, &standing(26.0), &[None]), -8.0);
    }

    #[test]
    fn it_reckons_with_the_braking_that_it_sees() {
        let at = |speed_mps: f64| scene(0.0, 25.0, &[other(1, 40.0, 0.0, speed_mps)]);
        let mut brake = EmergencyBrake::default();
        assert!((given(&mut brake, &at(20.0), &[None]) - 0.5).abs() < 1e-12);
        // 0.2 m/s slower after 1/20 s: ego has 38 m and 19.8² / 8 m to stop in.
        let needed = 625.0 / (2.0 * (38.0 + 19.8 * 19.8 / 8.0));
        assert!((given(&mut brake, &at(19.8), &[None]) + 1.3 * needed).abs() < 1e-9);
        // Somebody else at another speed has not braked.
        let mut brake = EmergencyBrake::default();
        given(&mut brake, &at(20.0), &[None]);
        let other_one = scene(0.0, 25.0, &[other(2, 40.0, 0.0, 19.8)]);
        assert!((given(&mut brake, &other_one, &[None]) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn inside_the_safe_distance_it_brakes_by_what_is_missing() {
        let scenario = Scenario::paper();
        let vehicle = &scenario.settings().vehicle;
        // Both at 20 m/s: 0.5 s of 20.5 m/s and 21² / 16 m, less 20² / 16.
        let rule = ControllerSettings {
            reaction_s: 0.5,
            reaction_acceleration_mps2: 2.0,
            ..AT_ONCE.clone()
        };
        let safe_m = 0.5 * 20.5 + (441.0 - 400.0) / 16.0;
        for (share, driven_up_to, expected) in [
            (1.0, None, 0.5),
            (0.85, None, -4.0),
            (0.5, None, -8.0),
            (0.85, Some(VehicleId(1)), 0.5),
            (0.85, Some(VehicleId(2)), -4.0),
        ] {
            let scene = scene(0.0, 20.0, &[other(1, share * safe_m + 1e-9, 0.0, 20.0)]);
            let asked = (0.5, driven_up_to);
            let found = EmergencyBrake::default()
                .override_command(&rule, vehicle, &scene, &Road::PAPER, &[None], asked)
                .0;
            assert!((found - expected).abs() < 1e-6, "{share}: {found}");
        }
    }

    #[test]
    fn who_means_to_come_into_egos_lane_gets_room() {
        let left = 3.66;
        let beside = scene(0.0, 20.0, &[other(1, 0.0, left, 20.0)]);
        let found = given(&mut EmergencyBrake::default(), &beside, &[Some(0)]);
        assert!((found + 1.3 * 1.1 * 3.5).abs() < 1e-9, "{found}");
        // Beyond the safe distance of 50 m, where 20² / (2 · 50) is needed; inside that of 9 m, where the rule asks for more.
        let slower = |ego_mps: f64, gap_m: f64, other_mps: f64| {
            scene(0.0, ego_mps, &[other(1, gap_m, left, other_mps)])
        };
        for (scene, expected) in
            [(slower(30.0, 52.0, 10.0), -1.3 * 4.0), (slower(20.0, 0.85 * 9.0, 16.0), -4.0)]
        {
            let found = given(&mut EmergencyBrake::default(), &scene, &[Some(0)]);
            assert!((found - expected).abs() < 1e-9, "{found}");
        }
        let slower = slower(30.0, 52.0, 10.0);
        let stays = given(&mut EmergencyBrake::default(), &slower, &[None]);
        assert!((stays - 0.5).abs() < 1e-12);
    }
}
