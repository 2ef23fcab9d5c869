//! What happens in a run.

use crate::{Failure, FailureCause, Reason, Warning};

/// What happens in a run, as it happens, told on the thread that called [`run`](crate::run).
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// A stage begins.
    Started {
        /// Its name.
        stage: &'a str,
        /// Its command line as in the pipeline file, parameters put in.
        command: String,
        /// Why it runs.
        reasons: &'a [Reason],
    },
    /// A stage wrote a line to its standard error.
    Line {
        /// Its name, with that of its branch in a fan-out.
        stage: &'a str,
        /// The line, without its end.
        line: &'a str,
    },
    /// A stage has nothing to do.
    UpToDate {
        /// Its name, with that of its branch in a fan-out.
        stage: &'a str,
        /// How many of the wanted stages are settled, this one included.
        settled: usize,
        /// How many stages are wanted.
        wanted: usize,
    },
    /// A stage has made its outputs.
    Finished {
        /// Its name, with that of its branch in a fan-out.
        stage: &'a str,
        /// How long it ran, in seconds.
        seconds: f64,
        /// The most memory that one of its processes held, in bytes, where it is known.
        peak_memory: Option<u64>,
        /// How many of the wanted stages are settled, this one included.
        settled: usize,
        /// How many stages are wanted.
        wanted: usize,
    },
    /// A stage failed and is tried again.
    Retried {
        /// Its name, with that of its branch in a fan-out.
        stage: &'a str,
        /// What went wrong.
        cause: &'a FailureCause,
        /// Which retry this is, from 1.
        retry: u32,
        /// How many there may be.
        retries: u32,
    },
    /// A stage's outputs were taken from the cache.
    Restored {
        /// Its name, with that of its branch in a fan-out.
        stage: &'a str,
        /// How many of the wanted stages are settled, this one included.
        settled: usize,
        /// How many stages are wanted.
        wanted: usize,
    },
    /// Stages were handed to a cluster.
    Submitted {
        /// The job, as the cluster calls it.
        job: &'a str,
        /// The stages, or what stages of one fan-out are called together.
        stage: &'a str,
        /// How many of them.
        tasks: usize,
    },
    /// Jobs that an earlier run had handed to a cluster are followed again.
    Resumed {
        /// How many stages.
        stages: usize,
    },
    /// A stage failed.
    Failed(&'a Failure),
    /// Something is not right and does not stop the run.
    Warning(&'a Warning),
}
