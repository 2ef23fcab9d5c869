//! Reads the drive of a table.

use crate::{
    error::{IngestError, nearest},
    mapping::{GapKind, Layout, TableMapping},
    quality::{Warning, WarningKind},
    raw::{EgoSample, ObjectSample, RawDrive},
};
use polars::prelude::{CsvParseOptions, CsvReadOptions, DataFrame, SerReader};
use std::{io::Cursor, path::Path};

/// Number that a leader has among the vehicles of its file.
const LEADER: u32 = 1;

/// Words that stand for an empty cell.
const EMPTY: [&str; 6] = ["", "nan", "na", "null", "none", "-"];

/// Reads a text as a table of text: numbers are made here, so that an error can name the row.
///
/// # Errors
/// [`IngestError::BadTable`].
pub(crate) fn read_frame(
    path: &Path,
    text: Vec<u8>,
    separator: char,
) -> Result<DataFrame, IngestError> {
    let bad = |reason: String| IngestError::BadTable {
        path: path.to_owned(),
        reason,
    };
    let text = match text.strip_prefix(b"\xef\xbb\xbf") {
        Some(without_mark) => without_mark.to_vec(),
        None => text,
    };
    let parse = CsvParseOptions::default().with_separator(separator as u8);
    let frame = CsvReadOptions::default()
        .with_infer_schema_length(Some(0))
        .with_has_header(true)
        .with_parse_options(parse)
        .into_reader_with_file_handle(Cursor::new(text))
        .finish()
        .map_err(|e| bad(e.to_string().lines().next().unwrap_or_default().to_owned()))?;
    if frame.height() == 0 {
        return Err(bad("it has a header and no rows".to_owned()));
    }
    Ok(frame)
}

/// A column as numbers; an empty cell is `None`.
///
/// # Errors
/// [`IngestError::UnknownColumn`], [`IngestError::BadCell`].
pub(crate) fn numbers(
    path: &Path,
    frame: &DataFrame,
    name: &str,
) -> Result<Vec<Option<f64>>, IngestError> {
    let unknown = || {
        let columns: Vec<&str> = frame
            .get_column_names()
            .iter()
            .map(|n| n.as_str())
            .collect();
        IngestError::UnknownColumn {
            path: path.to_owned(),
            column: name.to_owned(),
            nearest: nearest(name, columns.iter().copied()),
            found: columns.join(", "),
        }
    };
    let column = frame.column(name).map_err(|_| unknown())?;
    let texts = column.str().map_err(|_| unknown())?;
    let number = |(row, cell): (usize, Option<&str>)| {
        let cell = cell.map(str::trim).unwrap_or_default();
        if EMPTY.iter().any(|e| cell.eq_ignore_ascii_case(e)) {
            return Ok(None);
        }
        let parsed = cell.parse().ok().filter(|v: &f64| v.is_finite());
        parsed.map(Some).ok_or_else(|| IngestError::BadCell {
            path: path.to_owned(),
            row: row + 1,
            column: name.to_owned(),
            found: cell.to_owned(),
        })
    };
    texts.iter().enumerate().map(number).collect()
}

/// Reads the samples of a table: ego, and the leader ahead of it.
///
/// The leader's centre is put where its bumper is as far from ego's as the table says.
///
/// # Errors
/// As [`crate::read_log`].
pub(crate) fn read(
    path: &Path,
    text: Vec<u8>,
    mapping: &TableMapping,
) -> Result<(RawDrive, Vec<Warning>), IngestError> {
    let frame = read_frame(path, text, mapping.separator)?;
    match mapping.layout {
        Layout::Pair => pair(path, &frame, mapping),
    }
}

fn pair(
    path: &Path,
    frame: &DataFrame,
    mapping: &TableMapping,
) -> Result<(RawDrive, Vec<Warning>), IngestError> {
    let (names, units) = (&mapping.columns, &mapping.units);
    let column = |name: &str| numbers(path, frame, name);
    let time = column(&names.time)?;
    let ego_x = column(&names.ego_x)?;
    let ego_speed = column(&names.ego_speed)?;
    let lead_speed = column(&names.lead_speed)?;
    let gap = column(&names.gap)?;
    let lead_length = match &names.lead_length {
        Some(name) => column(name)?,
        None => vec![None; time.len()],
    };
    let length = units.length.metres();
    let speed = units.speed.metres_per_second();
    // A leader does not grow: its length is the first that is known.
    let known = lead_length.iter().flatten().find(|l| **l > 0.0);
    let lead_length_m = known.map_or(mapping.lead_length_m, |l| l * length);
    let front_to_gap_m = match mapping.gap_kind {
        GapKind::BumperToBumper => 0.0,
        GapKind::FrontToFront => -lead_length_m,
    };
    let centres_m = 0.5 * (mapping.ego_length_m + lead_length_m) + front_to_gap_m;
    let mut drive = RawDrive {
        ego_length_m: Some(mapping.ego_length_m),
        ..RawDrive::default()
    };
    let (mut without_ego, mut without_leader) = (0, 0);
    for row in 0..time.len() {
        let (Some(t), Some(x), Some(v)) = (time[row], ego_x[row], ego_speed[row]) else {
            without_ego += 1;
            continue;
        };
        let ns = t * units.time.nanoseconds();
        // Beyond this nanoseconds since 1970 do not fit.
        if ns.abs() > 9e18 {
            return Err(IngestError::BadCell {
                path: path.to_owned(),
                row: row + 1,
                column: names.time.clone(),
                found: t.to_string(),
            });
        }
        let stamp_ns = ns.round() as i64;
        drive.ego.push(EgoSample {
            stamp_ns,
            log_ns: stamp_ns,
            x_m: x * length,
            y_m: 0.0,
            yaw_rad: Some(0.0),
            speed_mps: Some(v * speed),
        });
        let (Some(gap), Some(v)) = (gap[row], lead_speed[row]) else {
            without_leader += 1;
            continue;
        };
        drive.objects.push(ObjectSample {
            stamp_ns,
            log_ns: stamp_ns,
            id: LEADER,
            x_m: x * length + gap * length + centres_m,
            y_m: 0.0,
            speed_mps: v * speed,
            length_m: Some(lead_length_m),
        });
    }
    let mut warnings = Vec::new();
    let mut report = |kind, count, what: &str| {
        if count > 0 {
            warnings.push(Warning::new(path, kind, count, what));
        }
    };
    let what = "rows without time, position or speed of ego are left out";
    report(WarningKind::MissingValue, without_ego, what);
    let what = "rows without gap or speed of the leader have no leader";
    report(WarningKind::MissingValue, without_leader, what);
    Ok((drive, warnings))
}
