//! Everything that can go wrong before, between and around the stages.
//!
//! A stage that fails is no error of the pipeline: it is a [`Failure`](crate::Failure) in
//! the report of the run, beside the stages that succeeded.

mod file;
mod words;

pub use file::FileProblem;
use path_slash::PathExt as _;
pub(crate) use words::nearest;

use std::path::PathBuf;
use words::{did_you_mean, listing};

/// How many stages a fan-out may give.
pub(crate) const MOST_STAGES: u64 = 1_000_000;

/// What kept a pipeline from being read, checked or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// The pipeline file is not there or cannot be read.
    #[error("cannot read the pipeline file {}", path.to_slash_lossy())]
    Unreadable {
        /// The file as it was asked for.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The pipeline file says something that we do not understand.
    #[error("{}:{line}:{column}: {problem}", path.to_slash_lossy())]
    Malformed {
        /// The pipeline file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What is wrong there.
        problem: Box<FileProblem>,
    },
    /// `--set` without an equals sign.
    #[error("`{text}` is not of the form KEY=VALUE")]
    OverrideForm {
        /// What was given.
        text: String,
    },
    /// `--set` of a parameter that the pipeline does not have.
    #[error("the pipeline has no parameter `{name}`")]
    UnknownOverride {
        /// The parameter that was to be set.
        name: String,
        /// The most similar parameter, if one is similar.
        nearest: Option<String>,
        /// All parameters, in alphabetical order.
        known: Vec<String>,
    },
    /// `--set` of a parameter to a value of another type.
    #[error("parameter `{name}` is {expected} in the pipeline, so it cannot be set to `{value}`")]
    OverrideType {
        /// The parameter.
        name: String,
        /// What it was to be set to.
        value: String,
        /// The type in the file, with its article.
        expected: &'static str,
    },
    /// Stages that wait for each other.
    #[error("stages wait for each other in a circle: {}", circle(steps))]
    Cycle {
        /// The circle; the last step's maker is the first step's stage.
        steps: Vec<CycleStep>,
    },
    /// Two stages that write the same file, or one into the other's directory.
    #[error("two stages make `{path}`: `{first}` and `{second}`")]
    TwoMakers {
        /// The path that both would write.
        path: String,
        /// The stage that comes first in the file.
        first: String,
        /// The other stage.
        second: String,
    },
    /// An input that is not there and that no stage makes.
    #[error("stage `{stage}` needs `{input}`, which does not exist and which no stage makes")]
    MissingInput {
        /// The stage that reads it.
        stage: String,
        /// The path, relative to the root directory.
        input: String,
        /// An output of some stage with a similar name.
        nearest: Option<String>,
        /// What the pipeline file says about getting it (`inputs_help`).
        help: Option<String>,
    },
    /// A directory that a stage reads or makes, with our own files in it.
    #[error("`{directory}` of stage `{stage}` holds {}, which the run itself needs", path.to_slash_lossy())]
    HoldsOurs {
        /// Its name, with that of its branch in a fan-out.
        stage: String,
        /// The input or output.
        directory: String,
        /// What lies in it: the root, the ledger, the logs or the pipeline file.
        path: PathBuf,
    },
    /// A stage that calls our program with a command that it does not have.
    #[error("stage `{stage}` calls `{program} {command}`, but {program} has no such command")]
    UnknownCommand {
        /// Its name, with that of its branch in a fan-out.
        stage: String,
        /// The program's name.
        program: String,
        /// The word after it; empty if there is none.
        command: String,
        /// The most similar command.
        nearest: Option<String>,
    },
    /// A target that is neither a stage nor a file of the pipeline.
    #[error("`{target}` is neither a stage of pipeline `{pipeline}` nor a file that one makes")]
    UnknownTarget {
        /// What was asked for.
        target: String,
        /// The pipeline's name.
        pipeline: String,
        /// The most similar stage or output.
        nearest: Option<String>,
    },
    /// A file that no stage of a ledger made.
    #[error("no stage recorded in {} made `{path}`", ledger.to_slash_lossy())]
    NotMade {
        /// The file.
        path: String,
        /// The path of the ledger.
        ledger: PathBuf,
        /// A recorded output with a similar name.
        nearest: Option<String>,
    },
    /// Stages that an earlier run handed to a cluster have not ended.
    #[error("{} of this pipeline are still on the cluster ({engine}), as jobs {}", counted(*stages), jobs.join(", "))]
    OnCluster {
        /// How many stages.
        stages: usize,
        /// The cluster's program.
        engine: &'static str,
        /// The ids that the cluster gave its jobs.
        jobs: Vec<String>,
    },
    /// The cluster's program did not do what was asked for.
    #[error("`{command}` failed: {message}")]
    Engine {
        /// The command line that failed.
        command: String,
        /// What it or the system said.
        message: String,
    },
    /// The ledger is no ledger.
    #[error("the ledger {} is damaged: {message}", path.to_slash_lossy())]
    LedgerDamaged {
        /// The ledger.
        path: PathBuf,
        /// What does not fit, with its line where it has one.
        message: String,
    },
    /// The ledger has another format than that of this version.
    #[error("the ledger {} has format {found}; this program knows format {supported}", path.to_slash_lossy())]
    LedgerFormat {
        /// The ledger.
        path: PathBuf,
        /// The format that it claims.
        found: u32,
        /// The one that we read.
        supported: u32,
    },
    /// The pipeline has run in another folder, where its paths mean other files.
    #[error(
        "the ledger {} is of runs in {}; in {} its paths mean other files",
        ledger.to_slash_lossy(),
        before.to_slash_lossy(),
        root.to_slash_lossy()
    )]
    OtherRoot {
        /// The ledger's file.
        ledger: PathBuf,
        /// Where its runs were.
        before: PathBuf,
        /// Where it would run now.
        root: PathBuf,
    },
    /// Another run is at work on the same ledger.
    #[error("another run of this pipeline{} is still at work (lock {})", holder(*pid), path.to_slash_lossy())]
    Busy {
        /// The lock file.
        path: PathBuf,
        /// The process that took the lock, where it could be read.
        pid: Option<u32>,
    },
    /// The run that took the lock is no more, but a stage that it began still is.
    #[error(
        "the run of this pipeline in process {pid} was killed, and a stage that it began is still at work after some seconds (lock {})",
        path.to_slash_lossy()
    )]
    StageLeftAtWork {
        /// The lock file.
        path: PathBuf,
        /// The process of the run that was killed.
        pid: u32,
    },
    /// A file or directory could not be read or written.
    #[error("cannot {doing} {}", path.to_slash_lossy())]
    Io {
        /// What we wanted, as a verb phrase.
        doing: &'static str,
        /// Where.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file whose name is no UTF-8 text.
    #[error("the name of {} is not UTF-8 text, so that no pipeline can name it", path.to_slash_lossy())]
    NameNotText {
        /// The file.
        path: PathBuf,
    },
    /// `--variant` of a pipeline with outputs that it cannot move.
    #[error(
        "`--variant {variant}` cannot move `{output}` of stage `{stage}`: it does not begin with a parameter"
    )]
    NoRoot {
        /// The name given to `--variant`.
        variant: String,
        /// The stage that makes the output.
        stage: String,
        /// Its output, as written.
        output: String,
    },
    /// A variant's name that cannot be one.
    #[error(
        "`{name}` cannot name a variant: letters, digits, `_` and `-`, the first a letter or digit"
    )]
    BadVariant {
        /// The name as it was given.
        name: String,
    },
    /// The cancel flag was set while files were read.
    #[error("interrupted")]
    Interrupted,
}

