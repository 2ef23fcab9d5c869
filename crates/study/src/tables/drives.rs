//! Drives as files: one Parquet file a drive, and `drives.csv` beside them.

use super::{Table, TableBuilder, TableName, read_rows, write_rows};
use crate::{
    atomic_write::{atomic_write, files_ending, if_there},
    error::StudyError,
};
use maveric_analysis::Driven;
use maveric_domain::{
    DomainError, Drive, DriveId, DriveMeta, Occasion, ParticipantId, Ride, occasion::first,
};
use maveric_ingest::{Provenance, drive_frame, read_drive_from, write_drive_to};
use path_slash::PathExt as _;
use polars::prelude::Column;
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeSet,
    ffi::OsStr,
    num::NonZeroU32,
    path::{Path, PathBuf},
};

/// The list of the drives of a folder.
const LIST: &str = "drives.csv";

/// Writes `<folder>/<drive>.parquet` of a drive that was made here, from no log.
pub fn write_drive(folder: &Path, drive: &Drive) -> Result<PathBuf, StudyError> {
    write_drive_of(folder, drive, &Provenance::default())
}

/// Writes `<folder>/<drive>.parquet`, with what the drive was made from in its metadata.
pub(crate) fn write_drive_of(
    folder: &Path,
    drive: &Drive,
    provenance: &Provenance,
) -> Result<PathBuf, StudyError> {
    let path = folder.join(format!("{}.parquet", drive.meta().drive));
    atomic_write(&path, |file| Ok(write_drive_to(file, drive, provenance)?))?;
    Ok(path)
}

/// Writes a drive's rows as a table, a row a sample; what is not there is an empty cell.
pub(crate) fn write_samples(path: &Path, drive: &Drive) -> Result<(), StudyError> {
    let mut frame = drive_frame(drive).drop_many(["following_distance_m"]);
    // Without a reference vehicle its columns hold values of a free road, which nobody measured.
    let rows = drive.rows();
    for (name, values) in [
        ("lead_dx_m", &rows.lead_dx_m),
        ("lead_dy_m", &rows.lead_dy_m),
        ("lead_speed_mps", &rows.lead_speed_mps),
    ] {
        let pairs = rows.lead_present.iter().zip(values);
        let measured: Vec<Option<f64>> = pairs.map(|(&is, &v)| is.then_some(v)).collect();
        let replaced = frame.with_column(Column::new(name.into(), measured));
        replaced.map_err(|e| StudyError::file(path, e.to_string()))?;
    }
    TableBuilder::from(frame).write(path)
}

/// Reads one drive back.
///
/// # Errors
/// [`StudyError::Ingest`] for what is no drive.
pub fn read_drive(path: &Path) -> Result<Drive, StudyError> {
    Ok(read_drive_from(path)?.0)
}

/// Reads every drive of a folder, ordered by file name.
pub fn read_drives(folder: &Path) -> Result<Vec<Drive>, StudyError> {
    drives_in(folder)?.collect()
}

/// Reads the drives of a folder one after the other, ordered by file name: many do not fit into memory.
///
/// # Errors
/// [`StudyError::BadFile`] for a folder without drives or, where `drives.csv` lists what was made there, with another one; of each
/// drive as [`read_drive`].
pub fn drives_in(
    folder: &Path,
) -> Result<impl Iterator<Item = Result<Drive, StudyError>>, StudyError> {
    Ok(drive_paths(folder)?.into_iter().map(|p| read_drive(&p)))
}

/// The files of the drives of a folder, ordered by name.
pub(crate) fn drive_paths(folder: &Path) -> Result<Vec<PathBuf>, StudyError> {
    let paths = drive_files(folder)?;
    if paths.is_empty() {
        let problem = "holds no drives (*.parquet)";
        let help = "make drives from logs with `maveric ingest LOG… --out DIR`";
        return Err(StudyError::file(folder, problem).with_help(help));
    }
    if folder.join(LIST).is_file() {
        refuse_foreign(folder, [])?;
    }
    Ok(paths)
}

