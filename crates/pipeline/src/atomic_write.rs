//! Files that appear whole or not at all.

use std::io::Write;
use std::path::Path;
use std::time::Duration;

use crate::PipelineError;
use crate::error::is_held;

/// Whether a write must have reached the disk before the call returns.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Durability {
    /// Survives a power cut.
    Synced,
    /// Survives the death of this process, which is enough where losing it only costs work.
    Written,
}

/// Writes beside `path`, then renames; creates the directory if need be.
///
/// # Errors
/// [`PipelineError::Io`] if the directory or the file cannot be written.
pub(crate) fn write(
    path: &Path,
    content: &[u8],
    durability: Durability,
) -> Result<(), PipelineError> {
    let folder = folder_of(path);
    std::fs::create_dir_all(folder).map_err(PipelineError::io("create", folder))?;
    let failed = || PipelineError::io("write", path);
    let prefix = unfinished(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the umask
    let mut file = builder.tempfile_in(folder).map_err(failed())?;
    file.write_all(content).map_err(failed())?;
    if durability == Durability::Synced {
        file.as_file().sync_all().map_err(failed())?;
    }
    persist(file, path).map_err(failed())
}

/// Puts a file in its place. On Windows one that another program has open cannot be replaced: scanners and indexers let go within
/// moments, so it is tried again for about a second.
fn persist(mut file: tempfile::NamedTempFile, path: &Path) -> std::io::Result<()> {
    let mut pause = Duration::from_millis(15);
    loop {
        let Err(refused) = file.persist(path) else {
            return Ok(());
        };
        if !is_held(&refused.error) || pause > Duration::from_millis(500) {
            return Err(refused.error);
        }
        std::thread::sleep(pause);
        (file, pause) = (refused.file, 2 * pause);
    }
}

/// Removes what killed writers of `path` and of files named after it left beside it.
pub(crate) fn remove_unfinished(path: &Path) {
    let mut prefix = unfinished(path);
    prefix.truncate(prefix.len() - SUFFIX.len());
    let Ok(entries) = std::fs::read_dir(folder_of(path)) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with(&prefix) && name.contains(SUFFIX) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

const SUFFIX: &str = ".writing-";

fn unfinished(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    format!(".{name}{SUFFIX}")
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}
