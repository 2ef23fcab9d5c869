//! A row is one vehicle at one time: every vehicle is ego of a drive of its own among the others.

mod columns;
mod runs;
mod surroundings;
mod vehicles;

use super::{Gaps, TableDrive, TableLog, ids::numbers, lane::Lanes, recording_meta};
use crate::{
    error::IngestError,
    mapping::{Long, Side},
    quality::{Warning, WarningKind, report},
    raw::RawDrive,
    source::Source,
};
use columns::{LongTable, read_rows};
use maveric_domain::Sees;
use std::path::Path;
use surroundings::{Surroundings, View};
use vehicles::{Frame, Vehicle, vehicles};

/// Reads the drives of a long table, ordered by group and vehicle.
///
/// Positions become those of centres, y grows to the left of the way that ego drives. Ego's leader is what its own row says
/// of it (`lead_x` or `gap`), where it does; everybody else is there by their own rows at the same time.
pub(super) fn read(
    log: &mut TableLog<'_>,
    long: &Long,
    sources: &mut Vec<Source>,
) -> Result<Vec<TableDrive>, IngestError> {
    let (path, mapping, road) = (log.path, log.mapping, log.road);
    let meta = long.recording_meta.as_ref();
    let meta = meta.map(|columns| recording_meta::read(path, columns, mapping, sources));
    let meta = meta.transpose()?;
    let mut clock = log.clock();
    if let Some(rate) = meta.as_ref().and_then(|m| m.frames_per_s) {
        clock.frames_per_s = rate;
    }
    let LongTable { mut rows, ids, groups, left_out, .. } = read_rows(log, long, clock)?;
    let frame = Frame {
        y_left: long.y_grows.map_or(1.0, Side::to_left),
        lanes: Lanes::new(mapping, road, long.offset_grows),
        mapping,
        long,
    };
    let (in_lanes, places) = (rows.iter().map(|r| r.lane), rows.iter().map(|r| r.offset));
    log.warnings.extend(frame.lanes.doubts(path, in_lanes, places)?);
    log.warnings.extend(runs::separate(path, &mut rows, &ids, clock.hole_ns)?);
    let fleet = vehicles(rows, &frame, log.max_gap_s);
    log.warnings.extend(without_speed(path, &fleet.vehicles, &ids));
    log.warnings.extend(at_one_time(path, &fleet.vehicles, &ids));
    let c = &long.columns;
    let view = match (c.lead_id.is_some(), c.heading.is_some()) {
        (true, true) => View::LeaderInBends,
        (true, false) if c.y.is_none() && c.lane.is_none() => View::Leader,
        _ => View::All,
    };
    let ego = match &long.ego {
        None => None,
        Some(name) => Some(ids.iter().position(|id| id == name).ok_or_else(|| {
            let shown = ids[..ids.len().min(20)].join(", ");
            let what = format!("no vehicle is called `{name}` as in `table.ego`");
            IngestError::bad_table(path, format!("{what}; its vehicles are {shown}"))
        })?),
    };
    let across = c.y.is_some() || c.lane.is_some();
    let surroundings = Surroundings::new(&fleet.vehicles, log.max_gap_s);
    let numbers = numbers(&ids);
    let mut drives = Vec::new();
    let mut alone = 0;
    for (index, vehicle) in fleet.vehicles.iter().enumerate() {
        if ego.is_some_and(|ego| ego != vehicle.id as usize) {
            continue;
        }
        if vehicle.samples.len() < 2 {
            alone += 1;
            continue;
        }
        let mut captures = groups.captures(vehicle.group);
        captures.push(("id".to_owned(), name_of(vehicle, &ids)));
        let around = surroundings.others(&fleet.vehicles, index, &numbers, view);
        let raw = RawDrive {
            ego: vehicle.samples.clone(),
            objects: around.objects,
            sightings: around.sightings,
            ego_length_m: Some(vehicle.length_m),
            sees: match view {
                View::All => Sees { beside: across, lanes: across, ..Sees::ALL },
                View::Leader | View::LeaderInBends => Sees::LEAD,
            },
            ..RawDrive::default()
        };
        let mut warnings = vehicle_warnings(path, vehicle);
        let what = "rows name a leader that has no rows of its own at that time: whether the road is free is unknown";
        report(&mut warnings, path, WarningKind::MissingValue, around.lost_leaders, what);
        let what = format!(
            "other vehicles whose length is not known: the mapping's `lead_length_m` of {} m stands in",
            mapping.lead_length_m
        );
        report(&mut warnings, path, WarningKind::Default, around.without_length, &what);
        drives.push(TableDrive {
            captures,
            lane_steps: fleet.lane_steps,
            road: meta.as_ref().map(|m| m.road(road, vehicle.sign, frame.y_left)),
            raw,
            warnings,
            gaps: gaps(vehicle),
        });
    }
    let what = "rows without time, vehicle or position are left out";
    let kind = WarningKind::MissingValue;
    report(&mut log.warnings, path, kind, left_out, what);
    let what = "vehicles with a single row are no drive";
    report(&mut log.warnings, path, kind, alone, what);
    Ok(drives)
}

