//! Files appear whole or not at all, and over nothing that is not to be written over.

use crate::{
    error::StudyError,
    outputs::{refuse_other_kind, refuse_unusual},
};
use maveric_domain::{DriveMeta, Recording};
use maveric_ingest::{Beside, IngestError, write_mcap_with};
use maveric_pipeline::Durability;
use std::{
    fs,
    io::{Seek as _, Write as _},
    path::{Path, PathBuf},
};

/// Writes a file as [`maveric_pipeline::atomic_write`] does, over nothing but a plain file of the same kind.
///
/// # Errors
/// What `write` says; [`StudyError::Pipeline`], [`StudyError::BadFile`]; whatever stood there before stays as it was.
pub fn atomic_write(
    path: &Path,
    write: impl FnOnce(&mut fs::File) -> Result<(), StudyError>,
) -> Result<(), StudyError> {
    refuse_unusual(path)?;
    maveric_pipeline::atomic_write(path, Durability::Synced, |file| {
        write(file)?;
        // By the same handle: on Windows what is locked can be read by no other.
        file.rewind().map_err(StudyError::write(path))?;
        refuse_other_kind(path, file)
    })
}

/// Writes bytes as [`atomic_write`] does.
pub fn atomic_write_bytes(path: &Path, bytes: &[u8]) -> Result<(), StudyError> {
    atomic_write(path, |file| file.write_all(bytes).map_err(StudyError::write(path)))
}

/// Writes a recording as [`atomic_write`] does, with what stands beside it.
pub(crate) fn write_recording(
    path: &Path,
    recording: &Recording,
    meta: &DriveMeta,
    beside: &Beside<'_>,
) -> Result<(), StudyError> {
    atomic_write(path, |file| {
        write_mcap_with(recording, meta, beside, file).map_err(|error| match error {
            IngestError::Write { source } => StudyError::write(path)(std::io::Error::other(source)),
            other => other.into(),
        })
    })
}

/// Writes a value as JSON, one field a line, ending in a newline.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadFile`] if the value has no JSON form.
pub(crate) fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<(), StudyError> {
    let mut bytes = serde_json::to_vec_pretty(value)
        .map_err(|e| StudyError::file(path, format!("cannot be written as JSON: {e}")))?;
    bytes.push(b'\n');
    atomic_write_bytes(path, &bytes)
}

/// Reads a value from JSON.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadFile`] with the position of the fault.
pub(crate) fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, StudyError> {
    let text = read_text(path)?;
    serde_json::from_str(&text)
        .map_err(|e| StudyError::file(path, format!("not the JSON expected here: {e}")))
}

/// Reads a text file, refusing folders and empty files by name.
pub fn read_text(path: &Path) -> Result<String, StudyError> {
    if path.is_dir() {
        return Err(StudyError::file(path, "is a folder, expected a file"));
    }
    let text = fs::read_to_string(path).map_err(StudyError::read(path))?;
    if text.trim().is_empty() {
        return Err(StudyError::file(path, "is empty"));
    }
    Ok(text)
}

/// The files of a folder whose names have this ending, by name.
pub(crate) fn files_ending(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, StudyError> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(StudyError::read(folder))? {
        let path = entry.map_err(StudyError::read(folder))?.path();
        if path.extension().is_some_and(|e| e == ending) {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// What a file says, by its reader; nothing where it is not there.
///
/// # Errors
/// As the reader.
pub fn if_there<T: Default>(
    path: &Path,
    read: impl FnOnce(&Path) -> Result<T, StudyError>,
) -> Result<T, StudyError> {
    if path.is_file() { read(path) } else { Ok(T::default()) }
}
