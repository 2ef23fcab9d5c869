//! A ten-minute drive without a learned model: `cargo bench -p maveric-simulator --bench rollout`.

use divan::Bencher;
use maveric_domain::{LatentTraits, Setpoints, Situation};
use maveric_simulator::{Driver, DriverParams, Integrator, Scenario, VehicleModel, rollout};

fn main() {
    divan::main();
}

const CARS: [(VehicleModel, Integrator); 3] = [
    (VehicleModel::Kinematic, Integrator::InTurn),
    (VehicleModel::Kinematic, Integrator::Rk4),
    (VehicleModel::Dynamic, Integrator::Rk4),
];

fn scenario(curved: bool, (model, integrator): (VehicleModel, Integrator)) -> Scenario {
    let text = if curved {
        include_str!("../../../study_data/scenarios/curved.toml")
    } else {
        include_str!("../../../study_data/scenarios/paper.toml")
    };
    let read: Scenario = toml::from_str(text).expect("a scenario of the study data");
    let mut settings = read.settings().clone();
    settings.vehicle.model = model;
    settings.vehicle.integrator = integrator;
    Scenario::try_from(settings).expect("a car that may drive there")
}

fn simple(situation: &Situation) -> Setpoints {
    let gap_s = situation.reference.dx_m / situation.ego_speed_mps.max(1.0);
    let own_lane = situation.reference.dy_m.abs() < 1.83;
    let likely = situation.reference.vehicle.is_some()
        && (own_lane && gap_s < 2.0 || !own_lane && gap_s < -1.4);
    Setpoints {
        speed_mps: 29.0,
        following_distance_m: 1.2 * situation.ego_speed_mps,
        change_probability: if likely { 0.3 } else { 0.0 },
    }
}

#[divan::bench(name = "rollout/planner/600s", args = [false, true], consts = [0, 1, 2])]
fn planner<const CAR: usize>(bencher: Bencher<'_, '_>, curved: bool) {
    let scenario = scenario(curved, CARS[CAR]);
    bencher.bench_local(|| {
        let mut planner = simple;
        let driver = Driver::Automated(&mut planner, &scenario.settings().controllers);
        rollout(&scenario, driver, 1)
    });
}

#[divan::bench(name = "rollout/person/600s")]
fn person(bencher: Bencher<'_, '_>) {
    let scenario = Scenario::paper();
    let driver = DriverParams::draw(&LatentTraits::default(), 1, 1);
    bencher.bench_local(|| rollout(&scenario, Driver::Human(&driver), 1));
}
