//! A ten-minute drive without a learned model: `cargo bench -p maveric-simulator --bench rollout`.

#[path = "../tests/support/passing.rs"]
mod passing;

use divan::Bencher;
use maveric_domain::LatentTraits;
use maveric_simulator::{Driver, DriverParams, Integrator, Scenario, VehicleModel, rollout};
use passing::passing;

fn main() {
    divan::main();
}

const CARS: [(VehicleModel, Integrator); 3] = [
    (VehicleModel::Kinematic, Integrator::InTurn),
    (VehicleModel::Kinematic, Integrator::Rk4),
    (VehicleModel::Dynamic, Integrator::Rk4),
];

fn scenario(curved: bool, (model, integrator): (VehicleModel, Integrator)) -> Scenario {
    let text = if curved { maveric_data::SCENARIOS_CURVED } else { maveric_data::SCENARIOS_PAPER };
    let read: Scenario = toml::from_str(text).expect("a scenario of the study data");
    let mut settings = read.settings().clone();
    settings.vehicle.model = model;
    settings.vehicle.integrator = integrator;
    Scenario::try_from(settings).expect("a car that may drive there")
}

#[divan::bench(name = "rollout/planner/600s", args = [false, true], consts = [0, 1, 2])]
fn planner<const CAR: usize>(bencher: Bencher<'_, '_>, curved: bool) {
    let scenario = scenario(curved, CARS[CAR]);
    bencher.bench_local(|| {
        let mut planner = passing(29.0);
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
