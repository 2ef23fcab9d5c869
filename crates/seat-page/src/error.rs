//! What can be wrong with a record, a ride or a fit.

use maveric_domain::DomainError;
use maveric_model::ModelError;
use maveric_simulator::SimulatorError;

/// Why there is no drive, no fit or no second drive.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SeatPageError {
    /// A line of a record that cannot be read.
    #[error("line {line}: {problem}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// A record that does not go on where it stopped.
    #[error(
        "line {line}: begins at step {found}, expected {expected}: a piece is missing or there twice"
    )]
    Gap {
        /// Counted from 1.
        line: usize,
        found: u64,
        /// Where the one before ended.
        expected: u64,
    },
    /// A record that says more or less than its drive needs.
    #[error("{problem}")]
    Record {
        /// What is wrong with it.
        problem: String,
    },
    /// The scenario cannot be driven.
    #[error(transparent)]
    Simulator(#[from] SimulatorError),
    /// The model cannot be asked.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// What was driven is no drive.
    #[error(transparent)]
    Domain(#[from] DomainError),
}
