//! What to run, how, and where.

use std::{
    num::NonZeroUsize,
    path::PathBuf,
    sync::{Arc, atomic::AtomicBool},
    time::Duration,
};

/// NFS remembers for up to 30 s (or 60, by its options) that a file is not there.
const LOST_AFTER: Duration = Duration::from_mins(1);

/// What to run and how.
#[derive(Debug, Clone)]
pub struct RunOptions {
    /// Stages or files; each comes with everything upstream. Empty: all stages.
    pub targets: Vec<String>,
    /// How many stages may run at once; on a cluster, how many of each fan-out. `None`: one
    /// on this machine, no limit on a cluster.
    pub jobs: Option<NonZeroUsize>,
    /// Run the targets (all stages if there are none) even if they are up to date.
    pub force: bool,
    /// Move files that no run made out of the outputs of stages that run, beside them into a
    /// folder with the date; they are an error otherwise.
    pub move_aside: bool,
    /// After a failure, go on with what does not need the failed stage.
    pub keep_going: bool,
    /// Memory in MiB that stages which run at once may ask for together; `None`: all that this
    /// machine has. One that asks for more than that runs alone.
    pub memory_mb: Option<u64>,
    /// How long a task may be gone from a cluster without a word of its own before it counts
    /// as lost: network file systems show a new file late.
    pub lost_after: Duration,
    /// A directory from which outputs are taken that were made before from the same, and to
    /// which they go.
    pub cache: Option<PathBuf>,
    /// Where the stages run.
    pub executor: Executor,
    /// Set it to interrupt the run: running stages are ended within about 0.2 s.
    pub cancel: Arc<AtomicBool>,
}

/// Where stages run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Executor {
    /// As processes on this machine.
    #[default]
    Local,
    /// As jobs of Slurm (`sbatch`).
    Slurm,
    /// As tasks of HyperQueue (`hq`).
    HyperQueue,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self {
            targets: Vec::new(),
            jobs: None,
            force: false,
            move_aside: false,
            keep_going: false,
            memory_mb: None,
            lost_after: LOST_AFTER,
            cache: None,
            executor: Executor::Local,
            cancel: Arc::default(),
        }
    }
}
