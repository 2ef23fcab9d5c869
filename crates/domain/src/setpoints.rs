//! What a planner asks of the controllers.

use serde::{Deserialize, Serialize};

/// What a planner asks of the controllers: parameters, never throttle or steering.
///
/// # Source
/// Paper, "Low Level Controllers": v̂, f̂ and the probability that a lane change should start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Setpoints {
    /// v̂: speed to keep, in m/s.
    pub speed_mps: f64,
    /// f̂: bumper-to-bumper distance to keep behind the reference vehicle, in m.
    pub following_distance_m: f64,
    /// P(change): calibrated probability that a lane change starts within the next second.
    pub change_probability: f64,
}
