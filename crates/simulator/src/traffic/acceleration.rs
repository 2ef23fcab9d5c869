//! How the other vehicles speed up and slow down.

use super::{Car, EgoView, Role, blocked, distance_m};
use crate::{road::CentreLine, scenario::ScenarioSettings};
use maveric_laws::Idm;

/// Lateral acceleration at most in a bend, and braking before it, in m/s²: chosen.
const BEND_MPS2: (f64, f64) = (3.0, 1.0);
/// Acceleration of off-lane vehicles and of cars riding beside ego, at most, in m/s².
const ACCELERATION_MPS2: f64 = 2.0;
/// Sideways distance of centres below which a vehicle is in another's way, in m.
const IN_THE_WAY_M: f64 = 2.4;
/// How the others follow: a short time gap, so that a car which ego has passed keeps its speed behind it.
const FOLLOWING: Idm = Idm {
    desired_speed_mps: f64::INFINITY,
    time_gap_s: 0.6,
    standstill_gap_m: 2.0,
    max_accel_mps2: 1.5,
    comfortable_braking_mps2: 2.5,
};
/// Hardest braking, in m/s².
const BRAKING_MPS2: f64 = 8.0;

/// Acceleration towards the speed that the car's role wants, in m/s².
pub(crate) fn wanted(
    car: &mut Car,
    settings: &ScenarioSettings,
    line: &CentreLine,
    ego: &EgoView,
    time_s: f64,
) -> f64 {
    let distance = distance_m(ego, &car.state);
    let (wanted_mps, limit) = match &mut car.role {
        Role::Lead(plan) => {
            let ahead = (car.lane == ego.lane && car.state.x_m > ego.x_m).then_some(distance);
            let wanted = plan.wanted_mps(&settings.leads, ego, ahead, time_s);
            (wanted, settings.leads.acceleration_mps2)
        }
        Role::Blocker { place_m, leaving } => {
            let x_m = car.state.x_m;
            let wanted = blocked::wanted_mps(&settings.blocked, ego, x_m, *place_m, *leaving);
            (wanted, ACCELERATION_MPS2)
        }
        Role::Scripted(script) => return script.acceleration_mps2(car.state.speed_mps),
        Role::Steady { speed_mps, .. } => (*speed_mps, ACCELERATION_MPS2),
    };
    let (lateral, braking) = BEND_MPS2;
    let bend_mps = line.speed_limit_mps(car.state.x_m, lateral, braking);
    (wanted_mps.min(bend_mps) - car.state.speed_mps).clamp(-limit, limit)
}

/// Acceleration that keeps the car off whatever is ahead of it, in m/s²; infinite on free road.
///
/// # Source
/// The interaction term of IDM (Treiber, Hennecke and Helbing 2000), only where the gap is shorter than wanted.
pub(crate) fn held_back(car: &Car, cars: &[Car], ego: &EgoView) -> f64 {
    let state = &car.state;
    let others = cars
        .iter()
        .map(|c| &c.state)
        .filter(|s| s.id != state.id)
        .map(|s| (s.x_m, s.y_m, s.speed_mps, s.length_m));
    let nearest = others
        .chain([(ego.x_m, ego.y_m, ego.speed_mps, ego.length_m)])
        .filter(|&(x, y, ..)| x > state.x_m && (y - state.y_m).abs() < IN_THE_WAY_M)
        .map(|(x, _, speed, length)| (x - state.x_m - 0.5 * (length + state.length_m), speed))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((gap_m, speed_mps)) = nearest else {
        return f64::INFINITY;
    };
    FOLLOWING
        .held_back_mps2(gap_m, state.speed_mps, speed_mps)
        .map_or(f64::INFINITY, |wanted| wanted.max(-BRAKING_MPS2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        scenario::Scenario,
        testing::{car, seen_ego},
    };

    #[test]
    fn a_car_goes_for_its_speed_within_its_limit() {
        let scenario = Scenario::paper();
        let towards = |speed_mps: f64| {
            let role = Role::Steady { speed_mps, passing_by: false };
            let mut car = car(1, 50.0, 0, 20.0, role);
            let line = CentreLine::default();
            wanted(&mut car, scenario.settings(), &line, &seen_ego(), 0.0)
        };
        for (speed, expected) in [(21.0, 1.0), (19.0, -1.0), (30.0, 2.0), (10.0, -2.0)] {
            assert!((towards(speed) - expected).abs() < 1e-12, "{speed}");
        }
    }

    #[test]
    fn it_is_held_back_by_the_nearest_ahead_in_its_way_ego_among_them() {
        let role = Role::Steady { speed_mps: 20.0, passing_by: false };
        // Behind ego by 12 m, where 2 + 20 · 0.6 = 14 m are wanted.
        let own = car(1, -12.0, 0, 20.0, role);
        let law = |gap_m: f64| 1.5 * (1.0 - (14.0 / gap_m).powi(2));
        let held = |cars: &[Car]| held_back(&own, cars, &seen_ego());
        assert!((held(&[]) - law(12.0)).abs() < 1e-12);
        // One between the two, one beside its way, one behind, itself.
        let mut between = car(2, -2.0, 0, 20.0, role);
        between.state.x_m = -3.0;
        assert!((held(&[between.clone(), own.clone()]) - law(9.0)).abs() < 1e-12);
        between.state.y_m = 2.4;
        let behind = car(3, -40.0, 0, 20.0, role);
        assert!((held(&[between, behind]) - law(12.0)).abs() < 1e-12);
        // Never harder than 8 m/s², and not at all from beyond the wanted gap.
        let near = car(1, -3.0, 0, 20.0, role);
        assert!((held_back(&near, &[], &seen_ego()) + 8.0).abs() < 1e-12);
        let far = car(1, -14.1, 0, 20.0, role);
        assert!(held_back(&far, &[], &seen_ego()).is_infinite());
    }
}
