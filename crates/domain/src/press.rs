//! What people pressed during rides: how often, and what the ride was like before.

use crate::{ConditionId, DriveId, ParticipantId};
use serde::{Deserialize, Serialize};

/// How often somebody pressed "uncomfortable" in a ride.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PressedRide {
    /// Who rode.
    pub participant: ParticipantId,
    /// In which condition.
    pub condition: ConditionId,
    /// The ride.
    pub drive: DriveId,
    /// How long it was, in min.
    pub minutes: f64,
    /// How often the button was pressed.
    pub presses: usize,
}

/// A moment of a ride with a press, and what came before it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PressMoment {
    /// Who rode.
    pub participant: ParticipantId,
    /// In which condition.
    pub condition: ConditionId,
    /// The ride.
    pub drive: DriveId,
    /// Minute of the ride, from 0: a press is held against other moments of its own minute.
    pub minute: u32,
    /// Time since the start of the ride, in s.
    pub time_s: f64,
    /// Whether the person pressed at this moment.
    pub pressed: bool,
    /// Whether it takes part in the comparison; other moments only show the course before a press.
    pub at_risk: bool,
    /// Time until the next press that takes part, in s, where that is near.
    pub to_press_s: Option<f64>,
    /// Smallest gap to a vehicle ahead in the lane, in m; none where nobody is ahead.
    pub least_gap_m: Option<f64>,
    /// Largest inverse time to collision with it, in 1/s: 0 where the gap opens or nobody is ahead.
    pub inverse_time_to_collision_per_s: Option<f64>,
    /// Strongest braking, in m/s²; 0 without any.
    pub braking_mps2: Option<f64>,
    /// Largest absolute jerk, in m/s³.
    pub jerk_mps3: Option<f64>,
    /// Largest absolute lateral acceleration against the road, in m/s².
    pub lateral_acceleration_mps2: Option<f64>,
    /// 1 where the car changes lane, else 0; none where lanes are not seen.
    pub lane_change: Option<f64>,
    /// 1 where a vehicle cuts in, else 0; none where lateral positions are not seen.
    pub cut_in: Option<f64>,
}

/// What can come before a press: id, name for people, unit.
pub const PRECURSORS: [Precursor; 7] = [
    Precursor { id: "least_gap_m", title: "Smallest gap", unit: "m", value: |m| m.least_gap_m },
    Precursor {
        id: "inverse_time_to_collision_per_s",
        title: "Largest inverse time to collision",
        unit: "1/s",
        value: |m| m.inverse_time_to_collision_per_s,
    },
    Precursor {
        id: "braking_mps2",
        title: "Strongest braking",
        unit: "m/s²",
        value: |m| m.braking_mps2,
    },
    Precursor { id: "jerk_mps3", title: "Largest jerk", unit: "m/s³", value: |m| m.jerk_mps3 },
    Precursor {
        id: "lateral_acceleration_mps2",
        title: "Largest lateral acceleration",
        unit: "m/s²",
        value: |m| m.lateral_acceleration_mps2,
    },
    Precursor { id: "lane_change", title: "A lane change", unit: "", value: |m| m.lane_change },
    Precursor { id: "cut_in", title: "A vehicle cuts in", unit: "", value: |m| m.cut_in },
];

/// Something that a ride can be like before a press.
#[derive(Debug, Clone, Copy)]
pub struct Precursor {
    /// Column of the moments.
    pub id: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// Unit; empty for what is there or not.
    pub unit: &'static str,
    /// Its value at a moment.
    pub value: fn(&PressMoment) -> Option<f64>,
}
