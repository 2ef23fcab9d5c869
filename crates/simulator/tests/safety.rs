//! No collision where the assumptions of the safety rule hold: a sample of what `examples/safety` runs.

#[path = "../examples/safety/random.rs"]
mod random;

use maveric_simulator::{CollisionCause, Driver, rollout};
use random::{KINDS, planner, scenario};

#[test]
fn where_the_assumptions_hold_nobody_is_hit() {
    for kind in KINDS {
        for number in 0..30 {
            let scenario = scenario(kind, number).unwrap();
            let mut planner = planner(kind, number);
            let controllers = &scenario.settings().controllers;
            let driver = Driver::Automated(&mut planner, controllers);
            let driven = rollout(&scenario, driver, number).unwrap();
            for collision in &driven.collisions {
                let own = collision.cause == CollisionCause::AssumptionsHeld;
                assert!(!own, "{kind} {number}: {collision:?}");
            }
        }
    }
}

#[test]
fn a_faster_car_that_swings_into_ego_beside_it_side_swiped_it() {
    for number in [516, 809, 1170, 1263, 1355] {
        let scenario = scenario("cut-in", number).unwrap();
        let mut planner = planner("cut-in", number);
        let controllers = &scenario.settings().controllers;
        let driver = Driver::Automated(&mut planner, controllers);
        let driven = rollout(&scenario, driver, number).unwrap();
        let causes: Vec<_> = driven.collisions.iter().map(|c| c.cause).collect();
        assert!(causes.contains(&CollisionCause::Sideswiped), "{causes:?}");
        assert!(!causes.contains(&CollisionCause::AssumptionsHeld), "{number}: {causes:?}");
    }
}
