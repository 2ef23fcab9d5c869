//! What a run did, stage by stage.

use path_slash::PathExt as _;
use std::path::PathBuf;

use crate::{Reason, own::shortened};

/// What became of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// It was not asked for.
    Unknown,
    /// It waits for stages upstream: at the end of a run, it did not come to run.
    Wanted,
    /// All that it needs is there: at the end of a run, it was not begun or was interrupted.
    Ready,
    /// It runs.
    Running,
    /// It ran, and its outputs are there.
    Done,
    /// Its outputs were taken from the cache.
    Restored,
    /// It ran and did not end well.
    Failed,
    /// It had nothing to do.
    UpToDate,
}

/// Why and how a stage failed.
#[derive(Debug, Clone, PartialEq, serde::Serialize, thiserror::Error)]
#[error("stage `{stage}` failed: {cause}")]
pub struct Failure {
    /// Its name, with that of its branch in a fan-out.
    pub stage: String,
    /// What went wrong.
    pub cause: FailureCause,
    /// The last lines that it printed, at most twenty.
    pub last_lines: Vec<String>,
    /// A shell command that repeats the stage alone; none where it was kept from starting, which the command would not be.
    pub repeat: Option<String>,
    /// Everything that it printed, if it was begun.
    pub log: Option<PathBuf>,
    /// How long it ran, in seconds, if it was begun.
    pub seconds: Option<f64>,
}

/// What went wrong in a stage.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, thiserror::Error)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum FailureCause {
    /// Its program ended with an error.
    #[error("its program ended with exit status {code}")]
    Exit {
        /// The exit status.
        code: i32,
    },
    /// Something killed its program.
    #[error("its program was killed{}", signal.map_or_else(String::new, |s| format!(" by signal {s}")))]
    Killed {
        /// The signal, where the system has them.
        signal: Option<i32>,
    },
    /// It ran longer than it may.
    #[error("it ran longer than {minutes} min (`minutes` in its resources)")]
    TimedOut {
        /// The longest that it may run, in minutes.
        minutes: u32,
    },
    /// Its program could not be started.
    #[error("`{program}` cannot be started: {message}")]
    NotStarted {
        /// Its path or name, as it was called.
        program: String,
        /// What the system said.
        message: String,
    },
    /// Its program ended well without having made all outputs.
    #[error("its program ended well but did not make {}", paths.join(", "))]
    OutputsMissing {
        /// The outputs that are not there.
        paths: Vec<String>,
    },
    /// What it read was edited meanwhile, so that nobody knows from which content it made its outputs.
    #[error(
        "{} changed while it ran or waited{}",
        shortened(paths),
        run_again(newest.as_ref())
    )]
    InputsChanged {
        /// The inputs, relative to the root.
        paths: Vec<String>,
        /// Of the first of them that is a folder, the file in it that changed last: the stage itself may have written it.
        #[serde(skip_serializing_if = "Option::is_none")]
        newest: Option<String>,
    },
    /// What it made on a cluster was edited before its end was seen.
    #[error("what it made ({}) was changed after its job had ended: run again", shortened(paths))]
    OutputsChanged {
        /// Its outputs.
        paths: Vec<String>,
    },
    /// A cluster ended its job, or forgot it, before the stage ended by itself.
    #[error("its job {job} on the cluster ended without it: {state}{}", remedy(state))]
    JobLost {
        /// The job, as the cluster calls it.
        job: String,
        /// What the cluster says of it.
        state: String,
    },
    /// Files stand where it has its outputs that no run made.
    #[error(
        "{} in its outputs, made by no run: move {} away, or run with --move-aside, which puts {} beside with the date",
        shortened(paths),
        them(paths),
        them(paths)
    )]
    Foreign {
        /// The files, relative to the root.
        paths: Vec<String>,
    },
    /// Behind a link stands something else than what the last run had made.
    #[error(
        "`{path}` lies behind the link `{link}` to {}, where something else stands than its last run had made: \
         remove the link, or what is there",
        target.to_slash_lossy()
    )]
    BehindLink {
        /// The output, relative to the root.
        path: String,
        /// The link: the output or a directory above it, relative to the root.
        link: String,
        /// Where the link leads.
        target: PathBuf,
    },
    /// The stages upstream ran but an input is not there.
    #[error("the stages before it did not make {}", paths.join(", "))]
    InputsMissing {
        /// The inputs that are not there.
        paths: Vec<String>,
    },
}

impl FailureCause {
    /// Whether the stage was kept from starting, or from replacing what somebody else has put there.
    pub(crate) fn is_before_start(&self) -> bool {
        matches!(self, Self::Foreign { .. } | Self::BehindLink { .. } | Self::InputsMissing { .. })
    }
}

/// What to do once an input has changed, of a folder with the file in it that changed last.
fn run_again(newest: Option<&String>) -> String {
    newest.map_or_else(
        || ": run again".to_owned(),
        |newest| {
            format!(
                " (newest there: {newest}): run again; if the stage itself writes there, list the files that it reads instead of the folder"
            )
        },
    )
}

/// What to ask for more of, after a state of Slurm.
fn remedy(state: &str) -> &'static str {
    match state {
        "TIMEOUT" => "; give it more `minutes` in its resources",
        "OUT_OF_MEMORY" => "; give it more `memory_mb` in its resources",
        _ => "",
    }
}