/// Says of how many rows the speed is that of positions, since their cells hold none.
fn without_speed(path: &Path, vehicles: &[Vehicle], ids: &[String]) -> Option<Warning> {
    let without = vehicles.iter().filter(|v| v.differentiated > 0);
    let first = without.clone().next()?;
    let rows = without.clone().map(|v| v.differentiated).sum();
    let whose = match without.count() {
        1 => format!("vehicle {}", name_of(first, ids)),
        several => format!("{several} vehicles, the first of them {},", name_of(first, ids)),
    };
    let what = format!(
        "rows of {whose} hold no speed: it is differentiated from the positions, in drives of others too"
    );
    Some(Warning::new(path, WarningKind::Default, rows, what))
}

/// Warns of vehicles with several rows at one time, of which others see the first.
fn at_one_time(path: &Path, vehicles: &[Vehicle], ids: &[String]) -> Option<Warning> {
    let rows = |v: &Vehicle| v.samples.stamp_ns.windows(2).filter(|w| w[0] == w[1]).count();
    let mut several = vehicles.iter().filter(|v| rows(v) > 0);
    let first = several.next()?;
    let count = rows(first) + several.clone().map(rows).sum::<usize>();
    let whose = match several.count() {
        0 => format!("vehicle {}", name_of(first, ids)),
        more => {
            format!("{} vehicles, the first of them vehicle {},", more + 1, name_of(first, ids))
        }
    };
    let what = format!(
        "rows of {whose} are at a time at which it has a row already: the first one counts. Does one number stand for several vehicles?"
    );
    Some(Warning::new(path, WarningKind::DuplicateTime, count, what))
}

/// The gaps that a vehicle's own rows say, in the frame in which they say them.
fn gaps(vehicle: &Vehicle) -> Gaps {
    let mut gaps = Gaps::default();
    for (sample, lead) in vehicle.samples.iter().zip(&vehicle.leads) {
        if let Some(lead) = lead {
            let centres_m = 0.5 * (vehicle.length_m + lead.length_m);
            gaps.note(sample.stamp_ns, lead.x_m - sample.x_m - centres_m);
        }
    }
    gaps
}

fn vehicle_warnings(path: &Path, vehicle: &Vehicle) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if !vehicle.length_known {
        let what = format!("ego's length is not known: {} m stands in", vehicle.length_m);
        report(&mut warnings, path, WarningKind::Default, 1, &what);
    }
    let leads = vehicle.leads.iter().flatten();
    let unknown = leads.filter(|l| !l.length_known).count();
    let what = "rows whose leader's length is not known: the mapping's `lead_length_m` stands in";
    report(&mut warnings, path, WarningKind::Default, unknown, what);
    warnings
}

fn name_of(vehicle: &Vehicle, ids: &[String]) -> String {
    let id = ids.get(vehicle.id as usize).map_or("", String::as_str);
    match vehicle.generation {
        0 => id.to_owned(),
        again => format!("{id}-{}", again + 1),
    }
}
