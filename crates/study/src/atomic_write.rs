//! Files appear whole or not at all, and over nothing that is not to be written over.

use crate::{
    error::StudyError,
    outputs::{refuse_other_kind, refuse_unusual, while_held},
};
use maveric_domain::{DriveMeta, Recording};
use maveric_ingest::{Beside, IngestError, write_mcap_with};
use std::{
    collections::BTreeSet,
    fs,
    io::{Seek as _, Write},
    path::{Path, PathBuf},
    sync::Mutex,
    time::Duration,
};

/// How files that are being written begin and end.
const FRESH: (&str, &str) = (".maveric-", ".tmp");
/// A file that is being written is locked within this time after it was made. Long, since some network file systems keep locks from other
/// machines: there a file whose writing pauses is told from one that was left by its age alone.
const UNLOCKED: Duration = Duration::from_mins(1);

/// Writes a file beside its place, syncs it, then renames it there.
///
/// A plain file of the same kind is replaced; anything else is not. What a killed program was writing in the folder goes.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadFile`]; whatever stood there before stays as it was.
pub fn atomic_write(
    path: &Path,
    write: impl FnOnce(&mut fs::File) -> Result<(), StudyError>,
) -> Result<(), StudyError> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    refuse_unusual(path)?;
    fs::create_dir_all(folder).map_err(StudyError::write(folder))?;
    remove_left_behind(folder);
    let mut builder = tempfile::Builder::new();
    builder.prefix(FRESH.0).suffix(FRESH.1);
    // Temporary files are private by default; a result is as readable as any other file, less the umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder
        .tempfile_in(folder)
        .map_err(StudyError::write(folder))?;
    // Where the disk knows no locks nobody takes one, and nobody finds the file free.
    let _ = file.as_file().try_lock();
    write(file.as_file_mut())?;
    file.as_file().sync_all().map_err(StudyError::write(path))?;
    // By the same handle: on Windows what is locked can be read by no other.
    file.rewind().map_err(StudyError::write(path))?;
    refuse_other_kind(path, &mut file)?;
    let _ = file.as_file().unlock(); // whoever reads it in its place
    while_held(file, |file| {
        file.persist(path).map(drop).map_err(|e| (e.error, e.file))
    })
    .map_err(StudyError::write(path))
}

/// Removes what killed programs were writing in a folder, once a program; what cannot be removed stays: it does no harm.
fn remove_left_behind(folder: &Path) {
    static LOOKED_INTO: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    if let Ok(mut folders) = LOOKED_INTO.lock()
        && !folders.insert(folder.to_owned())
    {
        return;
    }
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if !name.starts_with(FRESH.0) || !name.ends_with(FRESH.1) {
            continue;
        }
        let age = entry.metadata().and_then(|m| m.modified()).ok();
        let old = age
            .and_then(|t| t.elapsed().ok())
            .is_some_and(|age| age > UNLOCKED);
        if old
            && let Ok(file) = fs::File::options().write(true).open(entry.path())
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(entry.path());
        }
    }
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

/// Writes a recording as [`atomic_write`] does, with what stands beside it.
///
/// # Errors
/// [`StudyError::Io`] that names the file.
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

/// What a file says, by its reader; nothing where it is not there.
///
/// # Errors
/// As the reader.
pub(crate) fn if_there<T: Default>(
    path: &Path,
    read: impl FnOnce(&Path) -> Result<T, StudyError>,
) -> Result<T, StudyError> {
    if path.is_file() {
        read(path)
    } else {
        Ok(T::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_program_was_writing_goes_and_what_another_is_writing_stays() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let old = std::time::SystemTime::now() - 2 * UNLOCKED;
        let make = |name: &str| {
            let file = fs::File::create(at(name)).unwrap();
            file.set_modified(old).unwrap();
            file
        };
        drop(make(".maveric-killed.tmp"));
        let used = make(".maveric-used.tmp");
        used.try_lock().unwrap();
        fs::write(at(".maveric-fresh.tmp"), "").unwrap();
        drop(make("mine.tmp"));
        atomic_write_bytes(&at("table.csv"), b"a\n1\n").unwrap();
        let left: BTreeSet<String> = fs::read_dir(folder.path())
            .unwrap()
            .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        let expected = [
            ".maveric-fresh.tmp",
            ".maveric-used.tmp",
            "mine.tmp",
            "table.csv",
        ];
        assert_eq!(left, expected.map(str::to_owned).into());
    }
}
