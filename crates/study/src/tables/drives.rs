//! Drives as files: one Parquet file a drive, and `drives.csv` beside them.

use super::{Table, TableBuilder};
use crate::error::StudyError;
use maveric_domain::{Drive, DriveMeta, Road, drive::Rows};
use polars::prelude::*;
use std::{
    fs::File,
    path::{Path, PathBuf},
};

/// Version of the columns below; a file of another version is refused.
const VERSION: &str = "1";

/// Writes `<folder>/<drive>.parquet`.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_drive(folder: &Path, drive: &Drive) -> Result<PathBuf, StudyError> {
    let r = drive.rows();
    let meta = drive.meta();
    let road = drive.road();
    let some = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
    let path = folder.join(format!("{}.parquet", meta.drive));
    let metadata = [
        ("maveric.version", VERSION.to_owned()),
        ("maveric.drive", meta.drive.to_string()),
        ("maveric.participant", meta.participant.to_string()),
        ("maveric.study", meta.study.as_str().to_owned()),
        ("maveric.condition", meta.condition.to_string()),
        ("maveric.driven_by", meta.driven_by.as_str().to_owned()),
        ("maveric.rate_hz", drive.rate_hz().to_string()),
        ("maveric.lanes", road.lanes.to_string()),
        ("maveric.lane_width_m", road.lane_width_m.to_string()),
        (
            "maveric.posted_speed_mps",
            road.posted_speed_mps.to_string(),
        ),
    ];
    TableBuilder::default()
        .numbers("time_s", some(&r.time_s))
        .integers("segment", r.segment.iter().map(|&s| Some(i64::from(s))))
        .numbers("ego_x_m", some(&r.ego_x_m))
        .numbers("ego_y_m", some(&r.ego_y_m))
        .numbers("ego_speed_mps", some(&r.ego_speed_mps))
        .integers("lane", r.lane.iter().map(|&l| Some(i64::from(l))))
        .flags("lead_present", r.lead_present.iter().copied())
        .integers("lead_id", r.lead_id.iter().map(|id| id.map(i64::from)))
        .numbers("lead_dx_m", some(&r.lead_dx_m))
        .numbers("lead_dy_m", some(&r.lead_dy_m))
        .numbers("lead_speed_mps", some(&r.lead_speed_mps))
        .flags("lane_change", r.lane_change.iter().copied())
        .integers("changing", r.changing.iter().map(|&c| Some(i64::from(c))))
        .flags("change_completes", r.change_completes.iter().copied())
        .flags("following", r.following.iter().copied())
        .numbers(
            "following_distance_m",
            r.following
                .iter()
                .zip(&r.lead_dx_m)
                .map(|(&f, &d)| f.then_some(d)),
        )
        .numbers("gap_behind_left_m", r.gap_behind_left_m.iter().copied())
        .numbers("gap_behind_right_m", r.gap_behind_right_m.iter().copied())
        .write_with(&path, metadata.map(|(k, v)| (k.to_owned(), v)).to_vec())?;
    Ok(path)
}

/// Reads one drive back.
///
/// # Errors
/// [`StudyError::BadFile`] for Parquet that is no drive, and whatever a [`Table`] or a [`Drive`] refuses.
pub fn read_drive(path: &Path) -> Result<Drive, StudyError> {
    let table = Table::read(path)?;
    let file = File::open(path).map_err(StudyError::read(path))?;
    let bad = |e: PolarsError| StudyError::BadTable {
        path: path.to_owned(),
        format: "Parquet",
        problem: e.to_string(),
    };
    let mut reader = ParquetReader::new(file);
    let metadata = reader
        .get_metadata()
        .map_err(bad)?
        .key_value_metadata()
        .clone()
        .unwrap_or_default();
    let entry = |key: &str| {
        metadata
            .iter()
            .find(|kv| kv.key == key)
            .and_then(|kv| kv.value.clone())
            .ok_or_else(|| StudyError::BadFile {
                path: path.to_owned(),
                problem: format!(
                    "has no `{key}` in its metadata, so it is not a drive of this program"
                ),
                help: Some("make drives from logs with `maveric ingest`".to_owned()),
            })
    };
    let number = |key: &str| -> Result<f64, StudyError> {
        let text = entry(key)?;
        text.parse()
            .map_err(|_| StudyError::file(path, format!("`{key}` is `{text}`, expected a number")))
    };
    let version = entry("maveric.version")?;
    if version != VERSION {
        return Err(StudyError::file(
            path,
            format!("is a drive of format {version}, expected {VERSION}"),
        ));
    }
    let meta = DriveMeta {
        drive: entry("maveric.drive")?.try_into()?,
        participant: entry("maveric.participant")?.try_into()?,
        study: entry("maveric.study")?.parse()?,
        condition: entry("maveric.condition")?.parse()?,
        driven_by: entry("maveric.driven_by")?.parse()?,
    };
    let road = Road {
        lanes: number("maveric.lanes")? as u8,
        lane_width_m: number("maveric.lane_width_m")?,
        posted_speed_mps: number("maveric.posted_speed_mps")?,
    };
    let flags = |column: &str| -> Result<Vec<bool>, StudyError> {
        let cells = table.text(column)?;
        Ok(cells.iter().map(|c| c.as_deref() == Some("true")).collect())
    };
    let whole = |column: &str| -> Result<Vec<i64>, StudyError> {
        Ok(table
            .all_numbers(column)?
            .iter()
            .map(|&v| v as i64)
            .collect())
    };
    let rows = Rows {
        time_s: table.all_numbers("time_s")?,
        segment: whole("segment")?.iter().map(|&v| v as u32).collect(),
        ego_x_m: table.all_numbers("ego_x_m")?,
        ego_y_m: table.all_numbers("ego_y_m")?,
        ego_speed_mps: table.all_numbers("ego_speed_mps")?,
        lane: whole("lane")?.iter().map(|&v| v as u8).collect(),
        lead_present: flags("lead_present")?,
        lead_id: table
            .numbers("lead_id")?
            .iter()
            .map(|v| v.map(|id| id as u32))
            .collect(),
        lead_dx_m: table.all_numbers("lead_dx_m")?,
        lead_dy_m: table.all_numbers("lead_dy_m")?,
        lead_speed_mps: table.all_numbers("lead_speed_mps")?,
        lane_change: flags("lane_change")?,
        changing: whole("changing")?.iter().map(|&v| v as i8).collect(),
        change_completes: flags("change_completes")?,
        following: flags("following")?,
        gap_behind_left_m: table.numbers("gap_behind_left_m")?,
        gap_behind_right_m: table.numbers("gap_behind_right_m")?,
    };
    Ok(Drive::from_rows(
        meta,
        road,
        number("maveric.rate_hz")?,
        rows,
    )?)
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

/// Writes `<folder>/drives.csv`: one row a drive.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_drive_list(
    folder: &Path,
    drives: &[(DriveMeta, usize, f64)],
) -> Result<(), StudyError> {
    TableBuilder::default()
        .text("drive", drives.iter().map(|d| d.0.drive.as_str()))
        .text(
            "participant",
            drives.iter().map(|d| d.0.participant.as_str()),
        )
        .text("study", drives.iter().map(|d| d.0.study.as_str()))
        .text("condition", drives.iter().map(|d| d.0.condition.as_str()))
        .text("driven_by", drives.iter().map(|d| d.0.driven_by.as_str()))
        .integers("rows", drives.iter().map(|d| i64::try_from(d.1).ok()))
        .numbers("duration_s", drives.iter().map(|d| Some(d.2)))
        .write(&folder.join("drives.csv"))
}