/// Refuses a folder to write into that holds a drive which neither its `drives.csv` lists nor `now` replaces: nobody knows who made
/// it, and it would be read as one of this study. It is left as it is.
///
/// # Errors
/// [`StudyError::BadFile`] naming the drive's file; [`StudyError::Io`].
pub(crate) fn refuse_foreign<'a>(
    folder: &Path,
    now: impl IntoIterator<Item = &'a str>,
) -> Result<(), StudyError> {
    let list = folder.join(LIST);
    let mut known_ids: BTreeSet<String> = now.into_iter().map(str::to_owned).collect();
    if list.is_file() {
        let listed: Vec<DriveId> = Table::read(&list)?.ids("drive")?;
        known_ids.extend(listed.iter().map(ToString::to_string));
    }
    let known = |path: &PathBuf| {
        let stem = path.file_stem();
        stem.is_some_and(|stem| known_ids.contains(stem.to_string_lossy().as_ref()))
    };
    let Some(path) = drive_files(folder)?.into_iter().find(|path| !known(path)) else {
        return Ok(());
    };
    let problem = format!("is a drive that {} does not list", list.to_slash_lossy());
    let help = "nobody knows how it was made: move it elsewhere, or ingest its log with the others";
    Err(StudyError::file(path, problem).with_help(help))
}

/// The drives' files of a folder, by name; none where there is no such folder.
fn drive_files(folder: &Path) -> Result<Vec<PathBuf>, StudyError> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let is_hidden = |name: &OsStr| name.to_string_lossy().starts_with('.');
    let mut paths = files_ending(folder, "parquet")?;
    paths.retain(|path| !path.file_name().is_some_and(is_hidden));
    Ok(paths)
}

/// What was repaired or left out as a folder of drives was made: a row of its `exclusions.csv`. Which drive it would have been is
/// known where a rule of the design kept it out.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct ExclusionRow {
    pub(crate) drive: String,
    pub(crate) log: String,
    pub(crate) what: String,
    pub(crate) count: usize,
    pub(crate) participant: String,
    pub(crate) condition: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) session: Option<NonZeroU32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) trial: Option<NonZeroU32>,
    pub(crate) rule: String,
    pub(crate) duration_s: Option<f64>,
}

impl ExclusionRow {
    /// Whether the drive is let in all the same: something in its log was repaired, or is doubtful.
    pub(crate) fn is_kept(&self) -> bool {
        !self.drive.is_empty() && self.rule.is_empty()
    }

    /// Of which drive it is.
    ///
    /// # Errors
    /// [`DomainError::BadCondition`] for a condition that is none.
    pub(crate) fn ride(&self) -> Result<Ride, DomainError> {
        Ok(Ride {
            condition: self.condition.parse()?,
            occasion: Occasion {
                session: self.session.unwrap_or(first()),
                trial: self.trial.unwrap_or(first()),
            },
        })
    }
}

/// A drive of the learned car that ended early: a row of `exclusions.csv` beside its drives.
#[derive(Serialize, Deserialize)]
pub(crate) struct EndedEarly {
    pub(crate) drive: String,
    pub(crate) what: String,
}

/// What the `exclusions.csv` of a folder of drives lists; nothing where there is none.
pub(crate) fn exclusions(folder: &Path) -> Result<Vec<ExclusionRow>, StudyError> {
    let path = folder.join("exclusions.csv");
    if !path.is_file() {
        return Ok(Vec::new());
    }
    let table = Table::read(&path)?;
    if table.has("rule") {
        return table.records();
    }
    let ended = table.records()?.into_iter();
    let row = |EndedEarly { drive, what }| ExclusionRow {
        drive,
        what,
        rule: "ended early".to_owned(),
        ..ExclusionRow::default()
    };
    Ok(ended.map(row).collect())
}

/// The drives that a rule of the design keeps out of a folder, each with the rule, as `exclusions.csv` there lists them.
///
/// # Errors
/// As [`exclusions`]; [`StudyError::Domain`] for a row that names no drive.
pub(crate) fn kept_out(folder: &Path) -> Result<Vec<Driven>, StudyError> {
    let rows = exclusions(folder)?.into_iter();
    rows.filter(|row| row.rule.starts_with("exclude."))
        .map(|row| {
            Ok(Driven {
                ride: row.ride()?,
                drive: DriveId::new(row.drive)?,
                participant: ParticipantId::new(row.participant)?,
                duration_s: row.duration_s,
            })
        })
        .collect()
}