/// Whether what failed did so because another program has the file open: denied access, shared with nobody or locked, as Windows
/// numbers them.
pub fn is_held(error: &std::io::Error) -> bool {
    cfg!(windows) && matches!(error.raw_os_error(), Some(5 | 32 | 33))
}

impl PipelineError {
    /// What to try next, when we know it.
    pub fn suggestion(&self) -> Option<String> {
        match self {
            Self::Malformed { problem, .. } => problem.suggestion(),
            Self::OverrideForm { .. } => Some("for example: --set seed=7".to_owned()),
            Self::UnknownOverride { nearest, known, .. } => did_you_mean(nearest.as_ref())
                .or_else(|| Some(format!("its parameters: {}", listing(known)))),
            Self::MissingInput { nearest, help, .. } => {
                help.clone().or_else(|| did_you_mean(nearest.as_ref()))
            }
            Self::UnknownCommand { nearest, .. } | Self::UnknownTarget { nearest, .. } => {
                did_you_mean(nearest.as_ref())
            }
            Self::TwoMakers { .. } => Some("give each stage an output of its own".to_owned()),
            Self::LedgerDamaged { path, .. } => Some(format!(
                "restore {}, or delete it: every stage then runs again, and what former runs made has \
                 to be removed or put aside (--move-aside)",
                path.to_slash_lossy()
            )),
            Self::LedgerFormat { path, found, supported } => Some(format!(
                "{}delete {}: every stage then runs again, and what former \
                 runs made has to be removed or put aside (--move-aside)",
                if found > supported { "use the newer program, or " } else { "" },
                path.to_slash_lossy()
            )),
            Self::OtherRoot { before, .. } => Some(format!(
                "run it in {}, or use a copy of the pipeline file",
                before.to_slash_lossy()
            )),
            Self::HoldsOurs { .. } => {
                Some("name the files or subdirectories that the stage reads or makes".to_owned())
            }
            Self::Busy { .. } | Self::StageLeftAtWork { .. } => {
                Some("wait for it to end, or stop it".to_owned())
            }
            Self::Io { source, .. } if is_held(source) => {
                Some("another program has it open: close it there, then run again".to_owned())
            }
            Self::Unreadable { .. } => {
                Some("check the path; relative paths start at the current folder".to_owned())
            }
            Self::NotMade { nearest, .. } => did_you_mean(nearest.as_ref()).or_else(|| {
                Some(
                    "name a file that a stage makes, or a file in a directory that one makes"
                        .to_owned(),
                )
            }),
            Self::OnCluster { engine, .. } => {
                Some(format!("follow them with `--executor {engine}`, or cancel the jobs first"))
            }
            Self::Engine { .. } => {
                Some("check that the cluster's programs are on the PATH and answer".to_owned())
            }
            Self::NameNotText { .. } => Some("rename it".to_owned()),
            Self::NoRoot { .. } => Some(
                "let outputs begin with a parameter, such as `out` in \"{out}/drives\"".to_owned(),
            ),
            Self::OverrideType { .. }
            | Self::BadVariant { .. }
            | Self::Cycle { .. }
            | Self::Io { .. }
            | Self::Interrupted => None,
        }
    }

