//! What runs made in a study's folder: all of it can be made again, and any of it may hold what somebody did.

use crate::{atomic_write::read_text, error::StudyError};
use path_slash::PathExt as _;
use std::path::{Component, Path, PathBuf};

/// Folders of a study that hold ledgers: beside the pipelines of its own, and where the one that follows from its design is written.
const LEDGERS: [&str; 2] = [".maveric", "pipelines"];

/// Everything that ledgers say was made, and what runs noted of themselves.
///
/// # Errors
/// [`StudyError::BadFile`] for a ledger that is none, [`StudyError::NotPossible`] while a run holds it.
pub(super) fn by_runs(folder: &Path) -> Result<Vec<PathBuf>, StudyError> {
    let mut files = Vec::new();
    for place in LEDGERS.map(|name| folder.join(name)) {
        for entry in std::fs::read_dir(&place).into_iter().flatten() {
            let path = entry.map_err(StudyError::read(&place))?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if name.ends_with(".running") {
                // Empty but for a number, and two runs would hold two files of one name if it went.
                continue;
            }
            if name == ".logs" || name.contains(".lock.") {
                files.push(path);
            } else if path.extension().is_some_and(|e| e == "lock") {
                refuse_running(&path)?;
                files.extend(outputs(folder, &path)?);
                files.push(path);
            }
        }
    }
    files.sort();
    files.dedup();
    Ok(files)
}

/// Refuses while a run is under way: it would write again what is removed.
fn refuse_running(ledger: &Path) -> Result<(), StudyError> {
    let held = ledger.with_extension("lock.running");
    let Ok(file) = std::fs::File::options().write(true).open(&held) else {
        return Ok(());
    };
    if let Err(std::fs::TryLockError::WouldBlock) = file.try_lock() {
        let problem = format!("a run is under way ({})", held.to_slash_lossy());
        let help = "wait until it has ended, or end it; nothing was removed";
        return Err(StudyError::not_possible(problem).with_help(help));
    }
    Ok(())
}

/// The files that a ledger names and that lie in the study's folder; a folder of which it lists no file, whole.
fn outputs(folder: &Path, ledger: &Path) -> Result<Vec<PathBuf>, StudyError> {
    let read: toml::Table = toml::from_str(&read_text(ledger)?)
        .map_err(|e| StudyError::file(ledger, format!("not a ledger of runs: {e}")))?;
    let runs = ["run", "left"].into_iter();
    let runs = runs.filter_map(|key| read.get(key)?.as_table());
    let mut paths = Vec::new();
    for run in runs.flat_map(toml::Table::values) {
        let table = |key: &str| run.get(key).and_then(toml::Value::as_table);
        let words = |list: Option<&toml::Value>| {
            let list = list.and_then(toml::Value::as_array).into_iter().flatten();
            list.filter_map(|word| word.as_str().map(str::to_owned)).collect::<Vec<String>>()
        };
        let files = table("files");
        for output in table("outputs").into_iter().flat_map(toml::Table::keys) {
            if !files.is_some_and(|files| files.contains_key(output)) {
                paths.push(PathBuf::from(output));
            }
        }
        for (output, names) in files.into_iter().flatten() {
            let names = words(Some(names));
            paths.extend(names.iter().map(|name| Path::new(output).join(name)));
        }
        paths.extend(words(run.get("open")).into_iter().map(PathBuf::from));
    }
    let inside = |path: &&PathBuf| {
        let mut parts = path.components();
        parts.all(|part| matches!(part, Component::Normal(_)))
    };
    let within = paths.iter().filter(inside);
    // Of a file the ledger's name for what is in it is empty.
    Ok(within.map(|path| folder.join(path).components().collect()).collect())
}
