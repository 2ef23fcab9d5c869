#![doc = include_str!("../README.md")]

mod atomic_write;
mod attempt;
mod check;
mod content;
mod draw;
mod error;
mod executor;
mod file;
mod graph;
mod ledger;
mod lock;
mod manifest;
mod params;
mod paths;
mod place;
mod reason;
mod report;
mod run;
mod schedule;
mod shell;
mod status;
#[cfg(test)]
mod testing;

pub use error::{CycleStep, FileProblem, PipelineError};
pub use file::{Pipeline, Stage};
pub use graph::Graph;
pub use ledger::{LEDGER_VERSION, Ledger, Record};
pub use manifest::{FactKind, Manifest};
pub use params::parse_override;
pub use place::{Place, Program};
pub use reason::Reason;
pub use report::{Failure, FailureCause, Outcome, RunReport, StageResult, State, Summary};
pub use run::{Event, RunOptions, run};
pub use status::{StageStatus, plan, status, why};
