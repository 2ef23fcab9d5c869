//! Settings of the road and of ego's car.

use super::{Range, check};
use crate::{error::SimulatorError, road::Segment};
use serde::{Deserialize, Serialize};

/// The road.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadSettings {
    /// Number of lanes: 2 to 4.
    pub lanes: u8,
    /// Width of a lane, in m.
    pub lane_width_m: f64,
    /// Posted speed, in mph, as a person reads it.
    pub posted_speed_mph: f64,
    /// Course of the centre line of lane 0, piece by piece, repeated as often as needed; straight without.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub segments: Vec<Segment>,
}

impl RoadSettings {
    pub(crate) const PAPER: Self = Self {
        lanes: 2,
        lane_width_m: 3.66,
        posted_speed_mph: 55.0,
        segments: Vec::new(),
    };

    pub(super) fn check(&self) -> Result<(), SimulatorError> {
        check(
            "road",
            "lanes",
            f64::from(self.lanes),
            Range::Within(2.0, 4.0, "2 to 4"),
        )?;
        check(
            "road",
            "lane_width_m",
            self.lane_width_m,
            Range::Within(3.0, 6.0, "3 to 6 m"),
        )?;
        let speed = Range::Within(10.0, 100.0, "10 to 100 mph");
        check("road", "posted_speed_mph", self.posted_speed_mph, speed)?;
        let mut segments = self.segments.iter().enumerate();
        segments.try_for_each(|(index, segment)| segment.check(index))
    }
}

/// Ego's car; all vehicles share its length and width.
///
/// # Source
/// Method section 5 for the limits of acceleration and braking; the rest is ours, a mid-size car.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleSettings {
    /// Bumper to bumper, in m.
    pub length_m: f64,
    /// Side to side, in m.
    pub width_m: f64,
    /// Axle to axle, in m.
    pub wheelbase_m: f64,
    /// Strongest acceleration, in m/s².
    pub acceleration_limit_mps2: f64,
    /// Strongest braking, in m/s², positive.
    pub braking_limit_mps2: f64,
    /// Time constant of the throttle, in s.
    pub throttle_lag_s: f64,
    /// Time constant of the brake, in s.
    pub brake_lag_s: f64,
    /// Largest angle of the front wheels, in rad.
    pub steering_limit_rad: f64,
    /// Fastest turn of the front wheels, in rad/s.
    pub steering_rate_limit_rad_per_s: f64,
}

impl VehicleSettings {
    pub(crate) const PAPER: Self = Self {
        length_m: 4.7,
        width_m: 1.9,
        wheelbase_m: 2.8,
        acceleration_limit_mps2: 3.0,
        braking_limit_mps2: 8.0,
        throttle_lag_s: 0.3,
        brake_lag_s: 0.15,
        steering_limit_rad: 0.6,
        steering_rate_limit_rad_per_s: 0.5,
    };

    pub(super) fn check(&self) -> Result<(), SimulatorError> {
        let ranges = [
            (
                "length_m",
                self.length_m,
                Range::Within(1.0, 25.0, "1 to 25 m"),
            ),
            (
                "width_m",
                self.width_m,
                Range::Within(0.5, 2.6, "0.5 to 2.6 m"),
            ),
            (
                "wheelbase_m",
                self.wheelbase_m,
                Range::Within(0.5, 15.0, "0.5 to 15 m"),
            ),
            (
                "acceleration_limit_mps2",
                self.acceleration_limit_mps2,
                Range::Within(0.5, 10.0, "0.5 to 10 m/s²"),
            ),
            (
                "braking_limit_mps2",
                self.braking_limit_mps2,
                Range::Within(6.0, 12.0, "6 to 12 m/s²"),
            ),
            (
                "throttle_lag_s",
                self.throttle_lag_s,
                Range::Within(0.01, 1.0, "0.01 to 1 s"),
            ),
            (
                "brake_lag_s",
                self.brake_lag_s,
                Range::Within(0.01, 0.5, "0.01 to 0.5 s"),
            ),
            (
                "steering_limit_rad",
                self.steering_limit_rad,
                Range::Within(0.1, 1.2, "0.1 to 1.2 rad"),
            ),
            (
                "steering_rate_limit_rad_per_s",
                self.steering_rate_limit_rad_per_s,
                Range::Within(0.1, 5.0, "0.1 to 5 rad/s"),
            ),
        ];
        ranges
            .into_iter()
            .try_for_each(|(key, found, range)| check("vehicle", key, found, range))
    }
}

/// How ego starts: on free road, in the middle of a lane.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StartSettings {
    /// Lane, 0 the right one.
    pub lane: u8,
    /// Speed, in mph, as a person reads it.
    pub speed_mph: f64,
}

impl StartSettings {
    pub(crate) const PAPER: Self = Self {
        lane: 0,
        speed_mph: 55.0,
    };

    pub(super) fn check(&self, road: &RoadSettings) -> Result<(), SimulatorError> {
        let last = f64::from(road.lanes) - 1.0;
        let lane = Range::Within(0.0, last, "a lane of the road");
        check("start", "lane", f64::from(self.lane), lane)?;
        check(
            "start",
            "speed_mph",
            self.speed_mph,
            Range::Within(0.0, 100.0, "0 to 100 mph"),
        )
    }
}
