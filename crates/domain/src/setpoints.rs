//! What a planner asks of the controllers.

use serde::{Deserialize, Serialize};

/// How soon a lane change is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// It is meant, but not yet.
    NotYet,
    /// Now, as soon as it may be done.
    Now,
}

/// What a planner wants of the lane.
///
/// The planner wishes; whether a change may start, and how long it takes, is for the controllers to say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LaneWish {
    /// To keep to the lane that ego is in.
    #[default]
    Stay,
    /// To move one lane to the left, so as to pass.
    MoveOut(When),
    /// To move one lane to the right.
    MoveBack(When),
}

impl LaneWish {
    /// Lower-case words used in logs.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Stay => "stay",
            Self::MoveOut(When::NotYet) => "move out, not yet",
            Self::MoveOut(When::Now) => "move out",
            Self::MoveBack(When::NotYet) => "move back, not yet",
            Self::MoveBack(When::Now) => "move back",
        }
    }
}

/// What a planner asks of the controllers: parameters, never throttle or steering.
///
/// # Source
/// Paper, "Low Level Controllers": v̂ and f̂; the wish stands in for the probability that a lane change should start (ours).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Setpoints {
    /// v̂: speed to keep where nothing is in the way, in m/s.
    pub speed_mps: f64,
    /// f̂: bumper-to-bumper distance to keep behind the reference vehicle, in m.
    pub following_distance_m: f64,
    /// What is wanted of the lane.
    pub wish: LaneWish,
}
