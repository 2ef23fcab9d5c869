//! Everything of somebody's, taken out of a study's folder.

use super::{made, models, rows};
use crate::{
    deciding::hash_of_file,
    design::DesignFile,
    error::StudyError,
    forgotten::FORGOTTEN_FILE,
    named::{is_about, names},
    run_folder::{embeddings_path, training_path},
    stages::{
        export::METADATA,
        import::{column_of_people, has_row_of},
        ingest::logs_of,
    },
    tables::{
        Table,
        collected::{NOTES, SEAT},
    },
};
use maveric_domain::{ParticipantId, design::Software};
use maveric_pipeline::ASIDE;
use serde::Serialize;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// How the seat's own file begins, and what lies beside it while it is open.
const DATABASE: &str = "seat.db";

/// What became of somebody's data.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Forgotten {
    /// Files that were removed, in order: their logs and drives, and whatever runs had made of anybody's.
    pub removed: Vec<PathBuf>,
    /// Tables that lost rows, and how many.
    pub rows: Vec<(PathBuf, usize)>,
    /// Models that had learned from them: removed, and refused wherever a copy of one is met, until there is one that was trained anew.
    pub models: Vec<PathBuf>,
    /// Files that name them still, or may hold them under a pseudonym (earlier exports) or as whatever a run moved aside, and that no
    /// command of ours may change: to be looked at by hand.
    pub left: Vec<PathBuf>,
}

/// Removes all that a study's folder holds of a person: logs, rows of people, answers and other tables, and everything that runs made of
/// it (drives, scores, embeddings, pages: `maveric run` makes them anew without the person). Their id goes into
/// [`crate::forgotten::FORGOTTEN_FILE`], first of all, so that what was begun can be ended by the same call.
///
/// A person of whom nothing is there is forgotten too. Of the design itself nothing is changed; what was given away before is not
/// undone; a folder of `maveric run --cache` outside the study's folder is not looked into.
///
/// # Errors
/// [`StudyError`] where a file cannot be read, changed or removed, a run is under way, or the study is no folder; calling again goes on.
pub fn forget_person(study: &DesignFile, id: &ParticipantId) -> Result<Forgotten, StudyError> {
    if study.path.is_none() {
        let problem = format!("{id} cannot be forgotten: there is no study's folder");
        let help = "stand in the folder of its study.toml, or name that file";
        return Err(StudyError::not_possible(problem).with_help(help));
    }
    let folder = study.folder();
    let by_runs = made::by_runs(&folder)?;
    let (logs, shared) = logs_of(study, id)?;
    let inputs = inputs(study);
    let learned = models_of(study, &folder, id)?;
    let mut known = study.forgotten()?;
    let hashes: Result<Vec<String>, StudyError> =
        learned.iter().map(|model| hash_of_file(model)).collect();
    known.add(id, hashes?);
    known.write(&folder)?;

    let mut forgotten = Forgotten::default();
    let notes: PathBuf = folder.join(SEAT).join(NOTES).components().collect();
    let beside = learned
        .iter()
        .flat_map(|model| [model.clone(), training_path(model), embeddings_path(model)]);
    let by_runs = by_runs.into_iter().filter(|path| !inputs.contains(path));
    let named = files_below(&folder)?.into_iter().filter(|path| is_kept_under(study, path, id));
    for path in by_runs.chain(beside).chain(logs).chain(named) {
        remove(&path, &folder, &mut forgotten.removed)?;
    }
    for path in files_below(&folder)? {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // The seat clears its own file, which it holds open.
        if name == FORGOTTEN_FILE || name.starts_with(DATABASE) {
            continue;
        }
        if let Some(column) = column_of_ids(study, &path)? {
            let mut count = rows::take_out(&path, &column, id, |cell, id| cell == id)?;
            if path == notes && Table::read(&path)?.has("text") {
                count += rows::take_out(&path, "text", id, is_about)?;
            }
            if count > 0 {
                forgotten.rows.push((path.clone(), count));
            }
        }
        if name == METADATA || names_still(study, &path, id)? {
            forgotten.left.push(path);
        }
    }
    forgotten.removed.sort();
    forgotten.models = learned;
    // Some were removed by their names.
    forgotten.left.extend(shared.into_iter().filter(|log| log.exists()));
    forgotten.left.sort();
    forgotten.left.dedup();
    Ok(forgotten)
}

/// Whether a file among the logs, or of the seat, has its name of somebody: one that cannot be read says whose it is by that alone.
fn is_kept_under(study: &DesignFile, path: &Path, id: &ParticipantId) -> bool {
    let folders = [study.design.files().logs.as_path(), Path::new(SEAT)];
    let inside = folders.into_iter().any(|folder| path.starts_with(place_of(study, folder)));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let rest = name.strip_prefix(id.as_str());
    inside && rest.is_some_and(|rest| rest.starts_with(['-', '.']))
}

