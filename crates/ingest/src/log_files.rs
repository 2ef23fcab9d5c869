//! The logs at a path: a file, a recording that was split, or whatever lies below a folder.

use crate::{
    error::IngestError,
    folder::entries_of,
    foreign,
    mapping::Mapping,
    read_log::format_of,
    split::{first_parts, log_parts},
};
use maveric_bag::is_split;
use std::path::{Path, PathBuf};

/// The logs at `path`: itself if it is a file or one recording split over a folder, or the first part of the recording that it is a part of; else the files of the folder and of the folders
/// below it that end in `.mcap`, `.csv`, `.tsv`, `.txt` or `.parquet` and the split recordings there; of a folder its files first,
/// then its folders, each by name.
///
/// Files and folders that the mapping skips are not among them, nor are hidden folders. Of the parts of one recording there is the first.
///
/// # Errors
/// [`IngestError::NotFound`] or [`IngestError::Io`]; [`IngestError::NotALog`] for a folder that holds no log but a file
/// that can be made one, such as a ROS 1 bag.
pub fn log_files(path: &Path, mapping: Option<&Mapping>) -> Result<Vec<PathBuf>, IngestError> {
    let wrong = |e| IngestError::io(path, e);
    if !std::fs::metadata(path).map_err(wrong)?.is_dir() || is_split(path) {
        let mut parts = log_parts(path, mapping)?;
        parts.truncate(1);
        return Ok(parts);
    }
    let mut below = Below { mapping, logs: Vec::new(), others: Vec::new(), above: Vec::new() };
    below.look_into(path)?;
    if let (true, Some(other)) = (below.logs.is_empty(), below.others.first()) {
        format_of(other)?;
    }
    Ok(below.logs)
}

/// What lies below a folder.
struct Below<'a> {
    mapping: Option<&'a Mapping>,
    logs: Vec<PathBuf>,
    /// Files that can be made logs.
    others: Vec<PathBuf>,
    /// The folders that are being looked into: a link may lead back to one.
    above: Vec<PathBuf>,
}

impl Below<'_> {
    fn look_into(&mut self, folder: &Path) -> Result<(), IngestError> {
        let place = std::fs::canonicalize(folder).map_err(|e| IngestError::io(folder, e))?;
        if self.above.contains(&place) {
            return Ok(());
        }
        self.above.push(place);
        let (mut files, mut folders) = (Vec::new(), Vec::new());
        for entry in entries_of(folder)? {
            if self.mapping.is_some_and(|m| m.skips(&entry)) {
                continue;
            }
            if is_split(&entry) {
                files.push(entry);
            } else if entry.is_dir() {
                folders.push(entry);
            } else if of_kind(&entry, &TABLES_AND_LOGS) {
                files.push(entry);
            } else if of_kind(&entry, &foreign::EXTENSIONS) {
                self.others.push(entry);
            }
        }
        self.logs.extend(first_parts(files, self.mapping));
        let hidden = |name: &std::ffi::OsStr| name.to_string_lossy().starts_with('.');
        for folder in folders {
            if !folder.file_name().is_some_and(hidden) {
                self.look_into(&folder)?;
            }
        }
        self.above.pop();
        Ok(())
    }
}

/// How the names of logs end.
const TABLES_AND_LOGS: [&str; 5] = ["mcap", "csv", "tsv", "txt", "parquet"];

fn of_kind(file: &Path, kinds: &[&str]) -> bool {
    let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
    kinds.iter().any(|kind| extension == *kind) && file.is_file()
}
