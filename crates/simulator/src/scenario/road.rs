//! Settings of the road and of where ego starts.

use super::setting::{LANE, Range, check, settings};
use crate::{error::SimulatorError, road::Segment};

settings! {
    /// Lanes, posted speed and course of the road.
    pub struct RoadSettings {
        /// Number of lanes.
        lanes: u8 = 2, 2.0..=4.0;
        /// Width of a lane.
        lane_width_m: f64 = 3.66, 3.0..=6.0;
        /// Posted speed, as a person reads it.
        posted_speed_mph: f64 = 55.0, 10.0..=100.0;
        /// Course of the centre line of lane 0, piece by piece, repeated as often as needed; straight without.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        segments: Vec<Segment> = Vec::new(), Range::Because(f64::MIN, f64::MAX, "pieces, see *Road*");
    }
}

settings! {
    /// How ego starts: on free road, in the middle of a lane.
    pub struct StartSettings {
        /// Lane, 0 the right one.
        lane: u8 = 0, LANE;
        /// Speed, as a person reads it.
        speed_mph: f64 = 55.0, 0.0..=100.0;
    }
}

impl RoadSettings {
    /// Refuses the lane at `name` unless this road has it.
    pub(super) fn check_lane(&self, name: &str, lane: u8) -> Result<(), SimulatorError> {
        check(name, f64::from(lane), Range::lane_of(self.lanes))
    }
}