/// Whose the drives are that `<folder>/drives.csv` lists, and in which ride; none where there is no such list.
pub(crate) fn listed_rides(folder: &Path) -> Result<Vec<(ParticipantId, Ride)>, StudyError> {
    let listed: Vec<DriveMeta> = if_there(&folder.join(LIST), read_rows)?;
    let whose = |meta: DriveMeta| {
        let ride = meta.ride();
        (meta.participant, ride)
    };
    Ok(listed.into_iter().map(whose).collect())
}

/// The drives that `<folder>/drives.csv` lists and that are not among `now`: made here by an earlier call, and no
/// more. None where there is no such list.
pub(crate) fn former_drives<'a>(
    folder: &Path,
    now: impl IntoIterator<Item = &'a str>,
) -> Vec<DriveId> {
    let listed = Table::read(&folder.join(LIST)).and_then(|list| list.ids("drive"));
    let mut former: Vec<DriveId> = listed.unwrap_or_default();
    let now: BTreeSet<&str> = now.into_iter().collect();
    former.retain(|drive| !now.contains(drive.as_str()));
    former
}

/// Removes a file of an earlier call; one that is not there is fine.
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
pub(crate) fn write_drive_list(
    folder: &Path,
    drives: &[(DriveMeta, usize, f64)],
) -> Result<(), StudyError> {
    for gone in former_drives(folder, drives.iter().map(|d| d.0.drive.as_str())) {
        remove_former(&folder.join(format!("{gone}.parquet")))?;
    }
    let rows = drives.iter().map(|(meta, rows, s)| (meta, ("rows", rows), ("duration_s", s)));
    write_rows(TableName::Drives, &folder.join(LIST), rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{DrivenBy, LatentTraits, Seconds};
    use maveric_simulator::{Driver, DriverParams, Scenario, rollout};

    fn a_drive() -> Drive {
        let scenario = Scenario::paper().with_duration(Seconds(6.0)).unwrap();
        let person = DriverParams::draw(&LatentTraits::default(), 1, 1);
        let driven = rollout(&scenario, Driver::Human(&person), 1).unwrap();
        let meta = DriveMeta::named("P01-own", "P01", "own", DrivenBy::Synthetic).unwrap();
        Drive::from_recording(meta, &driven.recording).unwrap()
    }

    #[test]
    fn a_drive_is_kept_that_no_rule_leaves_out_and_that_did_not_end_early() {
        let row = |drive: &str, rule: &str| ExclusionRow {
            drive: drive.to_owned(),
            rule: rule.to_owned(),
            ..ExclusionRow::default()
        };
        assert!(row("P01-own", "").is_kept());
        assert!(!row("P01-own", "exclude.drives").is_kept() && !row("", "").is_kept());
        let folder = tempfile::tempdir().unwrap();
        let list = folder.path().join("exclusions.csv");
        std::fs::write(list, "drive,what\nP01-calm,the speed is no number\n").unwrap();
        assert!(!exclusions(folder.path()).unwrap()[0].is_kept());
    }

    #[test]
    fn a_drive_that_the_list_does_not_have_is_named_and_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let drive = a_drive();
        let written = write_drive(folder.path(), &drive).unwrap();
        // Without a list a folder is as somebody put it together.
        assert_eq!(read_drives(folder.path()).unwrap().len(), 1);
        write_drive_list(folder.path(), &[(drive.meta().clone(), 121, 6.0)]).unwrap();
        assert_eq!(read_drives(folder.path()).unwrap().len(), 1);
        let foreign = folder.path().join("P09-own.parquet");
        std::fs::copy(written, &foreign).unwrap();
        let said = read_drives(folder.path()).unwrap_err().to_string();
        assert!(said.contains("P09-own.parquet") && said.contains("does not list"), "{said}");
        assert!(refuse_foreign(folder.path(), ["P01-own"]).is_err());
        refuse_foreign(folder.path(), ["P09-own"]).unwrap();
        assert!(foreign.exists());
    }
}
