//! Recordings that were split over several files by their logger.

use crate::{
    error::IngestError,
    folder::{entries_of, file_name},
    mapping::{Mapping, Names},
};
use maveric_bag::{Parts, parts_of};
use std::{
    collections::BTreeMap,
    ffi::OsString,
    path::{Path, PathBuf},
};

/// Number of parts at which a number in a name is no count of parts.
const MOST_PARTS: u64 = 10_000;

/// The files of a log that [`crate::read_log`] reads for it: itself, or all parts of the recording that it is one of.
///
/// # Errors
/// [`IngestError::Io`] where its folder cannot be read; [`IngestError::BadTable`] for two files that are the same part.
pub fn log_parts(path: &Path, mapping: Option<&Mapping>) -> Result<Vec<PathBuf>, IngestError> {
    if path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let files = parts(path, mapping)?.files;
    Ok(if files.is_empty() { vec![path.to_owned()] } else { files })
}

/// The files of a recording in their order, and names of those that are not there: a folder as rosbag2 writes it, or files that the
/// mapping's names say to be parts.
pub(crate) fn parts(path: &Path, mapping: Option<&Mapping>) -> Result<Parts, IngestError> {
    let names = mapping.and_then(|m| m.names.as_ref());
    let Some((mapping, names)) =
        mapping.zip(names).filter(|(_, n)| n.parts.is_some() && path.is_file())
    else {
        return Ok(parts_of(path)?);
    };
    let (key, _) = part_of(path, names);
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty());
    let mut parts: Vec<(Option<u64>, PathBuf)> = Vec::new();
    for file in entries_of(folder.unwrap_or(Path::new(".")))? {
        let (theirs, number) = part_of(&file, names);
        if theirs == key && file.is_file() && !mapping.skips(&file) {
            // As it was named: without the current directory.
            let file = path.with_file_name(file.file_name().unwrap_or_default());
            parts.push((number, file));
        }
    }
    parts.sort();
    if let Some(same) = parts.windows(2).find(|w| w[0].0 == w[1].0) {
        let other = file_name(&same[0].1);
        let what =
            format!("it is the same part of a recording as {other}: expected each number once");
        return Err(IngestError::bad_table(&same[1].1, what));
    }
    let numbers: Vec<u64> = parts.iter().filter_map(|p| p.0).collect();
    let whole_first = parts.first().is_some_and(|p| p.0.is_none());
    let mut missing = Vec::new();
    if let (Some(&first), Some(&last)) = (numbers.first(), numbers.last()) {
        // The first may have no number; then the second is 1 or 2.
        let from = first.min(if whole_first { 2 } else { 1 });
        if last - from < MOST_PARTS {
            let absent = (from..=last).filter(|n| !numbers.contains(n));
            missing.extend(absent.map(|n| names.name_of_part(&key.0, n) + &ending(&key.1)));
        }
    }
    let files = parts.into_iter().map(|p| p.1).collect();
    Ok(Parts { files, missing })
}

/// Of the files of one folder those that are the first part of their recording, in their order.
pub(crate) fn first_parts(files: Vec<PathBuf>, mapping: Option<&Mapping>) -> Vec<PathBuf> {
    let Some(names) = mapping.and_then(|m| m.names.as_ref()).filter(|n| n.parts.is_some()) else {
        return files;
    };
    let mut first: BTreeMap<Recording, (Option<u64>, usize)> = BTreeMap::new();
    for (place, file) in files.iter().enumerate() {
        let (recording, number) = part_of(file, names);
        let least = first.entry(recording).or_insert((number, place));
        *least = (*least).min((number, place));
    }
    let kept: Vec<usize> = first.into_values().map(|(_, place)| place).collect();
    let numbered = files.into_iter().enumerate();
    numbered.filter(|(place, _)| kept.contains(place)).map(|(_, file)| file).collect()
}

/// What the parts of a recording have in common in one folder: their name without the number, and its ending.
type Recording = (String, OsString);

fn part_of(file: &Path, names: &Names) -> (Recording, Option<u64>) {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let (recording, number) = names.part(&stem);
    let extension = file.extension().unwrap_or_default().to_owned();
    ((recording.to_owned(), extension), number)
}

fn ending(extension: &OsString) -> String {
    if extension.is_empty() {
        return String::new();
    }
    format!(".{}", extension.to_string_lossy())
}
