//! The drives of a table.

use crate::{
    assemble::assemble,
    clock::leave_out_unset,
    error::IngestError,
    mapping::{FrameKind, Layout, Mapping, RoadMapping, TableMapping, names::meta_of},
    plausible::along_x,
    quality::{Warning, WarningKind, report},
    raw::table::{
        self, TableDrive, TableLog,
        open::{Kind, Table},
    },
    settings::{IngestSettings, Ingested},
    target::Target,
};
use std::path::{Path, PathBuf};

/// Reads the drives of a table in one file or several parts by its mapping.
///
/// A vehicle of a table of many that is seen too rarely for a drive is left out by itself, with a warning.
pub(crate) fn read_table(
    path: &Path,
    parts: &[PathBuf],
    settings: &IngestSettings,
) -> Result<Vec<Ingested>, IngestError> {
    let no_mapping = || IngestError::NoMapping { path: path.to_owned() };
    let mapping = settings.mapping.as_ref().ok_or_else(no_mapping)?;
    let columns = mapping.table.as_ref().ok_or_else(no_mapping)?;
    let mapped = mapping.road.unwrap_or(RoadMapping::UNKNOWN);
    let mut sources = Vec::new();
    let mut files = Vec::new();
    for part in parts {
        files.push((part.clone(), table::take(part, &mut sources)?));
    }
    let from_columns = captures_from_columns(path, &files, mapping, columns)?;
    let mut log = TableLog {
        path,
        files,
        mapping: columns,
        road: &mapped,
        max_gap_s: settings.max_gap_s()?,
        warnings: Vec::new(),
    };
    let drives = table::read(&mut log, &mut sources)?;
    let long = match &columns.layout {
        Layout::Long(long) => Some(&long.columns),
        _ => None,
    };
    let rows = Rows {
        headed: long.is_some_and(|c| c.heading.is_some()),
        leader_named: long.is_some_and(|c| c.lead_id.is_some()),
    };
    let mut left_out = LeftOut::default();
    let mut logs = Vec::new();
    for drive in drives {
        match ingested(path, drive, &from_columns, settings, rows) {
            Ok(drive) => logs.push(Ingested { sources: sources.clone(), ..drive }),
            // One of many is left out by itself.
            Err(error) if long.is_some() => left_out.take(error)?,
            Err(error) => return Err(error),
        }
    }
    let Some(first) = logs.first_mut() else {
        let what = "it has no vehicle with two rows that have time, number and position";
        let nobody = || IngestError::bad_table(path, what);
        return Err(left_out.first.unwrap_or_else(nobody));
    };
    let of_file = log.warnings.into_iter().chain(left_out.warnings(path));
    first.warnings.extend(of_file.map(|warning| Warning { of_file: true, ..warning }));
    Ok(logs)
}

/// What rows of a table say.
#[derive(Clone, Copy)]
struct Rows {
    /// Headings, in the world.
    headed: bool,
    /// Who is ahead, by its name.
    leader_named: bool,
}

/// Makes the recording of one drive of a table.
fn ingested(
    path: &Path,
    drive: TableDrive,
    from_columns: &[(String, String)],
    settings: &IngestSettings,
    rows: Rows,
) -> Result<Ingested, IngestError> {
    let mapping = settings.mapping.as_ref();
    let mapped = mapping.and_then(|m| m.road).unwrap_or(RoadMapping::UNKNOWN);
    let TableDrive { mut captures, road, lane_steps, mut raw, mut warnings, .. } = drive;
    let unset = leave_out_unset(&mut raw);
    let what = "rows are skipped: their time is 0 or less, as if it was not set, and more than a day from the others";
    report(&mut warnings, path, WarningKind::MissingValue, unset, what);
    let road = road.unwrap_or(mapped);
    let world = Target::mapped(settings)?;
    let target = Target {
        road: road.road(),
        right_lane_centre_y_m: road.right_lane_centre_y_m,
        // Only positions in the world need to be laid along the road.
        frame: if rows.headed { world.frame } else { FrameKind::Map },
        lane_steps,
        // In a bend a leader that is known by its name is not where ego's lane seems to be.
        own_lane_only: road.lanes == 1 && !(rows.headed && rows.leader_named),
        ..world
    };
    captures.extend_from_slice(from_columns);
    let names = mapping.and_then(|m| m.names.as_ref());
    let meta = meta_of(path, names, &captures, &mut warnings)?;
    let (recording, more) = assemble(path, raw, &target)?;
    if target.frame == FrameKind::Map {
        along_x(path, recording.ego())?;
    }
    warnings.extend(more);
    Ok(Ingested { meta, recording, warnings, sources: Vec::new() })
}

/// Vehicles of a table of many that make no drive.
#[derive(Default)]
struct LeftOut {
    sparse: usize,
    unusable: usize,
    /// Why the first of the unusable is none.
    why: Option<String>,
    first: Option<IngestError>,
}

impl LeftOut {
    /// Counts one.
    ///
    /// # Errors
    /// The error itself, where it is not of one vehicle.
    fn take(&mut self, error: IngestError) -> Result<(), IngestError> {
        match &error {
            IngestError::TooSparse { .. } => self.sparse += 1,
            IngestError::Implausible { .. } | IngestError::SeldomSeen { .. } => {
                self.unusable += 1;
                self.why.get_or_insert_with(|| error.to_string());
            }
            _ => return Err(error),
        }
        self.first.get_or_insert(error);
        Ok(())
    }

    fn warnings(&self, path: &Path) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let missing = WarningKind::MissingValue;
        let what =
            "vehicles whose samples are all further apart than the longest gap are no drives";
        report(&mut warnings, path, missing, self.sparse, what);
        if let Some(why) = &self.why {
            let what = format!("vehicles whose rows make no drive are left out; the first: {why}");
            warnings.push(Warning::new(path, WarningKind::Unit, self.unusable, what));
        }
        warnings
    }
}

/// What columns of the table say throughout, for the names of drives.
fn captures_from_columns(
    path: &Path,
    files: &[(PathBuf, Vec<u8>)],
    mapping: &Mapping,
    table: &TableMapping,
) -> Result<Vec<(String, String)>, IngestError> {
    let Some(names) = mapping.names.as_ref().filter(|n| !n.columns.is_empty()) else {
        return Ok(Vec::new());
    };
    let wanted: Vec<(&str, Kind)> =
        names.columns.values().map(|column| (column.as_str(), Kind::Word)).collect();
    let read = Table::open_all(files.to_vec(), table.into(), &wanted)?;
    let mut captures = Vec::new();
    for (name, column) in &names.columns {
        let mut words: Vec<String> = read.words(column)?.into_iter().flatten().collect();
        words.sort();
        words.dedup();
        match words.as_slice() {
            [one] => captures.push((name.clone(), one.clone())),
            words => {
                let listed = words.join(", ");
                let held = if listed.is_empty() { "nothing" } else { &listed };
                let what =
                    "expected one word throughout a file: the names of drives take it from there";
                let what = format!("column `{column}` holds {held}, {what}");
                return Err(IngestError::bad_table(path, what));
            }
        }
    }
    Ok(captures)
}
