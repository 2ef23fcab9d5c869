//! Several vehicles in file, side by side in a row: each but the first follows the one before it.

use super::{
    TableDrive, clock, named,
    open::{Kind, Table},
    pair::{Couple, bumper_gap_m, drive},
    time::stamps,
};
use crate::{
    error::IngestError,
    mapping::{GapKind, TableMapping},
};
use std::path::Path;

/// Most vehicles of a platoon.
const MOST_VEHICLES: usize = 99;

/// Reads the drives of a platoon: of vehicle 2 behind 1, of 3 behind 2, and so on.
///
/// The gap in column n is between vehicle n and vehicle n + 1.
///
/// # Errors
/// As [`crate::read_log`].
pub(super) fn read(
    path: &Path,
    bytes: Vec<u8>,
    mapping: &TableMapping,
) -> Result<Vec<TableDrive>, IngestError> {
    let columns = &mapping.columns;
    let time = named(path, "time", columns.time.as_ref())?;
    let speed = named(path, "speed", columns.speed.as_ref())?;
    let gap = named(path, "gap", columns.gap.as_ref())?;
    let of = |template: &str, n: usize| template.replace("{n}", &n.to_string());
    let optional = |template: &str, n: usize| format!("{}?", of(template, n).trim_end_matches('?'));
    let (x, length) = (columns.x.as_deref(), columns.length.as_deref());
    let mut names = vec![of(speed, 1), of(speed, 2), of(gap, 1)];
    for n in 1..=MOST_VEHICLES {
        let templates = [Some(speed), Some(gap), x, length];
        names.extend(templates.into_iter().flatten().map(|t| optional(t, n)));
    }
    let clock = clock(mapping);
    let mut wanted = vec![(time, clock.kind())];
    wanted.extend(names.iter().map(|n| (n.as_str(), Kind::Number)));
    let table = Table::open(path, bytes, mapping.into(), &wanted)?;

    let (to_m, to_mps) = (
        mapping.units.length.metres(),
        mapping.units.speed.metres_per_second(),
    );
    let some = |template: Option<&str>, n: usize, unit: f64| {
        table.scaled(template.map(|t| optional(t, n)).as_ref(), unit)
    };
    let of_car = |template: &str, n: usize, unit: f64| table.times(&of(template, n), unit);
    let length_m = |n: usize, otherwise_m: f64| -> Result<f64, IngestError> {
        let known = some(length, n, to_m)?;
        let first = known.into_iter().flatten().find(|l| *l > 0.0);
        Ok(first.unwrap_or(otherwise_m))
    };
    let stamp_ns = stamps(&table, time, clock)?;
    let mut drives = Vec::new();
    for lead in 1..MOST_VEHICLES {
        let ego = lead + 1;
        if !(table.has(&of(speed, ego)) && table.has(&of(gap, lead))) {
            break;
        }
        let lead_length_m = length_m(lead, mapping.lead_length_m)?;
        let ego_length_m = length_m(ego, mapping.ego_length_m)?;
        let gaps = of_car(gap, lead, to_m)?.into_iter();
        let couple = Couple {
            stamp_ns: stamp_ns.clone(),
            ego_x_m: some(x, ego, to_m)?,
            ego_y_m: None,
            ego_speed_mps: of_car(speed, ego, to_mps)?,
            ego_length_m,
            gap_m: gaps
                .map(|g| bumper_gap_m(g, mapping.gap_kind, ego_length_m, lead_length_m))
                .collect(),
            signed: mapping.gap_kind == Some(GapKind::Signed),
            lead_id: None,
            lead_dy_m: None,
            lead_speed_mps: Some(of_car(speed, lead, to_mps)?),
            lead_length_m: vec![lead_length_m; table.rows()],
            one_leader: true,
        };
        drives.push(TableDrive {
            captures: vec![("id".to_owned(), ego.to_string())],
            ..drive(path, &couple)
        });
    }
    Ok(drives)
}
