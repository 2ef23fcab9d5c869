//! A drive whose signals have their own files or columns, and their own times: ego's speed, its velocity, its place across the road,
//! and who is ahead.

mod lead;
mod path;
mod place;
mod road;
mod rows;
mod tracks;

use super::{TableDrive, TableLog, open::Kind, parts::stamps};
use crate::{
    error::IngestError,
    mapping::{RoadMapping, Signals, SpeedSignal, TableMapping, VelocitySignal},
    quality::{Warning, WarningKind, report},
    raw::{EgoSample, EgoSamples, ObjectSamples, RawDrive},
    source::Source,
};
use lead::Leads;
use maveric_domain::Sees;
use path::{DrivenPath, Heading};
use place::{Across, Place};
use road::RoadAlong;
use rows::Files;

/// A drive shorter than this is told, in s: it shows few habits.
const SHORT_S: f64 = 60.0;

/// Reads the drive of a folder, or of a table.
///
/// Ego's way is the integral of its speed. Tracks are placed along the path that ego has driven afterwards, from
/// its velocity's direction: in a bend the vehicle in ego's lane is beside ego's heading. All signals are joined by their times.
///
/// # Errors
/// As [`crate::read_log`], naming the signal's file.
pub(super) fn read(
    log: &mut TableLog<'_>,
    signals: &Signals,
    sources: &mut Vec<Source>,
) -> Result<TableDrive, IngestError> {
    let (mapping, road, max_gap_s) = (log.mapping, log.road, log.max_gap_s);
    let table = std::mem::take(&mut log.files);
    let mut files = Files::new(log, table, sources);
    let log = files.log;
    let to_mps = mapping.units.speed.metres_per_second();
    let mut warnings = Vec::new();
    let speed = speed_samples(&mut files, &signals.speed, to_mps, &mut warnings)?;
    let heading = if let Some(signal) = &signals.velocity {
        headings(&mut files, signal)?
    } else {
        if signals.tracks.is_some() {
            let what = "no velocity is mapped: the road is taken to be straight";
            report(&mut warnings, log, WarningKind::Default, 1, what);
        }
        Vec::new()
    };
    let driven = DrivenPath::new(&speed, heading, max_gap_s);
    let (road, place, across) = across(&mut files, signals, mapping, road, &driven, &mut warnings)?;
    let mut objects = match &signals.tracks {
        Some(signal) => tracks::read(&mut files, signal, mapping, &driven, &mut warnings)?,
        None => ObjectSamples::default(),
    };
    let leads = match &signals.lead {
        Some(signal) => {
            let place = place.as_ref();
            lead::read(&mut files, signal, mapping, &driven, place, &mut warnings)?
        }
        None => Leads::default(),
    };
    objects.extend(leads.objects.iter());
    if let Some((first, last)) = driven.ends_ns()
        && ((last - first) as f64) < SHORT_S * 1e9
    {
        // Cut and not rounded: 59.95 s are not 60.
        let seconds = ((last - first) as f64 / 1e8).floor() / 10.0;
        let what = format!(
            "the drive is {seconds:.1} s long, shorter than {SHORT_S} s: it shows few habits"
        );
        report(&mut warnings, log, WarningKind::Noted, 1, &what);
    }
    warnings.append(&mut files.warnings);
    Ok(TableDrive {
        road,
        raw: RawDrive {
            ego: ego_samples(&driven, place.as_ref(), &across, max_gap_s),
            objects,
            sightings: leads.sightings,
            sees: Sees {
                ahead: signals.tracks.is_some() || signals.lead.is_some(),
                lanes: place.is_some(),
                ..Sees::NOTHING
            },
            ego_length_m: Some(mapping.ego_length_m),
            ..RawDrive::default()
        },
        warnings,
        gaps: leads.gaps,
        ..TableDrive::default()
    })
}

