//! What can be wrong with a scenario, a planner or a drive.

use maveric_domain::DomainError;

/// Why there is no rollout.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulatorError {
    /// A setting outside its range.
    #[error("`{name}` is {found}, expected {expected}")]
    Setting {
        /// Key of the setting, as in the scenario file.
        name: String,
        /// What was found.
        found: f64,
        /// The range in words.
        expected: String,
    },
    /// A set-point that no controller can follow.
    #[error("the planner gave `{name}` = {found} at {time_s} s, expected {expected}")]
    Setpoint {
        /// Which of the set-points.
        name: &'static str,
        /// What was given.
        found: f64,
        /// Time since the start of the drive, in s.
        time_s: f64,
        /// The range in words.
        expected: &'static str,
    },
    /// The drive cannot be recorded.
    #[error("the drive cannot be recorded")]
    Recording(#[from] DomainError),
    /// Vehicles told to a session that moves its own.
    #[error("this session moves its own traffic, so nobody can be put on its road")]
    OwnTraffic,
}
