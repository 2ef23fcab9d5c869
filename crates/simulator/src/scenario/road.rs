//! Settings of the road and of where ego starts.

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
