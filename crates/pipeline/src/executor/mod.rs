//! What it takes to run a stage somewhere: a [`Job`] in, an [`Ended`] out. One file a place.

mod group;
pub(crate) mod local;
mod parent;

pub use parent::end_with_run;

use std::fs::File;
use std::path::Path;
use std::process::{Command, ExitStatus};
use std::time::Duration;

/// Keeps Ctrl-C in a terminal from what the command will start: we end it, or wait for its end.
pub(crate) fn set_apart(command: &mut Command) {
    group::Group::begin(command);
}

/// A command line with everything that its process needs.
pub(crate) struct Job<'a> {
    /// The executable: a path, or a name to look up.
    pub(crate) program: &'a Path,
    /// One by one, without the program.
    pub(crate) arguments: &'a [String],
    /// The directory in which it runs.
    pub(crate) root: &'a Path,
    /// Its standard input.
    pub(crate) stdin: File,
    /// The longest that it may run.
    pub(crate) limit: Option<Duration>,
    /// Takes all that it prints, both streams, line by line.
    pub(crate) log: File,
}

/// How a job ended.
pub(crate) enum Ended {
    /// By itself.
    Exited {
        status: ExitStatus,
        /// The most memory that one of its processes held, in bytes, where the system tells.
        peak_memory: Option<u64>,
        /// Its standard output; of a long one the last part, in whole lines.
        stdout: String,
        /// The last lines of both streams.
        last_lines: Vec<String>,
    },
    /// By us, because it ran too long.
    TimedOut {
        /// The last lines of both streams.
        last_lines: Vec<String>,
    },
    /// Before it ran: there is no such program, or it may not be run.
    NotStarted(std::io::Error),
    /// By us, because the run was interrupted.
    Interrupted,
}
