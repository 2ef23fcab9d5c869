//! The drives of a table.

use crate::{
    assemble::{Target, assemble},
    error::IngestError,
    mapping::{FrameKind, Layout, Mapping, RoadMapping, TableMapping, names::meta_of},
    plausible::along_x,
    quality::{Warning, WarningKind},
    raw::table::{
        self, TableDrive, TableLog,
        open::{Kind, Table},
    },
    settings::{IngestSettings, Ingested},
};
use std::path::{Path, PathBuf};

/// Reads the drives of a table in one file or several parts by its mapping; of a folder if every signal has its own file.
///
/// A vehicle of a table of many that is seen too rarely for a drive is left out by itself, with a warning.
///
/// # Errors
/// As [`crate::read_log`].
pub(crate) fn read_table(
    path: &Path,
    parts: &[PathBuf],
    settings: &IngestSettings,
) -> Result<Vec<Ingested>, IngestError> {
    let no_mapping = || IngestError::NoMapping {
        path: path.to_owned(),
    };
    let mapping = settings.mapping.as_ref().ok_or_else(no_mapping)?;
    let columns = mapping.table.as_ref().ok_or_else(no_mapping)?;
    let mapped = mapping.road.unwrap_or(RoadMapping::UNKNOWN);
    let mut sources = Vec::new();
    let mut files = Vec::new();
    for part in parts {
        files.push((part.clone(), table::take(part, &mut sources)?));
    }
    let told = told_by_columns(path, &files, mapping, columns)?;
    let log = TableLog {
        path,
        files,
        mapping: columns,
        road: &mapped,
        max_gap_s: settings.max_gap_s()?,
    };
    let drives = table::read(log, &mut sources)?;
    let (several, headed) = match &columns.layout {
        Layout::Long(long) => (true, long.columns.heading.is_some()),
        _ => (false, false),
    };
    let mut found = Vec::new();
    let mut refused: Option<IngestError> = None;
    let mut sparse = 0;
    let mut unusable = Vec::new();
    for drive in drives {
        let TableDrive {
            mut captures,
            road,
            lane_steps,
            raw,
            mut warnings,
            ..
        } = drive;
        let road = road.unwrap_or(mapped);
        let world = Target::mapped(settings)?;
        let target = Target {
            road: road.road(),
            right_lane_centre_y_m: road.right_lane_centre_y_m,
            // Only positions in the world need to be laid along the road.
            frame: if headed { world.frame } else { FrameKind::Map },
            lane_steps,
            // What is in ego's lane is known by name there.
            own_lane_only: road.lanes == 1 && !headed,
            ..world
        };
        captures.extend(told.iter().cloned());
        let meta = meta_of(path, mapping.names.as_ref(), &captures, &mut warnings)?;
        let made = assemble(path, raw, &target);
        let made = made.and_then(|made| match target.frame {
            FrameKind::Map => along_x(path, made.0.ego()).map(|()| made),
            _ => Ok(made),
        });
        match made {
            Ok((recording, more)) => {
                warnings.extend(more);
                found.push(Ingested {
                    meta,
                    recording,
                    warnings,
                    sources: sources.clone(),
                });
            }
            Err(error @ IngestError::TooSparse { .. }) if several => {
                sparse += 1;
                refused.get_or_insert(error);
            }
            Err(error @ (IngestError::Implausible { .. } | IngestError::SeldomSeen { .. }))
                if several =>
            {
                unusable.push(error.to_string());
                refused.get_or_insert(error);
            }
            Err(error) => return Err(error),
        }
    }
    match (found.first_mut(), refused) {
        (Some(first), Some(_)) => {
            if sparse > 0 {
                let what = "vehicles whose samples are all further apart than the longest gap are no drives";
                let warning = Warning::new(path, WarningKind::MissingValue, sparse, what);
                first.warnings.push(warning);
            }
            if let Some(why) = unusable.first() {
                let what =
                    format!("vehicles whose rows make no drive are left out; the first: {why}");
                let warning = Warning::new(path, WarningKind::Unit, unusable.len(), what);
                first.warnings.push(warning);
            }
        }
        (None, Some(error)) => return Err(error),
        (None, None) => {
            let what = "it has no vehicle with two rows that have time, number and position";
            return Err(IngestError::bad_table(path, what));
        }
        (Some(_), None) => {}
    }
    Ok(found)
}

/// What columns of the table say throughout, for the names of drives.
fn told_by_columns(
    path: &Path,
    files: &[(PathBuf, Vec<u8>)],
    mapping: &Mapping,
    table: &TableMapping,
) -> Result<Vec<(String, String)>, IngestError> {
    let Some(names) = mapping.names.as_ref().filter(|n| !n.columns.is_empty()) else {
        return Ok(Vec::new());
    };
    let wanted: Vec<(&str, Kind)> = names
        .columns
        .values()
        .map(|column| (column.as_str(), Kind::Word))
        .collect();
    let read = Table::open_all(files.to_vec(), table.into(), &wanted)?;
    let mut told = Vec::new();
    for (name, column) in &names.columns {
        let mut words: Vec<String> = read.words(column)?.into_iter().flatten().collect();
        words.sort();
        words.dedup();
        match words.as_slice() {
            [one] => told.push((name.clone(), one.clone())),
            words => {
                let found = words.join(", ");
                let held = if found.is_empty() { "nothing" } else { &found };
                let what =
                    "expected one word throughout a file: the names of drives take it from there";
                let what = format!("column `{column}` holds {held}, {what}");
                return Err(IngestError::bad_table(path, what));
            }
        }
    }
    Ok(told)
}