fn them(paths: &[String]) -> &'static str {
    if paths.len() == 1 { "it" } else { "them" }
}

/// How a run ended as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// All wanted stages are up to date.
    Done,
    /// At least one stage failed.
    Failed,
    /// The cancel flag was set; the next run continues after the last finished stage.
    Interrupted,
}

/// What a run did.
#[derive(Debug, Clone, serde::Serialize)]
pub struct RunReport {
    /// How it ended as a whole.
    pub outcome: Outcome,
    /// The wanted stages, in the order of [`Graph::ordered`](crate::Graph::ordered).
    pub stages: Vec<StageResult>,
    /// The failures, in the order in which they happened.
    pub failures: Vec<Failure>,
    /// What is not right and did not stop the run.
    pub warnings: Vec<Warning>,
    /// What the stages with `summary = true` that are up to date printed, in the same order
    /// as `stages`, also if they had nothing to do this time.
    pub summaries: Vec<Summary>,
}

/// What became of one stage.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct StageResult {
    /// Its name, with that of its branch in a fan-out.
    pub stage: String,
    /// What became of it.
    pub state: State,
    /// Why it ran; empty if it did not.
    pub reasons: Vec<Reason>,
    /// How long it ran, in seconds, if it did.
    pub seconds: Option<f64>,
    /// The most memory that one of its processes held, in bytes, if it ran and the system
    /// tells; never less than what this program itself held when it started the stage.
    pub peak_memory: Option<u64>,
}

/// Something that is not right and does not stop a run.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, thiserror::Error)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Warning {
    /// Results were replaced by those of other settings in the same place.
    #[error(
        "the former results ({}) were replaced; `--variant NAME` keeps both",
        settings(changes)
    )]
    Replaced {
        /// Parameters that `--set` changed, or that it had changed before.
        changes: Vec<Setting>,
    },
    /// Files that no run had made were moved out of a stage's outputs.
    #[error("{} moved from the outputs of stage `{stage}` into {}", counted(*files), folders.join(", "))]
    MovedAside {
        /// The stage in whose outputs they lay.
        stage: String,
        /// How many files.
        files: usize,
        /// Where they are now, relative to the root.
        folders: Vec<String>,
    },
    /// The last run of a stage was cut off, so that nobody knows which files in its folders it had made.
    #[error(
        "the last run of stage `{stage}` was cut off: what lay in its folders ({}) is now in {}",
        amount(*files),
        folders.join(", ")
    )]
    CutOff {
        /// The stage in whose outputs they lay.
        stage: String,
        /// How many files.
        files: usize,
        /// Where they are now, relative to the root.
        folders: Vec<String>,
    },
    /// The pipeline no longer makes what an earlier run of it had made.
    #[error("the pipeline no longer has stage `{stage}` there: {}", no_longer_made(removed, kept))]
    NoLongerMade {
        /// The stage that had made it.
        stage: String,
        /// Outputs that were removed, relative to the root.
        removed: Vec<String>,
        /// What stays, since it was changed by hand or no run had made it.
        kept: Vec<String>,
    },
    /// A stage reads what a stage made that the pipeline no longer has.
    #[error(
        "stage `{reader}` reads `{path}` as it is: stage `{stage}`, which made it, is no longer in the pipeline"
    )]
    OnceMade {
        /// The stage that reads.
        reader: String,
        /// What it reads, relative to the root.
        path: String,
        /// The stage that had made it.
        stage: String,
    },
    /// The cache held something else for a stage than what it had made.
    #[error("the cache is damaged for stage `{stage}`, which runs instead")]
    CacheDamaged {
        /// Its name, with that of its branch in a fan-out.
        stage: String,
    },
    /// What a stage made could not be put into the cache.
    #[error("what stage `{stage}` made was not put into the cache: {message}")]
    NotCached {
        /// Its name, with that of its branch in a fan-out.
        stage: String,
        /// What the system said.
        message: String,
    },
}

/// A parameter that has another value than in the run before.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Setting {
    /// The parameter, as the pipeline file calls it.
    pub name: String,
    /// Its value then.
    pub before: String,
    /// Its value now.
    pub now: String,
}

fn settings(changes: &[Setting]) -> String {
    let change = |s: &Setting| format!("{}={}, now {}", s.name, s.before, s.now);
    changes.iter().map(change).collect::<Vec<_>>().join("; ")
}

fn no_longer_made(removed: &[String], kept: &[String]) -> String {
    let mut parts = Vec::new();
    if !removed.is_empty() {
        parts.push(format!("{} removed", names(removed)));
    }
    if !kept.is_empty() {
        parts.push(format!(
            "{} changed by hand or made by no run, so it stays; remove it, or run with --move-aside",
            names(kept)
        ));
    }
    parts.join("; ")
}

fn counted(files: usize) -> String {
    match files {
        1 => "one file that no run had made was".to_owned(),
        files => format!("{files} files that no run had made were"),
    }
}

fn amount(files: usize) -> String {
    match files {
        1 => "one file".to_owned(),
        files => format!("{files} files"),
    }
}

fn names(paths: &[String]) -> String {
    let quoted: Vec<String> = paths.iter().map(|path| format!("`{path}`")).collect();
    shortened(&quoted)
}

/// The standard output of a stage.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Summary {
    /// Its name, with that of its branch in a fan-out.
    pub stage: String,
    /// What it printed; of a long text the last part.
    pub text: String,
}
