//! What can go wrong in the seat.

use maveric_seat_page::SeatPageError;
use maveric_study::StudyError;
use std::path::PathBuf;

/// Why the seat cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SeatError {
    /// The file of people and answers.
    #[error("{}: {source}", path.display())]
    Store {
        /// The file.
        path: PathBuf,
        /// What SQLite says.
        source: rusqlite::Error,
    },
    /// A file that cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// An address that cannot be served.
    #[error("cannot listen on {address}: {problem}")]
    Address {
        /// The address.
        address: String,
        /// Why not.
        problem: String,
    },
    /// A record that cannot be driven again.
    #[error("{}: {source}", path.display())]
    Record {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: SeatPageError,
    },
    /// A study that cannot be run in the seat.
    #[error("{problem}")]
    Protocol {
        /// What is wrong.
        problem: String,
        /// What to do.
        help: Option<String>,
    },
    /// The system gives no random numbers.
    #[error("no random numbers for links: {problem}")]
    Random {
        /// What the system says.
        problem: String,
    },
    /// The study's files.
    #[error(transparent)]
    Study(#[from] StudyError),
}

impl SeatError {
    /// The next step, where one is known.
    pub fn suggestion(&self) -> Option<String> {
        match self {
            Self::Protocol { help, .. } => help.clone(),
            Self::Address { .. } => Some("choose another one: --bind 127.0.0.1:PORT".to_owned()),
            Self::Study(error) => error.suggestion(),
            _ => None,
        }
    }
}
