//! Drives as files: one Parquet file a drive, and `drives.csv` beside them.

use super::{Table, TableBuilder};
use crate::{atomic_write::atomic_write, error::StudyError};
use maveric_domain::{Drive, DriveId, DriveMeta};
use maveric_ingest::{Provenance, read_drive_from, write_drive_to};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Writes `<folder>/<drive>.parquet` of a drive that was made here, from no log.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::Ingest`].
pub fn write_drive(folder: &Path, drive: &Drive) -> Result<PathBuf, StudyError> {
    write_drive_of(folder, drive, &Provenance::default())
}

/// Writes `<folder>/<drive>.parquet`, with what the drive was made from in its metadata.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::Ingest`].
pub fn write_drive_of(
    folder: &Path,
    drive: &Drive,
    provenance: &Provenance,
) -> Result<PathBuf, StudyError> {
    let path = folder.join(format!("{}.parquet", drive.meta().drive));
    atomic_write(&path, |file| Ok(write_drive_to(file, drive, provenance)?))?;
    Ok(path)
}

/// Reads one drive back.
///
/// # Errors
/// [`StudyError::Ingest`] for what is no drive.
pub fn read_drive(path: &Path) -> Result<Drive, StudyError> {
    Ok(read_drive_from(path)?.0)
}

/// Reads every drive of a folder, ordered by file name.
///
/// # Errors
/// [`StudyError::BadFile`] for a folder without drives, and as [`read_drive`].
pub fn read_drives(folder: &Path) -> Result<Vec<Drive>, StudyError> {
    let entries = std::fs::read_dir(folder).map_err(StudyError::read(folder))?;
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry.map_err(StudyError::read(folder))?.path();
        let hidden = path
            .file_name()
            .is_some_and(|n| n.to_string_lossy().starts_with('.'));
        if !hidden && path.extension().is_some_and(|e| e == "parquet") {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        return Err(StudyError::BadFile {
            path: folder.to_owned(),
            problem: "holds no drives (*.parquet)".to_owned(),
            help: Some("make drives from logs with `maveric ingest LOG… --out DIR`".to_owned()),
        });
    }
    paths.sort();
    paths.iter().map(|p| read_drive(p)).collect()
}

/// The drives that `<folder>/drives.csv` lists and that are not among `now`: made here by an earlier call, and no
/// more. None where there is no such list.
pub(crate) fn former_drives<'a>(
    folder: &Path,
    now: impl IntoIterator<Item = &'a str>,
) -> Vec<DriveId> {
    let listed = Table::read(&folder.join("drives.csv")).and_then(|list| list.ids("drive"));
    let mut former: Vec<DriveId> = listed.unwrap_or_default();
    let now: BTreeSet<&str> = now.into_iter().collect();
    former.retain(|drive| !now.contains(drive.as_str()));
    former
}

/// Removes a file of an earlier call; one that is not there is fine.
///
/// # Errors
/// [`StudyError::Io`].
pub(crate) fn remove_former(file: &Path) -> Result<(), StudyError> {
    match std::fs::remove_file(file) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(StudyError::write(file)(error))
        }
        _ => Ok(()),
    }
}

/// Writes `<folder>/drives.csv`: one row a drive. Drives that an earlier list has and this one has not are removed:
/// whatever reads the folder would take them for drives of this study.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_drive_list(
    folder: &Path,
    drives: &[(DriveMeta, usize, f64)],
) -> Result<(), StudyError> {
    for gone in former_drives(folder, drives.iter().map(|d| d.0.drive.as_str())) {
        remove_former(&folder.join(format!("{gone}.parquet")))?;
    }
    TableBuilder::default()
        .text("drive", drives.iter().map(|d| d.0.drive.as_str()))
        .text(
            "participant",
            drives.iter().map(|d| d.0.participant.as_str()),
        )
        .text("condition", drives.iter().map(|d| d.0.condition.as_str()))
        .text("driven_by", drives.iter().map(|d| d.0.driven_by.as_str()))
        .integers("rows", drives.iter().map(|d| i64::try_from(d.1).ok()))
        .numbers("duration_s", drives.iter().map(|d| Some(d.2)))
        .write(&folder.join("drives.csv"))
}
