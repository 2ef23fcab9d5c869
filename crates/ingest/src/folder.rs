//! What lies in a folder.

use crate::error::IngestError;
use std::path::{Path, PathBuf};

/// What a folder holds, sorted by name.
pub(crate) fn entries_of(folder: &Path) -> Result<Vec<PathBuf>, IngestError> {
    let entries = std::fs::read_dir(folder).and_then(|entries| {
        let paths = entries.map(|entry| entry.map(|e| e.path()));
        paths.collect::<Result<Vec<PathBuf>, _>>()
    });
    let mut entries = entries.map_err(|e| IngestError::io(folder, e))?;
    entries.sort();
    Ok(entries)
}
