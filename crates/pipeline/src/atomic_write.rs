//! Files that appear whole or not at all.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use crate::PipelineError;
use crate::error::is_held;

/// How files that are being written begin and end.
const FRESH: (&str, &str) = (".maveric-", ".tmp");
/// A file that is being written is locked within this time after it was made. Long, since some network file systems keep locks from other
/// machines: there a file whose writing pauses is told from one that was left by its age alone.
const UNLOCKED: Duration = Duration::from_mins(1);

/// Whether a write must have reached the disk before the call returns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Durability {
    /// Survives a power cut.
    Synced,
    /// Survives the death of this process, which is enough where losing it only costs work.
    Written,
}

/// Writes a file beside its place by `fill`, then renames it there; creates the directory if need be. What killed programs were writing
/// in that directory goes.
///
/// The file is as readable as any other, less the umask; in the place of one that its owner alone may read it stays so.
///
/// # Errors
/// What `fill` says; [`PipelineError::Io`] if the directory or the file cannot be written. Whatever stood there before stays as it was.
pub fn atomic_write<E: From<PipelineError>>(
    path: &Path,
    durability: Durability,
    fill: impl FnOnce(&mut File) -> Result<(), E>,
) -> Result<(), E> {
    let folder = folder_of(path);
    fs::create_dir_all(folder).map_err(PipelineError::io("create", folder))?;
    remove_left_behind(folder);
    let failed = || PipelineError::io("write", path);
    let mut builder = tempfile::Builder::new();
    let prefix = named_after(path);
    builder.prefix(&prefix).suffix(FRESH.1);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode_for(path)));
    let mut file = builder.tempfile_in(folder).map_err(failed())?;
    // Where the disk knows no locks nobody takes one, and nobody finds the file free.
    let _ = file.as_file().try_lock();
    fill(file.as_file_mut())?;
    if durability == Durability::Synced {
        file.as_file().sync_all().map_err(failed())?;
    }
    let _ = file.as_file().unlock(); // whoever reads it in its place
    let replace =
        |file: tempfile::NamedTempFile| file.persist(path).map(drop).map_err(|e| (e.error, e.file));
    Ok(while_held(file, replace).map_err(failed())?)
}

/// Writes bytes as [`atomic_write`] does.
///
/// # Errors
/// [`PipelineError::Io`].
pub fn atomic_write_bytes(
    path: &Path,
    bytes: &[u8],
    durability: Durability,
) -> Result<(), PipelineError> {
    atomic_write(path, durability, |file| {
        file.write_all(bytes).map_err(PipelineError::io("write", path))
    })
}

/// Replaces a file by `fresh`. On Windows one that another program has open cannot be replaced: scanners and indexers let go within
/// moments, so it is tried again for about a second, with what `replace` gives back.
///
/// # Errors
/// The last one of `replace`.
pub fn while_held<T>(
    mut fresh: T,
    replace: impl Fn(T) -> Result<(), (io::Error, T)>,
) -> io::Result<()> {
    let mut pause = Duration::from_millis(15);
    loop {
        let Err((error, back)) = replace(fresh) else {
            return Ok(());
        };
        if !is_held(&error) || pause > Duration::from_millis(500) {
            return Err(error);
        }
        std::thread::sleep(pause);
        (fresh, pause) = (back, 2 * pause);
    }
}

/// The mode of a file that is written to this place: its owner's alone if that of the file there is.
#[cfg(unix)]
fn mode_for(path: &Path) -> u32 {
    use std::os::unix::fs::PermissionsExt as _;
    let others = |m: fs::Metadata| m.permissions().mode() & 0o077;
    if fs::metadata(path).map(others).ok() == Some(0) { 0o600 } else { 0o666 }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// How a file that is being written for this one begins; of a long name its first part, since names have an end.
fn named_after(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name: String = name.chars().take(50).collect();
    format!("{}{name}", FRESH.0)
}

/// Removes what killed writers of a file, and of those named after it, left beside it: whoever calls this knows that nobody else writes it.
pub(crate) fn remove_unfinished(path: &Path) {
    let prefix = named_after(path);
    for entry in fs::read_dir(folder_of(path)).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with(&prefix) && is_unfinished(&name) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether a file of this name is one that is being written, or was when its program was killed.
pub(crate) fn is_unfinished(name: &str) -> bool {
    name.starts_with(FRESH.0) && name.ends_with(FRESH.1)
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
        if !is_unfinished(&entry.file_name().to_string_lossy()) {
            continue;
        }
        let age = entry.metadata().and_then(|m| m.modified()).ok();
        let old = age.and_then(|t| t.elapsed().ok()).is_some_and(|age| age > UNLOCKED);
        if old
            && let Ok(file) = File::options().write(true).open(entry.path())
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> BTreeSet<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn what_a_killed_program_was_writing_goes_and_what_another_is_writing_stays() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let old = std::time::SystemTime::now() - 2 * UNLOCKED;
        let make = |name: &str| {
            let file = File::create(at(name)).unwrap();
            file.set_modified(old).unwrap();
            file
        };
        drop(make(".maveric-killed.tmp"));
        let used = make(".maveric-used.tmp");
        used.try_lock().unwrap();
        fs::write(at(".maveric-fresh.tmp"), "").unwrap();
        drop(make("mine.tmp"));
        atomic_write_bytes(&at("table.csv"), b"a\n1\n", Durability::Synced).unwrap();
        let expected = [".maveric-fresh.tmp", ".maveric-used.tmp", "mine.tmp", "table.csv"];
        assert_eq!(names(folder.path()), expected.map(str::to_owned).into());
    }

    #[test]
    fn what_cannot_be_written_to_its_end_leaves_what_stood_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new").join("table.csv");
        for (text, ends_well) in [("first", true), ("second", false), ("third", true)] {
            let before = fs::read_to_string(&path).unwrap_or_default();
            let fill = |file: &mut File| {
                file.write_all(text.as_bytes()).unwrap();
                if ends_well { Ok(()) } else { Err(PipelineError::Interrupted) }
            };
            assert_eq!(atomic_write(&path, Durability::Written, fill).is_ok(), ends_well);
            let now = fs::read_to_string(&path).unwrap();
            assert_eq!(now, if ends_well { text } else { &before });
            assert_eq!(names(path.parent().unwrap()).len(), 1);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_file_is_as_readable_as_any_other() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let (usual, ours) = (folder.path().join("usual"), folder.path().join("ours"));
        fs::write(&usual, "").unwrap();
        atomic_write_bytes(&ours, b"", Durability::Written).unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&usual), mode(&ours));
        fs::set_permissions(&ours, fs::Permissions::from_mode(0o600)).unwrap();
        atomic_write_bytes(&ours, b"again", Durability::Written).unwrap();
        assert_eq!(mode(&ours) & 0o777, 0o600);
    }
}
