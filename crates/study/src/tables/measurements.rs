//! The objective measures: a row a drive, a column a measure.

use super::{Table, TableName, write_rows};
use crate::error::StudyError;
use maveric_domain::{DriveMeta, occasion::OCCASION};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

pub use maveric_domain::MeasuredDrive;

/// The column of [`MeasuredDrive::counted_s`].
const COUNTED: &str = "counted_s";

/// Writes a row for each drive, a column for each measure.
pub(crate) fn write_measurements(path: &Path, drives: &[MeasuredDrive]) -> Result<(), StudyError> {
    let written = drives.iter().map(|d| (&d.meta, (COUNTED, d.counted_s), &d.values));
    write_rows(TableName::Measurements, path, written)
}

/// Reads measurements back; every column that is not about the drive itself is a measure.
pub(crate) fn read_measurements(path: &Path) -> Result<Vec<MeasuredDrive>, StudyError> {
    let table = Table::read(path)?;
    table.each_once(&["drive"])?;
    let about = ["drive", "participant", "study", "condition", "driven_by", COUNTED];
    let about = about.into_iter().chain(OCCASION);
    let about: BTreeSet<&str> = about.collect();
    let metas = table.records::<DriveMeta>()?.into_iter();
    // Without the column, as in a table of another program, counts are those of whole drives.
    let counted = table.numbers_if_there(COUNTED)?;
    let mut drives: Vec<MeasuredDrive> = metas
        .zip(counted)
        .map(|(meta, counted_s)| MeasuredDrive { meta, values: BTreeMap::new(), counted_s })
        .collect();
    for measure in table.columns().iter().filter(|c| !about.contains(c.as_str())) {
        for (drive, value) in drives.iter_mut().zip(table.numbers(measure)?) {
            drive.values.insert(measure.clone(), value);
        }
    }
    Ok(drives)
}

/// Refuses two drives of one person in one condition that no session or trial tells apart: which of them counted would depend on the order of the rows.
///
/// # Errors
/// [`StudyError::BadFile`] naming both.
pub(crate) fn one_drive_a_condition<'a>(
    path: &Path,
    drives: impl IntoIterator<Item = &'a MeasuredDrive>,
) -> Result<(), StudyError> {
    let mut seen = BTreeMap::new();
    for MeasuredDrive { meta, .. } in drives {
        let Some(first) = seen.insert((&meta.participant, meta.ride()), &meta.drive) else {
            continue;
        };
        let problem = format!(
            "holds two drives of {} in condition {} ({}): {first} and {}",
            meta.participant,
            meta.condition,
            meta.occasion(),
            meta.drive
        );
        let help = "measure one of them, give the other a condition of its own, or say by `{session}` and `{trial}` under [names] of the mapping which is which";
        return Err(StudyError::file(path, problem).with_help(help));
    }
    Ok(())
}
