//! Several vehicles in file, side by side in a row: each but the first follows the one before it.

use super::{
    TableDrive, TableLog,
    lane::Lanes,
    open::Kind,
    pair::{Couple, Lane, Length, bumper_gap_m, drive, first_length},
    parts::stamps,
};
use crate::{
    error::IngestError,
    mapping::{GapKind, Platoon},
};

/// Most vehicles of a platoon.
const MOST_VEHICLES: usize = 99;

/// Reads the drives of a platoon: of vehicle 2 behind 1, of 3 behind 2, and so on.
///
/// The gap in column n is between vehicle n and vehicle n + 1.
pub(super) fn read(
    log: &mut TableLog<'_>,
    platoon: &Platoon,
) -> Result<Vec<TableDrive>, IngestError> {
    let (mapping, columns, clock) = (log.mapping, &platoon.columns, log.clock());
    let column = |template: &str, n: usize| template.replace("{n}", &n.to_string());
    let optional =
        |template: &str, n: usize| format!("{}?", column(template, n).trim_end_matches('?'));
    let (speed, gap) = (&columns.speed, &columns.gap);
    let mut names = vec![column(speed, 1), column(speed, 2), column(gap, 1)];
    let given = mapping.layout.columns();
    let of_cars: Vec<&String> =
        given.iter().filter(|(key, _)| key != "time").map(|g| &g.1).collect();
    for n in 1..=MOST_VEHICLES {
        names.extend(of_cars.iter().map(|template| optional(template, n)));
    }
    let mut wanted = vec![(columns.time.as_str(), clock.kind())];
    wanted.extend(names.iter().map(|n| (n.as_str(), Kind::Number)));
    let table = log.open(&wanted)?;

    let to_m = mapping.units.length.metres();
    let to_mps = mapping.units.speed.metres_per_second();
    let some = |template: &Option<String>, n: usize, unit: f64| {
        table.scaled(template.as_ref().map(|t| optional(t, n)).as_ref(), unit)
    };
    let of_car = |template: &str, n: usize, unit: f64| table.times(&column(template, n), unit);
    let length_of = |n: usize, otherwise_m: f64| -> Result<Length, IngestError> {
        Ok(first_length(some(&columns.length, n, to_m)?, otherwise_m))
    };
    let lanes = Lanes::new(mapping, log.road, platoon.offset_grows);
    // Where a car is across the road, and what columns say of its lane.
    let across = |n: usize| -> Result<(Option<Vec<f64>>, Lane), IngestError> {
        let (lane, offset) = (some(&columns.lane, n, 1.0)?, some(&columns.offset, n, 1.0)?);
        let known = Lane::known_by(false, lane.is_some(), offset.is_some());
        Ok((lanes.across_m(lane.as_deref(), offset.as_deref()), known))
    };
    let (mut numbers, mut places) = (Vec::new(), Vec::new());
    for n in (1..=MOST_VEHICLES).take_while(|n| table.has(&column(speed, *n))) {
        numbers.extend(some(&columns.lane, n, 1.0)?.into_iter().flatten());
        places.extend(some(&columns.offset, n, 1.0)?.into_iter().flatten());
    }
    log.warnings.extend(lanes.doubts(log.path, numbers, places)?);
    let stamp_ns = stamps(&table, &columns.time, clock)?;
    let mut drives = Vec::new();
    for lead in 1..MOST_VEHICLES {
        let ego = lead + 1;
        if !(table.has(&column(speed, ego)) && table.has(&column(gap, lead))) {
            break;
        }
        let lead_length = length_of(lead, mapping.lead_length_m)?;
        let ego_length = length_of(ego, mapping.ego_length_m)?;
        let (lead_length_m, ego_length_m) = (lead_length.length_m, ego_length.length_m);
        let gaps = of_car(gap, lead, to_m)?.into_iter();
        let ((lead_y_m, lead_lane), (ego_y_m, lane)) = (across(lead)?, across(ego)?);
        let both_known = lane != Lane::Unknown && lead_lane != Lane::Unknown;
        let beside = lead_y_m.zip(ego_y_m.as_ref()).filter(|_| both_known);
        let couple = Couple {
            stamp_ns: stamp_ns.clone(),
            ego_x_m: some(&columns.x, ego, to_m)?,
            lead_dy_m: beside.map(|(lead, ego)| lead.iter().zip(ego).map(|(l, e)| l - e).collect()),
            ego_y_m,
            lane,
            ego_speed_mps: of_car(speed, ego, to_mps)?,
            ego_length,
            gap_m: gaps
                .map(|g| bumper_gap_m(g, mapping.gap_kind, ego_length_m, lead_length_m))
                .collect(),
            signed: mapping.gap_kind == Some(GapKind::Signed),
            lead_id: None,
            lead_speed_mps: Some(of_car(speed, lead, to_mps)?),
            lead_length_m: vec![lead_length_m; table.rows()],
            stands_in: vec![true; if lead_length.stands_in { table.rows() } else { 0 }],
            one_leader: true,
        };
        drives.push(TableDrive {
            captures: vec![("id".to_owned(), ego.to_string())],
            ..drive(log.path, couple)
        });
    }
    Ok(drives)
}
