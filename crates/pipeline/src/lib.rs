#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod atomic_write;
mod attempt;
mod cache;
mod check;
mod clean;
mod cluster;
mod content;
mod diff;
mod draw;
mod error;
mod event;
mod executor;
mod file;
mod graph;
mod journal;
mod ledger;
mod lock;
mod look;
mod manifest;
mod memory;
mod orphans;
mod own;
mod params;
mod paths;
mod place;
mod reason;
mod report;
mod run;
mod run_options;
mod schedule;
mod shares;
mod shell;
mod stage;
mod status;
mod store;
mod table;
#[cfg(test)]
mod testing;
mod trace;
mod verify;

pub use atomic_write::{Durability, atomic_write, atomic_write_bytes, while_held};
pub use clean::{Cleaned, clean};
pub use diff::{FileDifference, NumberDifference, RunAt, RunDifference, StageDifference, diff};
pub use error::{CycleStep, FileProblem, PipelineError, is_held};
pub use event::Event;
pub use executor::end_with_run;
pub use file::{CommandFiles, Commands, Pipeline, Settings, schema};
pub use graph::Graph;
pub use ledger::{Ledger, Left, Record};
pub use manifest::{FactKind, Manifest};
pub use own::ASIDE;
pub use params::parse_override;
pub use place::{Place, Program};
pub use reason::Reason;
pub use report::{
    Failure, FailureCause, Outcome, RunReport, Setting, StageResult, State, Summary, Warning,
};
pub use run::run;
pub use run_options::{Executor, RunOptions};
pub use shell::typed as command_line;
pub use stage::{Resources, Row, Share, Stage};
pub use status::{StageStatus, plan, status, why};
pub use trace::{Source, Trace, TracedFile, TracedStage, below_root, trace};
pub use verify::{FileState, Finding, Role, Verification, verify};
