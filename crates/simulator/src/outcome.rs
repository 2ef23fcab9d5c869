//! What a drive came to.

use crate::{collision::Collision, control::Intervention, error::SimulatorError};
use maveric_domain::{Recording, TraceRow};
use serde::{Deserialize, Serialize};

/// A drive and what is to be said about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Rollout {
    /// Who was where, at [`PLANNING_RATE_HZ`](crate::PLANNING_RATE_HZ).
    pub recording: Recording,
    /// What was counted.
    pub report: RolloutReport,
    /// What the safety layer did, in order of time; nothing for people.
    pub interventions: Vec<Intervention>,
    /// Every collision and what had gone wrong before it, in order of time.
    pub collisions: Vec<Collision>,
    /// Why the drive ended early: a set-point that no controller can follow. The recording then ends with that row.
    pub stopped: Option<SimulatorError>,
    /// What the automated car decided at each row; empty for people.
    pub trace: Vec<TraceRow>,
}

impl Rollout {
    /// The drive, if it went on to its end.
    ///
    /// # Errors
    /// [`SimulatorError::Setpoint`] if the planner's set-points ended it.
    pub fn completed(self) -> Result<Self, SimulatorError> {
        match self.stopped {
            Some(error) => Err(error),
            None => Ok(self),
        }
    }
}

/// Counts over one drive; an episode is counted once, however long it lasts.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct RolloutReport {
    /// Episodes in which ego and another vehicle overlapped.
    pub collisions: u32,
    /// Episodes with the vehicle ahead in ego's lane nearer than the safety rule allows.
    pub rule_violations: u32,
    /// Time that ego spent so near, in s.
    pub inside_safe_distance_s: f64,
    /// Least share of the safe distance that was left; 1 where it was always kept.
    pub least_safe_distance_share: f64,
    /// Episodes in which the safety layer braked harder than the controllers asked; 0 for people.
    pub interventions: u32,
    /// Lane changes that were due and had to wait for a safe gap; 0 for people.
    pub held_changes: u32,
    /// Lane changes undone in their first half because a gap had become unsafe; 0 for people.
    pub given_up_changes: u32,
    /// Lane changes started; 0 for a person's hands, whose changes are read from the recording.
    pub started_changes: u32,
    /// Episodes in which a person's car slid along a barrier; 0 for everybody else, who never comes near one.
    #[serde(skip)]
    pub barrier_touches: u32,
    /// Lead vehicles that came.
    pub leads: u32,
    /// Encounters among them in which the passing lane was taken.
    #[serde(skip)]
    pub blocked_encounters: u32,
}
