//! What can be wrong with a recording.

use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// A recording that cannot be read, or not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BagError {
    /// The operating system refused.
    #[error("could not read {}", path.to_slash_lossy())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// A recording with a damaged or missing part.
    #[error("{} is damaged at byte {at_byte}: {what}", path.to_slash_lossy())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where the damage was met.
        at_byte: u64,
        /// What is wrong there.
        what: String,
    },
    /// No channel whose topic begins a wanted column.
    #[error("no topic of {} begins `{wanted}`; its topics are {}", path.to_slash_lossy(), found.join(", "))]
    UnknownTopic {
        /// The file.
        path: PathBuf,
        /// The column.
        wanted: String,
        /// The topics there are.
        found: Vec<String>,
        /// The most similar of them.
        nearest: Option<String>,
    },
    /// A channel that cannot be decoded, or lacks a wanted field.
    #[error("topic `{topic}` of {} is refused: {why}", path.to_slash_lossy())]
    Refused {
        /// The file.
        path: PathBuf,
        /// The channel's topic.
        topic: String,
        /// What its schema lacks, or why its encoding cannot be read.
        why: String,
    },
    /// It was told to stop.
    #[error("interrupted")]
    Cancelled,
    /// A recording that could not be written.
    #[error("could not write the recording")]
    Write {
        /// Why.
        #[source]
        source: mcap::McapError,
    },
}

impl BagError {
    /// Names the file in an operating-system error.
    pub(crate) fn io(path: &Path, source: std::io::Error) -> Self {
        let path = path.to_owned();
        Self::Io { path, source }
    }
}
