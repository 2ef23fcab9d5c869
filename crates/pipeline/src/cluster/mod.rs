//! Stages as jobs of Slurm or HyperQueue: handed in with their order, followed, entered into
//! the ledger by us.
//!
//! The cluster runs scripts and knows nothing of the ledger; its memory of what finished is
//! not ours. A task says by a file of its own how it ended. What the cluster says counts
//! only for tasks that have not: whether they still wait or run.

mod engine;
mod follow;
mod jobs;
mod script;
mod submit;

use std::collections::BTreeSet;

use crate::attempt::Workshop;
use crate::schedule::Schedule;
use crate::{Event, Executor, PipelineError, Place, RunOptions};

pub(crate) use jobs::refuse_while_jobs_run;

/// Where the scripts of all submissions are.
fn spools(place: &Place) -> std::path::PathBuf {
    place.log_dir.join(".cluster")
}

/// Brings the wanted stages up to date on a cluster. What was handed in goes on if this
/// process ends, and the next run follows it again.
pub(crate) fn run(
    engine: Executor,
    workshop: &Workshop<'_>,
    schedule: &mut Schedule<'_>,
    forced: &BTreeSet<usize>,
    options: &RunOptions,
    observe: &mut dyn FnMut(Event<'_>),
) -> Result<(), PipelineError> {
    follow::Follower::new(engine, workshop, schedule.graph, forced, options)?
        .follow(schedule, observe)
}
