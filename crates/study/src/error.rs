//! What can go wrong between files and the science.

use maveric_domain::DomainError;
use maveric_pipeline::{PipelineError, is_held};
use path_slash::PathExt as _;
use std::path::PathBuf;

/// What to do about a score that its scale does not have.
pub(crate) const CHECK_SCORE: &str = "check the score: its scale is that of the study's `[style]`, and the ADB's (11 to 55) where no study says one";

/// A command's failure, naming the file and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A file that cannot be read or written.
    #[error("cannot {action} {}", path.to_slash_lossy())]
    Io {
        /// `read`, `write`, …
        action: &'static str,
        path: PathBuf,
        source: std::io::Error,
    },
    /// A table that cannot be parsed.
    #[error("{}: not a readable {format} table: {problem}", path.to_slash_lossy())]
    BadTable { path: PathBuf, format: &'static str, problem: String },
    /// A table without the column asked for.
    #[error("{}: no column `{wanted}`; columns are {}", path.to_slash_lossy(), found.join(", "))]
    NoColumn { path: PathBuf, wanted: String, found: Vec<String>, nearest: Option<String> },
    /// A cell that does not hold what its column should.
    #[error("{}: row {row}, column `{column}`: found `{found}`, expected {expected}", path.to_slash_lossy())]
    BadCell {
        path: PathBuf,
        /// Data row, from 1 (the header is not counted).
        row: usize,
        /// Its name in the header.
        column: String,
        found: String,
        expected: String,
    },
    /// A file that holds something else than it should.
    #[error("{}: {problem}", path.to_slash_lossy())]
    BadFile {
        path: PathBuf,
        /// What was found and what was expected.
        problem: String,
        help: Option<String>,
    },
    /// A request that cannot be met with these data.
    #[error("{problem}")]
    NotPossible {
        /// What was found and what was expected.
        problem: String,
        help: Option<String>,
    },
    #[error("interrupted")]
    Interrupted,
    /// A file that could not be put in its place.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// A value that the nouns refuse.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// A log that cannot be ingested.
    #[error(transparent)]
    Ingest(#[from] maveric_ingest::IngestError),
    /// A questionnaire that cannot be scored.
    #[error(transparent)]
    Measure(#[from] maveric_measures::MeasureError),
    /// A study that cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] maveric_analysis::AnalysisError),
    /// Training, personalising or steering that failed.
    #[error(transparent)]
    Model(#[from] maveric_model::ModelError),
    /// Recorded car-following that cannot be evaluated.
    #[error(transparent)]
    Following(#[from] maveric_following::FollowingError),
    /// A drive that could not be simulated.
    #[error(transparent)]
    Simulator(#[from] maveric_simulator::SimulatorError),
    /// People that could not be made up.
    #[error(transparent)]
    Participants(#[from] maveric_participants::ParticipantError),
    /// A study that cannot be made up.
    #[error(transparent)]
    Rehearsal(#[from] maveric_rehearsal::RehearsalError),
    /// A test that refuses its data.
    #[error(transparent)]
    Stats(#[from] maveric_stats::StatsError),
    /// A figure or page that could not be drawn.
    #[error(transparent)]
    Report(#[from] maveric_report::ReportError),
}

impl StudyError {
    /// The next step, where one is known.
    pub fn suggestion(&self) -> Option<String> {
        match self {
            Self::NoColumn { nearest, .. } => {
                nearest.as_ref().map(|name| format!("did you mean `{name}`?"))
            }
            Self::BadFile { help, .. } | Self::NotPossible { help, .. } => help.clone(),
            Self::Io { source, .. } if source.kind() == std::io::ErrorKind::NotFound => {
                Some("check the path; relative paths start at the current folder".to_owned())
            }
            Self::Io { source, .. } if is_held(source) => {
                Some("another program has it open: close it there, then run again".to_owned())
            }
            Self::Pipeline(error) => error.suggestion(),
            Self::Analysis(error) => error.suggestion().map(str::to_owned),
            Self::Stats(error) => error.suggestion().map(str::to_owned),
            Self::Ingest(error) => error.suggestion(),
            Self::Model(error) => error.suggestion().map(str::to_owned),
            Self::Domain(DomainError::NotOnScale { .. }) => Some(CHECK_SCORE.to_owned()),
            _ => None,
        }
    }

    /// What the system said when something could not be done to a file: `read`, `write`, …
    pub(crate) fn io(
        action: &'static str,
        path: impl Into<PathBuf>,
    ) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { action, path, source }
    }

    pub(crate) fn read(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        Self::io("read", path)
    }

    pub(crate) fn write(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        Self::io("write", path)
    }

    /// Of a table with other columns than the one asked for.
    pub(crate) fn no_column(path: impl Into<PathBuf>, wanted: &str, found: Vec<String>) -> Self {
        let nearest = maveric_domain::nearest(wanted, found.iter().map(String::as_str));
        Self::NoColumn {
            path: path.into(),
            wanted: wanted.to_owned(),
            nearest: nearest.map(str::to_owned),
            found,
        }
    }

    pub(crate) fn file(path: impl Into<PathBuf>, problem: impl Into<String>) -> Self {
        Self::BadFile { path: path.into(), problem: problem.into(), help: None }
    }

    pub(crate) fn not_possible(problem: impl Into<String>) -> Self {
        Self::NotPossible { problem: problem.into(), help: None }
    }

    /// The same with what to do; of errors that say it by themselves nothing changes.
    pub(crate) fn with_help(mut self, text: impl Into<String>) -> Self {
        if let Self::BadFile { help, .. } | Self::NotPossible { help, .. } = &mut self {
            *help = Some(text.into());
        }
        self
    }
}
