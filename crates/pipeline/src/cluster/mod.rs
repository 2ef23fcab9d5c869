//! Stages as jobs of Slurm or HyperQueue: handed in with their order, followed, entered into
//! the ledger by us.
//!
//! The cluster runs scripts and knows nothing of the ledger; its memory of what finished is
//! not ours. A task says by a file of its own how it ended. What the cluster says counts
//! only for tasks that have not: whether they still wait or run.

mod ending;
mod engine;
mod follow;
mod jobs;
mod script;
mod submit;

use crate::Place;

pub(crate) use follow::Follower;
pub(crate) use jobs::refuse_while_jobs_run;

/// Where the scripts of all submissions are.
fn spools(place: &Place) -> std::path::PathBuf {
    place.log_dir.join(".cluster")
}
