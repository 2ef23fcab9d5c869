//! A ten-minute drive without a learned model: `cargo bench -p maveric-simulator --bench rollout`.

use divan::Bencher;
use maveric_domain::{LaneWish, LatentTraits, Setpoints, When};
use maveric_simulator::{Driver, DriverParams, Integrator, Scenario, VehicleModel, View, rollout};

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
        maveric_data::SCENARIOS_CURVED
    } else {
        maveric_data::SCENARIOS_PAPER
    };
    let read: Scenario = toml::from_str(text).expect("a scenario of the study data");
    let mut settings = read.settings().clone();
    settings.vehicle.model = model;
    settings.vehicle.integrator = integrator;
    Scenario::try_from(settings).expect("a car that may drive there")
}

fn simple(view: &View<'_>) -> Setpoints {
    let gap_s = view.reference.dx_m / view.scene.ego.speed_mps.max(1.0);
    let own_lane = view.reference.dy_m.abs() < 1.83;
    let wish = match (view.reference.vehicle.is_some(), own_lane) {
        (true, true) if gap_s < 2.0 => LaneWish::MoveOut(When::Now),
        (true, false) if gap_s < -1.4 => LaneWish::MoveBack(When::Now),
        _ => LaneWish::Stay,
    };
    Setpoints {
        speed_mps: 29.0,
        following_distance_m: 1.2 * view.scene.ego.speed_mps,
        wish,
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
