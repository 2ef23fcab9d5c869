//! Vehicles that are there from the start, and what they do.

use super::{Range, RoadSettings, StartSettings, check};
use crate::error::SimulatorError;
use serde::{Deserialize, Serialize};

/// Most vehicles that a scenario may place; more of them are a `[background]`.
const MOST_PLACED: f64 = 1000.0;

/// A vehicle that is there from the start; it keeps its speed and lane but for what its script says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehiclePlacement {
    /// Centre of the vehicle ahead of ego's centre, in m; negative behind.
    pub ahead_m: f64,
    /// Lane, 0 the right one.
    pub lane: u8,
    /// Speed, in m/s.
    pub speed_mps: f64,
    /// What it does, one step after the other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub script: Vec<ScriptStep>,
}

/// One thing a vehicle does, once its moment has come and the step before has begun.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScriptStep {
    /// The moment, in s since the start of the drive. Either this or `at_gap_m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_s: Option<f64>,
    /// The moment at which its bumper-to-bumper distance from ego passes through this, from either side, in m; negative behind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_gap_m: Option<f64>,
    /// Speed to take, in m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_mps: Option<f64>,
    /// Acceleration or braking to take it with, in m/s², positive; 2 without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration_mps2: Option<f64>,
    /// Lane to change to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lane: Option<u8>,
    /// Time that takes, in s; goes with `lane`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
}

impl VehiclePlacement {
    /// One that keeps its speed.
    pub fn steady(ahead_m: f64, lane: u8, speed_mps: f64) -> Self {
        Self {
            ahead_m,
            lane,
            speed_mps,
            script: Vec::new(),
        }
    }

    fn check(&self, index: usize, road: &RoadSettings) -> Result<(), SimulatorError> {
        let section = format!("vehicles[{index}]");
        let last = f64::from(road.lanes) - 1.0;
        let lane = Range::Within(0.0, last, "a lane of the road");
        let speed = Range::Within(0.0, 60.0, "0 to 60 m/s");
        check(&section, "ahead_m", self.ahead_m, Range::Finite)?;
        check(&section, "lane", f64::from(self.lane), lane)?;
        check(&section, "speed_mps", self.speed_mps, speed)?;
        for (number, step) in self.script.iter().enumerate() {
            let section = format!("{section}.script[{number}]");
            let given = |value: Option<f64>| f64::from(u8::from(value.is_some()));
            let one = Range::Within(1.0, 1.0, "one of at_s and at_gap_m");
            let moments = given(step.at_s) + given(step.at_gap_m);
            check(&section, "at_s", moments, one)?;
            let lane_given = step.lane.map(f64::from);
            let acts = given(step.speed_mps) + given(lane_given);
            let some = Range::Within(1.0, 2.0, "a speed_mps or a lane");
            check(&section, "speed_mps", acts, some)?;
            let both = Range::Within(
                given(lane_given),
                given(lane_given),
                "given with a lane, and only then",
            );
            check(&section, "duration_s", given(step.duration_s), both)?;
            let numbers = [
                ("at_s", step.at_s, Range::NotNegative),
                ("at_gap_m", step.at_gap_m, Range::Finite),
                ("speed_mps", step.speed_mps, speed),
                (
                    "acceleration_mps2",
                    step.acceleration_mps2,
                    Range::Within(0.1, 12.0, "0.1 to 12 m/s²"),
                ),
                ("lane", lane_given, lane),
                (
                    "duration_s",
                    step.duration_s,
                    Range::Within(0.5, 20.0, "0.5 to 20 s"),
                ),
            ];
            for (key, value, range) in numbers {
                value.map_or(Ok(()), |found| check(&section, key, found, range))?;
            }
        }
        Ok(())
    }
}

/// Checks every vehicle, and that none overlaps ego or another.
pub(super) fn check_all(
    vehicles: &[VehiclePlacement],
    road: &RoadSettings,
    start: &StartSettings,
    length_m: f64,
) -> Result<(), SimulatorError> {
    let most = Range::Within(
        0.0,
        MOST_PLACED,
        "at most 1000: every one is moved at every step",
    );
    check("", "vehicles", vehicles.len() as f64, most)?;
    for (index, vehicle) in vehicles.iter().enumerate() {
        vehicle.check(index, road)?;
        let before = vehicles[..index].iter().map(|v| (v.lane, v.ahead_m));
        let nearest_m = before
            .chain([(start.lane, 0.0)])
            .filter(|&(lane, _)| lane == vehicle.lane)
            .map(|(_, ahead_m)| (vehicle.ahead_m - ahead_m).abs())
            .fold(f64::INFINITY, f64::min);
        if nearest_m < length_m + 1.0 {
            return Err(SimulatorError::Setting {
                name: format!("vehicles[{index}].ahead_m"),
                found: vehicle.ahead_m,
                expected: "a car's length and a metre from ego and from the vehicles before it in its lane",
            });
        }
    }
    Ok(())
}
