//! How the controllers answer a step, and how a lane change is tracked over speed: two tables.
//!
//! `cargo run --release -p maveric-simulator --example step_responses`
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::MetresPerSecond;
use maveric_simulator::{Integrator, Scenario, VehicleModel, lane_change_tracking, step_responses};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for model in [VehicleModel::Kinematic, VehicleModel::Dynamic] {
        let mut settings = Scenario::paper().settings().clone();
        settings.vehicle.model = model;
        settings.vehicle.integrator = Integrator::Rk4;
        let scenario = Scenario::try_from(settings)?;
        println!("{model:?}\nresponse | overshoot, % | settling time, s | steady-state error");
        for r in step_responses(&scenario)? {
            let settles = r
                .settling_time_s
                .map_or("none".to_owned(), |t| format!("{t:.1}"));
            println!(
                "{} | {:.1} | {settles} | {:.3} {}",
                r.name, r.overshoot_percent, r.steady_state_error, r.unit
            );
        }
        println!("speed, m/s | error, m | acceleration, m/s² | jerk, m/s³ | duration, s");
        let speeds: Vec<MetresPerSecond> = [10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 38.0]
            .map(MetresPerSecond)
            .into();
        for t in lane_change_tracking(&scenario, &speeds)? {
            println!(
                "{:.0} | {:.3} | {:.2} | {:.1} | {:.2}",
                t.speed_mps,
                t.largest_lateral_error_m,
                t.largest_lateral_acceleration_mps2,
                t.largest_lateral_jerk_mps3,
                t.duration_s
            );
        }
    }
    Ok(())
}