/// The road where signals know better than the mapping, and ego's place across it where a signal says it.
fn across(
    files: &mut Files<'_>,
    signals: &Signals,
    mapping: &TableMapping,
    mapped: &RoadMapping,
    driven: &DrivenPath,
    warnings: &mut Vec<Warning>,
) -> Result<(Option<RoadMapping>, Option<Place>, Across), IngestError> {
    let along = match &signals.road {
        Some(signal) => road::read(files, signal, mapping, mapped, warnings)?,
        None => RoadAlong::default(),
    };
    let mut across = Across::default();
    if let Some(signal) = &signals.lane_changes {
        across.listed(files, signal, warnings)?;
    }
    // Whoever changes lanes has two.
    let least = if across.changes.is_empty() { 1 } else { 2 };
    let road_mapping = RoadMapping {
        lanes: along.lanes.unwrap_or(mapped.lanes).max(least),
        posted_speed_mps: along.posted_speed_mps.unwrap_or(mapped.posted_speed_mps),
        ..*mapped
    };
    if let Some(signal) = &signals.lane {
        across.lane(files, signal, mapping, &road_mapping, warnings)?;
    }
    let mapped_lanes = signals.lane.is_some() || signals.lane_changes.is_some();
    let place = driven.ends_ns().filter(|_| mapped_lanes);
    let place = place.map(|ends| {
        let road = road_mapping.road();
        across.place(files.log, &road, &along.lane, ends, warnings)
    });
    Ok((
        (road_mapping != *mapped).then_some(road_mapping),
        place,
        across,
    ))
}

/// Ego as its speed says, and between at the times at which its place across the road is known.
fn ego_samples(
    driven: &DrivenPath,
    place: Option<&Place>,
    across: &Across,
    max_gap_s: f64,
) -> EgoSamples {
    let mut samples: Vec<(i64, f64, f64)> = driven.samples().collect();
    if let Some(place) = place {
        let between = across.stamps().filter_map(|t| {
            let ego = driven.seen_at(t, max_gap_s)?;
            Some((t, ego.way_m, ego.speed_mps))
        });
        samples.extend(between);
        // Stable: of two at one time the speed's own counts.
        samples.sort_by_key(|s| s.0);
        samples.dedup_by_key(|s| s.0);
        // A hole is what begins a segment.
        let half_ns = ((0.5 * max_gap_s + 0.05) * 1e9) as i64;
        samples.retain(|s| place.anew.iter().all(|t| (s.0 - t).abs() > half_ns));
    }
    let ego = |(stamp_ns, x_m, speed_mps)| EgoSample {
        stamp_ns,
        log_ns: stamp_ns,
        nth: 0,
        x_m,
        y_m: place.map_or(0.0, |p| p.lateral_m(stamp_ns)),
        yaw_rad: Some(0.0),
        speed_mps: Some(speed_mps),
    };
    samples.into_iter().map(ego).collect()
}

/// Time and speed in m/s, in the order of time.
fn speed_samples(
    files: &mut Files<'_>,
    signal: &SpeedSignal,
    to_mps: f64,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<(i64, f64)>, IngestError> {
    let columns = [(signal.value.as_str(), Kind::Number)];
    let rows = files.rows(&signal.file, &signal.time, &columns, None)?;
    rows.report(warnings);
    let values = rows.numbers(&signal.value, &signal.missing, to_mps)?;
    let known = rows.stamp_ns.iter().zip(values);
    let known: Vec<(i64, f64)> = known.filter_map(|(t, v)| Some((*t, v?))).collect();
    let left_out = rows.stamp_ns.len() - known.len();
    let what = "rows without a speed of ego are left out";
    let missing = WarningKind::MissingValue;
    report(warnings, &rows.path, missing, left_out, what);
    Ok(known)
}

/// Directions of ego's movement in the plane of the ground, in rad counter-clockwise from east, while it moves.
fn headings(files: &mut Files<'_>, signal: &VelocitySignal) -> Result<Vec<Heading>, IngestError> {
    let mut wanted = vec![(signal.time.as_str(), files.clock.kind())];
    let vectors = signal.position.iter().chain(&signal.velocity);
    wanted.extend(vectors.map(|name| (name.as_str(), Kind::Number)));
    let table = files.open(&signal.file, &wanted)?;
    let times = stamps(&table, &signal.time, files.clock)?;
    let vector = |names: &[String; 3]| -> Result<[Vec<f64>; 3], IngestError> {
        Ok([
            table.numbers(&names[0])?,
            table.numbers(&names[1])?,
            table.numbers(&names[2])?,
        ])
    };
    let (position, velocity) = (vector(&signal.position)?, vector(&signal.velocity)?);
    let xyz = |v: &[Vec<f64>; 3], row: usize| [v[0][row], v[1][row], v[2][row]];
    let rows = times.into_iter().enumerate();
    Ok(rows
        .filter_map(|(row, time)| path::heading(time?, xyz(&position, row), xyz(&velocity, row)))
        .collect())
}
