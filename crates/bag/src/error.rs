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
