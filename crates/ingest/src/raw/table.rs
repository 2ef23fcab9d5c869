//! Reads tables: CSV, TSV and Parquet in the layouts that a mapping may declare.

pub(crate) mod cells;
mod ending_early;
mod ids;
mod lane;
mod lateral;
mod long;
pub(crate) mod open;
mod pair;
pub(crate) mod parse;
mod parts;
mod platoon;
mod recording_meta;
pub(crate) mod text;
pub(crate) mod time;

use crate::{
    error::IngestError,
    mapping::{Layout, RoadMapping, TableMapping},
    plausible::refuse_many,
    quality::{Warning, WarningKind},
    raw::RawDrive,
    source::Source,
    synchronise::hole_ns,
};
use open::{Kind, Table};
use std::path::{Path, PathBuf};
use time::Clock;

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
    let total = drives.iter().map(|d| d.gaps.count).sum();
    refuse_many(path, count, total, what)?;
    for drive in drives.iter_mut().filter(|d| !d.gaps.negative_ns.is_empty()) {
        let start_ns = drive.raw.ego.stamp_ns.iter().min().copied();
        let since = |ns: i64| (ns - start_ns.unwrap_or(ns)) as f64 / 1e9;
        let negative = &drive.gaps.negative_ns;
        let spans = negative.iter().map(|&ns| (since(ns), since(ns)));
        let warning = Warning::new(path, WarningKind::Unit, negative.len(), what);
        drive.warnings.push(warning.with_spans(spans));
    }
    Ok(())
}

/// A table to be read: its files and what is said of them.
pub(crate) struct TableLog<'a> {
    /// The log's name in warnings: its first file.
    pub(crate) path: &'a Path,
    /// Its files in their order, with their bytes.
    pub(crate) files: Vec<(PathBuf, Vec<u8>)>,
    /// What its columns mean.
    pub(crate) mapping: &'a TableMapping,
    /// The road where the table does not know better.
    pub(crate) road: &'a RoadMapping,
    /// Longest hole that is bridged, in s.
    pub(crate) max_gap_s: f64,
    /// What is to be told of its files, whichever drives are made of them.
    pub(crate) warnings: Vec<Warning>,
}

impl<'a> TableLog<'a> {
    /// Its times, where frames need no file beside it.
    fn clock(&self) -> Clock<'a> {
        Clock {
            unit: self.mapping.units.time,
            pattern: self.mapping.time_pattern.as_deref(),
            // Only used where times are frames, and checked then.
            frames_per_s: self.mapping.frames_per_s.unwrap_or(1.0),
            hole_ns: hole_ns(self.max_gap_s),
        }
    }

    /// Opens its files as one table.
    fn open(&mut self, wanted: &[(&str, Kind)]) -> Result<Table, IngestError> {
        let files = std::mem::take(&mut self.files);
        let table = Table::open_all(files, self.mapping.into(), wanted)?;
        self.warnings.extend_from_slice(table.warnings());
        Ok(table)
    }
}

/// Reads the drives of a table, ordered by group and vehicle. Files that it reads besides go to `sources`.
pub(crate) fn read(
    log: &mut TableLog<'_>,
    sources: &mut Vec<Source>,
) -> Result<Vec<TableDrive>, IngestError> {
    let (path, mapping) = (log.path, log.mapping);
    let layout = &mapping.layout;
    let joined = match log.files.len() {
        0 | 1 => Vec::new(),
        _ => parts::joined(path, log.files.clone(), mapping, log.clock())?,
    };
    let mut drives = match layout {
        Layout::Pair(pair) => vec![pair::read(log, pair)?],
        Layout::Platoon(platoon) => platoon::read(log, platoon)?,
        Layout::Long(long) => long::read(log, long, sources)?,
    };
    refuse_overlaps(path, &mut drives)?;
    for drive in &mut drives {
        drive.warnings.extend(joined.iter().cloned());
        drive.warnings.extend(lateral::place_in_lane(path, layout, &drive.raw.ego));
    }
    Ok(drives)
}

/// Reads a file and adds it to `sources`.
pub(crate) fn take(path: &Path, sources: &mut Vec<Source>) -> Result<Vec<u8>, IngestError> {
    let (bytes, source) = Source::read(path)?;
    sources.push(source);
    Ok(bytes)
}
