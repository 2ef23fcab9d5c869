//! What an automated car was asked and decided, row by row: the simulator says it, a log keeps it.

use crate::setpoints::Setpoints;

/// What the car is doing about its lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaneActivity {
    /// It keeps the lane.
    Keeping,
    /// A change is due and waits for a safe gap.
    Waiting,
    /// It changes lanes.
    Changing,
    /// It undoes a change that was given up.
    GoingBack,
}

/// What was asked and decided at one row of a drive that a planner steers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TraceRow {
    /// Time since the start of the drive, in s.
    pub time_s: f64,
    /// What the planner asked.
    pub asked: Setpoints,
    /// The acceleration that was sent to the car, in m/s².
    pub acceleration_mps2: f64,
    /// Whether the safety layer brakes harder than the controllers asked.
    pub braked: bool,
    /// What it does about its lane from here on.
    pub lane: LaneActivity,
    /// The path of the change under way: control points of a cubic Bezier curve, (x, y) in the road frame, in m.
    pub path_m: Option<[(f64, f64); 4]>,
}
