//! Somebody else's controller in one file: a plain IDM car as a planner.
//!
//! `cargo run --release -p maveric-simulator --example idm_planner -- study_data/scenarios/stop_and_go.toml`
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::{LaneWish, Setpoints};
use maveric_simulator::{Driver, Planner, Scenario, View, rollout};

/// The Intelligent Driver Model.
///
/// # Source
/// Treiber, Hennecke and Helbing 2000: v0 120 km/h, T 1.6 s, s0 2 m, a 0.73 m/s², b 1.67 m/s².
struct IdmCar {
    desired_speed_mps: f64,
    time_gap_s: f64,
    standstill_m: f64,
    acceleration_mps2: f64,
    braking_mps2: f64,
}

impl IdmCar {
    fn acceleration(&self, speed_mps: f64, gap_m: f64, lead_mps: f64) -> f64 {
        let (a, b) = (self.acceleration_mps2, self.braking_mps2);
        let closing = speed_mps - lead_mps;
        let dynamic = speed_mps * (self.time_gap_s + closing / (2.0 * (a * b).sqrt()));
        let wanted_m = self.standstill_m + dynamic.max(0.0);
        let free = 1.0 - (speed_mps / self.desired_speed_mps).powi(4);
        a * (free - (wanted_m / gap_m.max(0.1)).powi(2))
    }
}

impl Planner for IdmCar {
    fn plan(&mut self, view: &View<'_>) -> Setpoints {
        let (speed, reference) = (view.scene.ego.speed_mps, &view.reference);
        // Ahead in its own lane; beside or behind, it is being passed and binds nobody.
        let ahead =
            reference.vehicle.is_some() && reference.dx_m > 0.0 && reference.dy_m.abs() < 1.83;
        let gap_m = if ahead { reference.dx_m } else { f64::INFINITY };
        let wanted = self.acceleration(speed, gap_m, reference.speed_mps);
        Setpoints {
            // The velocity controller gives about 0.6 m/s² for each m/s.
            speed_mps: (speed + wanted / 0.6).max(0.0),
            following_distance_m: self.standstill_m + self.time_gap_s * speed,
            wish: LaneWish::Stay,
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario: Scenario = match std::env::args().nth(1) {
        Some(file) => toml::from_str(&std::fs::read_to_string(file)?)?,
        None => Scenario::paper(),
    };
    let mut planner = IdmCar {
        desired_speed_mps: 120.0 / 3.6,
        time_gap_s: 1.6,
        standstill_m: 2.0,
        acceleration_mps2: 0.73,
        braking_mps2: 1.67,
    };
    let controllers = scenario.settings().controllers.clone();
    let driven = rollout(&scenario, Driver::Automated(&mut planner, &controllers), 1)?;
    let ego = driven.recording.ego();
    for row in (0..driven.recording.rows()).step_by(600) {
        let (time_s, x_m) = (driven.recording.time_s()[row], ego.x_m[row]);
        println!(
            "{time_s:5.0} s  {x_m:8.1} m  {:5.2} m/s",
            ego.speed_mps[row]
        );
    }
    println!(
        "{} collisions, {} interventions",
        driven.report.collisions, driven.report.interventions
    );
    Ok(())
}