/// What the design reads, which no ledger may give away for removal.
fn inputs(study: &DesignFile) -> BTreeSet<PathBuf> {
    let files = study.design.files();
    let read =
        [&study.design.people().file, &files.answers, &files.measures, &files.logs, &files.scales];
    read.into_iter().map(|path| place_of(study, path)).collect()
}

/// A path of the design as [`files_below`] gives it.
fn place_of(study: &DesignFile, path: &Path) -> PathBuf {
    study.resolve(path).components().collect()
}

/// The models below the folder that learned from somebody; not one that `[model]` names, which was learned elsewhere.
fn models_of(
    study: &DesignFile,
    folder: &Path,
    id: &ParticipantId,
) -> Result<Vec<PathBuf>, StudyError> {
    let named = study.design.model().map(|model| study.resolve(&model.file));
    let mut models = Vec::new();
    for path in files_below(folder)? {
        let is_model = path.extension().is_some_and(|e| e == "maveric");
        if is_model && Some(&path) != named.as_ref() && models::learned_from(&path)?.contains(id) {
            models.push(path);
        }
    }
    Ok(models)
}

/// The column of a table of words that says whose each row is; none for any other file.
fn column_of_ids(study: &DesignFile, path: &Path) -> Result<Option<String>, StudyError> {
    let is_table =
        path.extension().is_some_and(|e| ["csv", "tsv"].iter().any(|t| e.eq_ignore_ascii_case(t)));
    if !is_table {
        return Ok(None);
    }
    // What is no table names nobody by a column.
    let Ok(table) = Table::read(path) else {
        return Ok(None);
    };
    if is_answers(study, path) && study.design.files().software != Software::Table {
        let column = column_of_people(study)?;
        return Ok(column.filter(|column| table.has(column)));
    }
    Ok(table.has("participant").then(|| "participant".to_owned()))
}

fn is_answers(study: &DesignFile, path: &Path) -> bool {
    *path == place_of(study, &study.design.files().answers)
}

/// Whether a file names somebody, in its path or as a word of its text. Whose a log is was read already, and a number is a word of many
/// texts.
fn names_still(study: &DesignFile, path: &Path, id: &ParticipantId) -> Result<bool, StudyError> {
    let within = path.strip_prefix(study.folder()).unwrap_or(path);
    if names(&within.to_string_lossy(), id.as_str()) || is_aside(within) {
        return Ok(true);
    }
    // A workbook, or a text in another encoding, shows its words to its reader alone.
    if is_answers(study, path) && has_row_of(study, id)? {
        return Ok(true);
    }
    if path.starts_with(place_of(study, &study.design.files().logs)) {
        return Ok(false);
    }
    let bytes = std::fs::read(path).map_err(StudyError::read(path))?;
    Ok(is_about(&String::from_utf8_lossy(&bytes), id.as_str()))
}

/// Whether a run moved it aside, since nobody could tell whether a person or a stage had put it there: nobody can tell of whom it is, too.
fn is_aside(within: &Path) -> bool {
    let mut folders = within.components();
    folders.any(|folder| {
        let name = folder.as_os_str().to_string_lossy();
        name.starts_with(ASIDE)
    })
}

/// Every file of a folder and of the folders in it, in order; links are not followed.
fn files_below(folder: &Path) -> Result<Vec<PathBuf>, StudyError> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).map_err(StudyError::read(&folder))? {
            let entry = entry.map_err(StudyError::read(&folder))?;
            let kind = entry.file_type().map_err(StudyError::read(entry.path()))?;
            if kind.is_dir() {
                folders.push(entry.path());
            } else if kind.is_file() {
                files.push(entry.path().components().collect());
            }
        }
    }
    files.sort();
    Ok(files)
}

/// Removes a file, or a folder with all that is in it, and the folders above it that are empty then.
fn remove(path: &Path, folder: &Path, removed: &mut Vec<PathBuf>) -> Result<(), StudyError> {
    let Ok(metadata) = std::fs::symlink_metadata(path) else {
        return Ok(());
    };
    if metadata.is_dir() {
        removed.extend(files_below(path)?);
        std::fs::remove_dir_all(path).map_err(StudyError::io("remove", path))?;
    } else {
        std::fs::remove_file(path).map_err(StudyError::io("remove", path))?;
        removed.push(path.to_owned());
    }
    let above = path.ancestors().skip(1);
    for empty in above.take_while(|above| above.starts_with(folder) && *above != folder) {
        if std::fs::remove_dir(empty).is_err() {
            break;
        }
    }
    Ok(())
}
