//! Vehicles that are there from the start, and what they do.

use super::{
    ScenarioSettings,
    setting::{LANE, Range, check, settings},
};
use crate::error::SimulatorError;

/// Most vehicles that a scenario may place; more of them are a `[background]`.
const MOST_PLACED: f64 = 1000.0;

settings! {
    /// A vehicle that is there from the start; it keeps its speed and lane but for what its script says.
    pub struct VehiclePlacement {
        /// Centre of the vehicle ahead of ego's centre; negative behind.
        ahead_m: f64, Range::Finite;
        /// Lane, 0 the right one.
        lane: u8, LANE;
        /// Speed.
        speed_mps: f64, 0.0..=60.0;
        /// What it does, one step after the other.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        script: Vec<ScriptStep>;
    }
}

settings! {
    /// One thing a vehicle does, once its moment has come and the step before has begun.
    #[derive(Copy, Default)]
    pub struct ScriptStep {
        /// The moment, since the start of the drive. Either this or `at_gap_m`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_s: Option<f64>, Range::NotNegative;
        /// The moment at which its bumper-to-bumper distance from ego passes through this, from either side; negative behind.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_gap_m: Option<f64>, Range::Finite;
        /// Speed to take.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        speed_mps: Option<f64>, 0.0..=60.0;
        /// Acceleration or braking to take it with, positive; 2 m/s² without.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        acceleration_mps2: Option<f64>, 0.1..=12.0;
        /// Lane to change to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        lane: Option<u8>, LANE;
        /// Time that takes; goes with `lane`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        duration_s: Option<f64>, 0.5..=20.0;
    }
}

impl VehiclePlacement {
    /// One that keeps its speed.
    pub fn steady(ahead_m: f64, lane: u8, speed_mps: f64) -> Self {
        Self { ahead_m, lane, speed_mps, script: Vec::new() }
    }
}

impl ScriptStep {
    /// Refuses a step at `name` without one moment, without anything to do, or with half a change of lane.
    fn check_whole(&self, name: &str) -> Result<(), SimulatorError> {
        let count = |given: &[bool]| given.iter().filter(|given| **given).count() as f64;
        let moments = count(&[self.at_s.is_some(), self.at_gap_m.is_some()]);
        let one = Range::Because(1.0, 1.0, "one of at_s and at_gap_m");
        check(&format!("{name}.at_s"), moments, one)?;
        let acts = count(&[self.speed_mps.is_some(), self.lane.is_some()]);
        let some = Range::Because(1.0, 2.0, "a speed_mps or a lane");
        check(&format!("{name}.speed_mps"), acts, some)?;
        let lanes = count(&[self.lane.is_some()]);
        let both = Range::Because(lanes, lanes, "given with a lane, and only then");
        let durations = count(&[self.duration_s.is_some()]);
        check(&format!("{name}.duration_s"), durations, both)
    }
}

/// Refuses vehicles and steps that the road has no room for.
pub(super) fn check_placed(scenario: &ScenarioSettings) -> Result<(), SimulatorError> {
    let vehicles = &scenario.vehicles;
    let words = "at most 1000: every one is moved at every step";
    let most = Range::Because(0.0, MOST_PLACED, words);
    check("vehicles", vehicles.len() as f64, most)?;
    for (index, vehicle) in vehicles.iter().enumerate() {
        let name = format!("vehicles[{index}]");
        scenario.road.check_lane(&format!("{name}.lane"), vehicle.lane)?;
        for (number, step) in vehicle.script.iter().enumerate() {
            let name = format!("{name}.script[{number}]");
            step.check_whole(&name)?;
            let lane = step.lane.unwrap_or(0);
            scenario.road.check_lane(&format!("{name}.lane"), lane)?;
        }
        let before = vehicles[..index].iter().map(|v| (v.lane, v.ahead_m));
        let nearest_m = before
            .chain([(scenario.start.lane, 0.0)])
            .filter(|&(lane, _)| lane == vehicle.lane)
            .map(|(_, ahead_m)| (vehicle.ahead_m - ahead_m).abs())
            .fold(f64::INFINITY, f64::min);
        if nearest_m < scenario.vehicle.length_m + 1.0 {
            let expected =
                "a car's length and a metre from ego and from the vehicles before it in its lane";
            return Err(SimulatorError::Setting {
                name: format!("{name}.ahead_m"),
                found: vehicle.ahead_m,
                expected: expected.to_owned(),
            });
        }
    }
    Ok(())
}
