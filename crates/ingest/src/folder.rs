//! What lies in a folder, and what it is called there.

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

/// The name of a file without its folder.
pub(crate) fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}
