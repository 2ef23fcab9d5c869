//! What can go wrong in the seat.

use crate::hindrance::Hindrance;
use maveric_bag::BagError;
use maveric_domain::DomainError;
use maveric_model::ModelError;
use maveric_seat_page::SeatPageError;
use maveric_study::StudyError;
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// Why the seat cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SeatError {
    /// The file of people and answers.
    #[error("{}: {source}", path.to_slash_lossy())]
    Store { path: PathBuf, source: rusqlite::Error },
    /// A file of people and answers that another version wrote.
    #[error("{}: found version {found} of the seat's state, expected {expected}", path.to_slash_lossy())]
    Version { path: PathBuf, found: i64, expected: i64 },
    /// A file of people and answers that another program has open.
    #[error("{}: another seat has it open", path.to_slash_lossy())]
    InUse { path: PathBuf },
    /// Somebody who is to be forgotten and whom nothing knows.
    #[error("nobody is called `{participant}` here")]
    Nobody {
        participant: String,
        /// The id that is nearest to it.
        nearest: Option<String>,
    },
    /// A file that cannot be read or written.
    #[error("{}: {source}", path.to_slash_lossy())]
    Io { path: PathBuf, source: std::io::Error },
    /// An address that cannot be served.
    #[error("cannot listen on {address}: {problem}")]
    Address {
        /// Host and port, as given.
        address: String,
        problem: String,
    },
    /// A certificate or its key that cannot be used.
    #[error("{}: {problem}", path.to_slash_lossy())]
    Certificate { path: PathBuf, problem: String },
    /// A record that cannot be driven again.
    #[error("{}: {source}", path.to_slash_lossy())]
    Record { path: PathBuf, source: SeatPageError },
    /// A log that cannot be read.
    #[error(transparent)]
    Log(#[from] BagError),
    /// A log without the record of a drive.
    #[error("{} holds no record of a drive", .0.to_slash_lossy())]
    NoRecord(PathBuf),
    /// A model that is none.
    #[error("the model that is to ride: {0}")]
    Model(#[from] ModelError),
    /// A study that the seat cannot run to its end: everything that is missing.
    #[error("the seat cannot run this study:{}", listed(.0))]
    Unfit(Vec<Hindrance>),
    /// Something that the seat cannot do.
    #[error("{problem}")]
    Protocol { problem: String, help: Option<String> },
    /// Work that stopped in the middle.
    #[error("work on a request did not end: {problem}")]
    Unfinished { problem: String },
    /// The system gives no random numbers.
    #[error("no random numbers for links: {problem}")]
    Random { problem: String },
    #[error(transparent)]
    Study(#[from] StudyError),
}

/// A line each, with what to do.
fn listed(all: &[Hindrance]) -> String {
    let line = |hindrance: &Hindrance| format!("\n- {}", hindrance.with_remedy());
    all.iter().map(line).collect()
}

impl From<Hindrance> for SeatError {
    fn from(one: Hindrance) -> Self {
        Self::Unfit(vec![one])
    }
}

impl From<DomainError> for SeatError {
    fn from(error: DomainError) -> Self {
        Self::Study(error.into())
    }
}

impl SeatError {
    /// Something that cannot be done, and what can.
    pub(crate) fn cannot(problem: impl Into<String>, help: &str) -> Self {
        Self::Protocol { problem: problem.into(), help: Some(help.to_owned()) }
    }

    /// A file that cannot be read or written.
    pub(crate) fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    /// What SQLite says of the file of people and answers.
    pub(crate) fn store(path: &Path, source: rusqlite::Error) -> Self {
        Self::Store { path: path.to_owned(), source }
    }

    /// The next step, where one is known.
    pub fn suggestion(&self) -> Option<String> {
        match self {
            Self::Protocol { help, .. } => help.clone(),
            Self::Version { .. } => Some(
                "end the study with the version that began it; its files are beside it".to_owned(),
            ),
            Self::NoRecord(_) => Some(
                "give a log that the seat wrote (logs/seat/), or the record beside it (seat/PERSON-CONDITION.jsonl)"
                    .to_owned(),
            ),
            Self::InUse { .. } => Some(
                "close the seat that is open (Ctrl-C, or the last button of its page /lab), or do it from that page".to_owned(),
            ),
            Self::Nobody { nearest, .. } => {
                Some(nearest.as_ref().map_or_else(
                    || "the ids are those on /lab and in the table of people".to_owned(),
                    |nearest| format!("did you mean `{nearest}`? ids are case-sensitive"),
                ))
            }
            Self::Address { .. } => Some("choose another one: --bind 127.0.0.1:PORT".to_owned()),
            Self::Study(error) => error.suggestion(),
            _ => None,
        }
    }
}
