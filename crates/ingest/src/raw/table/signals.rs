//! A folder in which every signal has its own file and its own times: ego's speed, its velocity, tracks ahead.

mod path;
mod tracks;

use super::{
    TableDrive, clock,
    open::{Kind, Table},
    report, take,
    time::{Clock, stamps},
};
use crate::{
    error::IngestError,
    mapping::{SpeedSignal, TableMapping, VelocitySignal},
    quality::WarningKind,
    raw::{EgoSample, RawDrive},
    source::Source,
};
use path::{DrivenPath, Heading};
use std::path::Path;

/// Reads the drive of a folder.
///
/// Ego's way is the integral of its speed. What is seen ahead is placed along the path that ego has driven afterwards, from
/// its velocity's direction: in a bend the vehicle in ego's lane is beside ego's heading.
///
/// # Errors
/// As [`crate::read_log`], naming the signal's file.
pub(super) fn read(
    folder: &Path,
    mapping: &TableMapping,
    max_gap_s: f64,
    sources: &mut Vec<Source>,
) -> Result<TableDrive, IngestError> {
    let Some(signals) = &mapping.signals else {
        let what = "layout `signals` needs `[table.signals.speed]`";
        return Err(IngestError::bad_mapping(folder, what));
    };
    let clock = clock(mapping);
    let to_mps = mapping.units.speed.metres_per_second();
    let mut warnings = Vec::new();
    let (speed, left_out) = speed_samples(folder, &signals.speed, clock, to_mps, sources)?;
    let missing = WarningKind::MissingValue;
    let what = "rows without time or speed of ego are left out";
    report(&mut warnings, folder, missing, left_out, what);
    let heading = if let Some(signal) = &signals.velocity {
        headings(folder, signal, clock, sources)?
    } else {
        let what = "no velocity is mapped: the road is taken to be straight";
        report(&mut warnings, folder, WarningKind::Default, 1, what);
        Vec::new()
    };
    let driven = DrivenPath::new(&speed, heading, max_gap_s);
    let objects = match &signals.tracks {
        Some(signal) => {
            let table = tracks::open_tracks(folder, signal, clock, sources)?;
            tracks::read(
                folder,
                &table,
                signal,
                mapping,
                clock,
                &driven,
                &mut warnings,
            )?
        }
        None => Vec::new(),
    };
    let ego = driven
        .samples()
        .map(|(stamp_ns, x_m, speed_mps)| EgoSample {
            stamp_ns,
            log_ns: stamp_ns,
            nth: 0,
            x_m,
            y_m: 0.0,
            yaw_rad: Some(0.0),
            speed_mps: Some(speed_mps),
        });
    Ok(TableDrive {
        raw: RawDrive {
            ego: ego.collect(),
            objects,
            ego_length_m: Some(mapping.ego_length_m),
            ..RawDrive::default()
        },
        warnings,
        ..TableDrive::default()
    })
}

/// Opens the file of a signal.
///
/// # Errors
/// As [`Table::open`], and where there is no such file.
fn open(
    folder: &Path,
    file: &str,
    wanted: &[(&str, Kind)],
    sources: &mut Vec<Source>,
) -> Result<Table, IngestError> {
    let path = folder.join(file);
    let bytes = take(&path, sources)?;
    Table::open(&path, bytes, super::text::Style::default(), wanted)
}

/// Time and speed in m/s, in the order of the file, and the number of rows that lack one.
fn speed_samples(
    folder: &Path,
    signal: &SpeedSignal,
    clock: Clock<'_>,
    to_mps: f64,
    sources: &mut Vec<Source>,
) -> Result<(Vec<(i64, f64)>, usize), IngestError> {
    let wanted = [
        (signal.time.as_str(), clock.kind()),
        (signal.value.as_str(), Kind::Number),
    ];
    let table = open(folder, &signal.file, &wanted, sources)?;
    let times = stamps(&table, &signal.time, clock)?;
    let values = table.numbers(&signal.value)?;
    let rows = times.into_iter().zip(values);
    let known = rows.filter_map(|(t, v)| Some((t?, v * to_mps)).filter(|s| s.1.is_finite()));
    let known: Vec<(i64, f64)> = known.collect();
    let left_out = table.rows() - known.len();
    Ok((known, left_out))
}

/// Directions of ego's movement in the plane of the ground, in rad counter-clockwise from east, while it moves.
fn headings(
    folder: &Path,
    signal: &VelocitySignal,
    clock: Clock<'_>,
    sources: &mut Vec<Source>,
) -> Result<Vec<Heading>, IngestError> {
    let mut wanted = vec![(signal.time.as_str(), clock.kind())];
    let vectors = signal.position.iter().chain(&signal.velocity);
    wanted.extend(vectors.map(|name| (name.as_str(), Kind::Number)));
    let table = open(folder, &signal.file, &wanted, sources)?;
    let times = stamps(&table, &signal.time, clock)?;
    let vector = |names: &[String; 3]| -> Result<[Vec<f64>; 3], IngestError> {
        Ok([
            table.numbers(&names[0])?,
            table.numbers(&names[1])?,
            table.numbers(&names[2])?,
        ])
    };
    let (position, velocity) = (vector(&signal.position)?, vector(&signal.velocity)?);
    let at = |v: &[Vec<f64>; 3], row: usize| [v[0][row], v[1][row], v[2][row]];
    let rows = times.into_iter().enumerate();
    Ok(rows
        .filter_map(|(row, time)| path::heading(time?, at(&position, row), at(&velocity, row)))
        .collect())
}
