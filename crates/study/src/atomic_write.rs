//! Files appear whole or not at all.

use crate::error::StudyError;
use std::{fs, io::Write, path::Path};

/// Writes a file beside its place, syncs it, then renames it there.
///
/// # Errors
/// [`StudyError::Io`]; whatever stood there before stays as it was.
pub fn atomic_write(
    path: &Path,
    write: impl FnOnce(&mut fs::File) -> Result<(), StudyError>,
) -> Result<(), StudyError> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if path.is_dir() {
        return Err(StudyError::file(
            path,
            "is a folder, expected the name of a file to write",
        ));
    }
    fs::create_dir_all(folder).map_err(StudyError::write(folder))?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".").suffix(".tmp");
    // Temporary files are private by default; a result should be as readable as any other file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
    let mut file = builder
        .tempfile_in(folder)
        .map_err(StudyError::write(folder))?;
    write(file.as_file_mut())?;
    file.as_file().sync_all().map_err(StudyError::write(path))?;
    file.persist(path)
        .map_err(|error| StudyError::write(path)(error.error))?;
    Ok(())
}

/// Writes bytes as [`atomic_write`] does.
///
/// # Errors
/// [`StudyError::Io`].
pub fn atomic_write_bytes(path: &Path, bytes: &[u8]) -> Result<(), StudyError> {
    atomic_write(path, |file| {
        file.write_all(bytes).map_err(StudyError::write(path))
    })
}

/// Writes a value as JSON, one field a line, ending in a newline.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadFile`] if the value has no JSON form.
pub fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<(), StudyError> {
    let mut bytes = serde_json::to_vec_pretty(value)
        .map_err(|e| StudyError::file(path, format!("cannot be written as JSON: {e}")))?;
    bytes.push(b'\n');
    atomic_write_bytes(path, &bytes)
}

/// Reads a value from JSON.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadFile`] with the position of the fault.
pub fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, StudyError> {
    let text = read_text(path)?;
    serde_json::from_str(&text)
        .map_err(|e| StudyError::file(path, format!("not the JSON expected here: {e}")))
}

/// Reads a text file, refusing folders and empty files by name.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadFile`].
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
