//! The files that were read for a drive.

use crate::{error::IngestError, folder::file_name};
use std::{fs, path::Path};

/// A file that was read for a drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Its name, without its folder.
    pub name: String,
    /// BLAKE3 of its bytes, in hexadecimal digits.
    pub blake3: String,
}

impl Source {
    pub(crate) fn new(path: &Path, blake3: String) -> Self {
        let name = file_name(path);
        Self { name, blake3 }
    }

    /// Reads a file once: its bytes, and what it is remembered by.
    ///
    /// # Errors
    /// [`IngestError::NotFound`] and the like.
    pub(crate) fn read(path: &Path) -> Result<(Vec<u8>, Self), IngestError> {
        let bytes = fs::read(path).map_err(|e| IngestError::io(path, e))?;
        let hash = blake3::Hasher::new().update_rayon(&bytes).finalize();
        Ok((bytes, Self::new(path, hash.to_hex().to_string())))
    }
}
