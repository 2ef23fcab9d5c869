//! Reads tables: CSV, TSV and Parquet in the layouts that a mapping may declare.

mod ids;
mod long;
pub(crate) mod open;
mod pair;
mod platoon;
mod recording_meta;
mod signals;
pub(crate) mod text;
pub(crate) mod time;

use crate::{
    error::IngestError,
    mapping::{Layout, RoadMapping, TableMapping},
    plausible::refuse_many,
    quality::{Warning, WarningKind},
    raw::RawDrive,
    source::Source,
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
    /// The gaps that its rows say of its leader.
    pub(crate) gaps: Gaps,
}

/// Gaps to a leader: how many, and the times of those at which it would stand within ego.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Gaps {
    pub(crate) count: usize,
    pub(crate) negative_ns: Vec<i64>,
}

impl Gaps {
    /// Counts a gap between bumpers, in m.
    pub(crate) fn note(&mut self, stamp_ns: i64, gap_m: f64) {
        self.count += 1;
        if gap_m < 0.0 {
            self.negative_ns.push(stamp_ns);
        }
    }
}

/// Warns of leaders that stand within ego; many of them say that the gap is of another kind.
fn refuse_overlaps(path: &Path, drives: &mut [TableDrive]) -> Result<(), IngestError> {
    let what = "gaps to the leader are negative: it would stand within ego. Is `gap_kind` right?";
    let count = drives.iter().map(|d| d.gaps.negative_ns.len()).sum();
    let of = drives.iter().map(|d| d.gaps.count).sum();
    refuse_many(path, count, of, what)?;
    for drive in drives.iter_mut().filter(|d| !d.gaps.negative_ns.is_empty()) {
        let start_ns = drive.raw.ego.iter().map(|s| s.stamp_ns).min();
        let since = |ns: i64| (ns - start_ns.unwrap_or(ns)) as f64 / 1e9;
        let negative = &drive.gaps.negative_ns;
        let spans = negative.iter().map(|&ns| (since(ns), since(ns)));
        let warning = Warning::new(path, WarningKind::Unit, negative.len(), what);
        drive.warnings.push(warning.with_spans(spans));
    }
    Ok(())
}

/// Reads the drives of a table, ordered by group and vehicle; of a folder if the layout is `signals`. Files that it reads besides go to `sources`.
///
/// # Errors
/// As [`crate::read_log`].
pub(crate) fn read(
    path: &Path,
    bytes: Vec<u8>,
    mapping: &TableMapping,
    road: &RoadMapping,
    max_gap_s: f64,
    sources: &mut Vec<Source>,
) -> Result<Vec<TableDrive>, IngestError> {
    let mut drives = match mapping.layout {
        Layout::Pair => vec![pair::read(path, bytes, mapping)?],
        Layout::Platoon => platoon::read(path, bytes, mapping)?,
        Layout::Long => long::read(path, bytes, mapping, road, max_gap_s, sources)?,
        Layout::Signals => vec![signals::read(path, mapping, road, max_gap_s, sources)?],
    };
    refuse_overlaps(path, &mut drives)?;
    Ok(drives)
}

/// Reads a file and adds it to `sources`.
pub(crate) fn take(path: &Path, sources: &mut Vec<Source>) -> Result<Vec<u8>, IngestError> {
    let (bytes, source) = Source::read(path)?;
    sources.push(source);
    Ok(bytes)
}

/// The times of a table, where frames need no file beside it.
fn clock(mapping: &TableMapping) -> Clock<'_> {
    Clock {
        unit: mapping.units.time,
        pattern: mapping.time_pattern.as_deref(),
        // Only used where times are frames, and checked then.
        frames_per_s: mapping.frames_per_s.unwrap_or(1.0),
    }
}

/// A column that the mapping names; its check has seen to it that it does.
fn named<'a>(path: &Path, key: &str, column: Option<&'a String>) -> Result<&'a str, IngestError> {
    let missing = || format!("this table needs `table.columns.{key}`");
    let column = column.map(String::as_str);
    column.ok_or_else(|| IngestError::bad_mapping(path, missing()))
}

/// Adds a warning if it happened at all.
fn report(warnings: &mut Vec<Warning>, path: &Path, kind: WarningKind, count: usize, what: &str) {
    if count > 0 {
        warnings.push(Warning::new(path, kind, count, what));
    }
}
