//! Somebody else's controller in one file: a plain IDM car as a planner.
//!
//! `cargo run --release -p maveric-simulator --example idm_planner -- study_data/scenarios/stop_and_go.toml`
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::{LaneWish, Setpoints};
use maveric_laws::Idm;
use maveric_simulator::{Driver, Planner, Scenario, View, rollout};

/// The Intelligent Driver Model at the wheel.
///
/// # Source
/// Treiber, Hennecke and Helbing 2000: v0 120 km/h, T 1.6 s, s0 2 m, a 0.73 m/s², b 1.67 m/s².
struct IdmCar(Idm);

impl Planner for IdmCar {
    fn plan(&mut self, view: &View<'_>) -> Setpoints {
        let (speed, reference) = (view.scene.ego.speed_mps, &view.reference);
        // Ahead in its own lane; beside or behind, it is being passed and binds nobody.
        let ahead =
            reference.vehicle.is_some() && reference.dx_m > 0.0 && reference.dy_m.abs() < 1.83;
        let gap_m = if ahead { reference.dx_m } else { f64::INFINITY };
        let wanted = self.0.accel_mps2(gap_m, speed, reference.speed_mps);
        Setpoints {
            // The velocity controller gives about 0.6 m/s² for each m/s.
            speed_mps: (speed + wanted / 0.6).max(0.0),
            following_distance_m: self.0.standstill_gap_m + self.0.time_gap_s * speed,
            wish: LaneWish::Stay,
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario: Scenario = match std::env::args().nth(1) {
        Some(file) => toml::from_str(&std::fs::read_to_string(file)?)?,
        None => Scenario::paper(),
    };
    let mut planner = IdmCar(Idm {
        desired_speed_mps: 120.0 / 3.6,
        time_gap_s: 1.6,
        standstill_gap_m: 2.0,
        max_accel_mps2: 0.73,
        comfortable_braking_mps2: 1.67,
    });
    let controllers = scenario.settings().controllers.clone();
    let driven = rollout(&scenario, Driver::Automated(&mut planner, &controllers), 1)?;
    let ego = driven.recording.ego();
    for row in (0..driven.recording.rows()).step_by(600) {
        let (time_s, x_m) = (driven.recording.time_s()[row], ego.x_m[row]);
        println!("{time_s:5.0} s  {x_m:8.1} m  {:5.2} m/s", ego.speed_mps[row]);
    }
    println!(
        "{} collisions, {} interventions",
        driven.report.collisions, driven.report.interventions
    );
    Ok(())
}