    /// Whether what was asked for cannot be meant, whatever the files are: a wrong word of the call.
    pub fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::OverrideForm { .. }
                | Self::UnknownOverride { .. }
                | Self::OverrideType { .. }
                | Self::UnknownTarget { .. }
                | Self::BadVariant { .. }
        )
    }

    /// For `map_err`: an I/O error with what was being done to which path.
    pub(crate) fn io(
        doing: &'static str,
        path: impl Into<PathBuf>,
    ) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { doing, path, source }
    }
}

/// One step of a circle of stages: `stage` needs `file`, which `maker` makes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CycleStep {
    /// The stage that waits.
    pub stage: String,
    /// The input that it waits for.
    pub file: String,
    /// The stage that makes it.
    pub maker: String,
}

fn counted(count: usize) -> String {
    match count {
        1 => "one stage".to_owned(),
        count => format!("{count} stages"),
    }
}

fn holder(pid: Option<u32>) -> String {
    pid.map_or_else(String::new, |pid| format!(", process {pid} or a stage that it left behind,"))
}

fn circle(steps: &[CycleStep]) -> String {
    let step = |s: &CycleStep| format!("`{}` needs `{}` from `{}`", s.stage, s.file, s.maker);
    steps.iter().map(step).collect::<Vec<_>>().join(", ")
}
