//! Reads tables: CSV, TSV and Parquet in the layouts that a mapping may declare.

mod long;
pub(crate) mod open;
mod pair;
mod platoon;
mod plausible;
mod recording_meta;
mod signals;
mod time;

use crate::{
    error::IngestError,
    mapping::{Layout, RoadMapping, TableMapping},
    quality::{Warning, WarningKind},
    raw::RawDrive,
};
use std::path::Path;
use time::Clock;

/// One drive of a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct TableDrive {
    /// What names the drive among those of its file: the vehicle's number as `id`, and each group column.
    pub(crate) captures: Vec<(String, String)>,
    /// The road, where the table knows better than its mapping.
    pub(crate) road: Option<RoadMapping>,
    /// Whether y comes from numbers of lanes and so moves in steps.
    pub(crate) lane_steps: bool,
    /// The samples.
    pub(crate) raw: RawDrive,
    /// What was left out on the way.
    pub(crate) warnings: Vec<Warning>,
}

/// Reads the drives of a table, ordered by group and vehicle; of a folder if the layout is `signals`.
///
/// # Errors
/// As [`crate::read_log`].
pub(crate) fn read(
    path: &Path,
    mapping: &TableMapping,
    road: &RoadMapping,
    max_gap_s: f64,
) -> Result<Vec<TableDrive>, IngestError> {
    let bytes = || std::fs::read(path).map_err(|e| IngestError::io(path, e));
    let mut drives = match mapping.layout {
        Layout::Pair => vec![pair::read(path, bytes()?, mapping, max_gap_s)?],
        Layout::Platoon => platoon::read(path, bytes()?, mapping, max_gap_s)?,
        Layout::Long => long::read(path, bytes()?, mapping, road, max_gap_s)?,
        Layout::Signals => vec![signals::read(path, mapping, max_gap_s)?],
    };
    for drive in &mut drives {
        drive.warnings.extend(plausible::doubts(path, &drive.raw));
    }
    Ok(drives)
}

/// The times of a table, where frames need no file beside it.
fn clock(mapping: &TableMapping) -> Clock {
    Clock {
        unit: mapping.units.time,
        // Only used where times are frames, and checked then.
        frames_per_s: mapping.frames_per_s.unwrap_or(1.0),
    }
}

/// A column that the mapping names; its check has seen to it that it does.
fn named<'a>(path: &Path, key: &str, column: Option<&'a String>) -> Result<&'a str, IngestError> {
    column
        .map(String::as_str)
        .ok_or_else(|| IngestError::BadMapping {
            path: path.to_owned(),
            reason: format!("this table needs `table.columns.{key}`"),
        })
}

/// Adds a warning if it happened at all.
fn report(warnings: &mut Vec<Warning>, path: &Path, kind: WarningKind, count: usize, what: &str) {
    if count > 0 {
        warnings.push(Warning::new(path, kind, count, what));
    }
}
