//! The columns of a long table, in SI units.

use super::super::{
    named,
    open::{Kind, Table},
    time::{Clock, stamps},
};
use crate::{
    error::IngestError,
    mapping::{Forward, TableMapping},
};
use std::{collections::BTreeMap, path::Path};

/// One row, in SI units and the table's own frame; NaN stands for an empty cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct LongRow {
    pub(super) group: u32,
    pub(super) id: u32,
    pub(super) stamp_ns: i64,
    pub(super) x_m: f64,
    pub(super) y_m: f64,
    pub(super) lane: f64,
    pub(super) speed_mps: f64,
    pub(super) speed_x_mps: f64,
    pub(super) yaw_rad: f64,
    pub(super) length_m: f64,
    pub(super) width_m: f64,
    pub(super) lead_id: Option<u32>,
    pub(super) gap_m: f64,
    pub(super) lead_x_m: f64,
    pub(super) lead_speed_mps: f64,
    pub(super) lead_length_m: f64,
}

/// The groups that vehicle numbers belong to.
#[derive(Debug, Default)]
pub(super) struct Groups {
    columns: Vec<String>,
    /// What each column holds, by group.
    values: Vec<Vec<String>>,
}

impl Groups {
    /// Column and value of a group.
    pub(super) fn captures(&self, group: u32) -> Vec<(String, String)> {
        let values = self.values.get(group as usize);
        let pairs = self.columns.iter().zip(values.into_iter().flatten());
        pairs.map(|(c, v)| (c.clone(), v.clone())).collect()
    }
}

/// A long table's rows.
#[derive(Debug)]
pub(super) struct LongColumns {
    pub(super) rows: Vec<LongRow>,
    /// Names of vehicles, sorted, and after them those of leaders; rows hold their places.
    pub(super) ids: Vec<String>,
    pub(super) groups: Groups,
    /// Rows without time, vehicle or position.
    pub(super) left_out: usize,
}

/// Reads what the mapping names.
///
/// # Errors
/// As [`crate::read_log`].
pub(super) fn read_columns(
    path: &Path,
    bytes: Vec<u8>,
    mapping: &TableMapping,
    clock: Clock<'_>,
) -> Result<LongColumns, IngestError> {
    let c = &mapping.columns;
    let time = named(path, "time", c.time.as_ref())?;
    let id = named(path, "id", c.id.as_ref())?;
    let x = named(path, "x", c.x.as_ref())?;
    let mut wanted = vec![(time, clock.kind()), (id, Kind::Word)];
    wanted.extend(c.groups.iter().map(|g| (g.as_str(), Kind::Word)));
    wanted.extend(c.lead_id.iter().map(|l| (l.as_str(), Kind::Word)));
    let words = ["time", "id", "groups", "lead_id"];
    let given = c.given();
    let numbers = given.iter().filter(|(key, _)| !words.contains(key));
    wanted.extend(numbers.map(|(_, name)| (*name, Kind::Number)));
    let table = Table::open(path, bytes, mapping.into(), &wanted)?;

    let length = mapping.units.length.metres();
    let speed = mapping.units.speed.metres_per_second();
    let column = |name: &Option<String>, unit: f64| -> Result<Option<Vec<f64>>, IngestError> {
        match name {
            Some(name) if table.has(name) => {
                let values = table.numbers(name)?;
                Ok(Some(
                    values.into_iter().map(|v| v * unit).collect::<Vec<f64>>(),
                ))
            }
            _ => Ok(None),
        }
    };
    let stamp_ns = stamps(&table, time, clock)?;
    let (id_codes, mut ids) = table.codes(id)?;
    let (group_codes, groups) = groups(&table, &c.groups)?;
    let lead_ids = match &c.lead_id {
        Some(name) if table.has(name) => {
            let (places, names) = leads(&table, name, &ids)?;
            ids.extend(names);
            Some(places)
        }
        _ => None,
    };
    let x = column(&Some(x.to_owned()), length)?.unwrap_or_default();
    let y = column(&c.y, length)?;
    let lane = column(&c.lane, 1.0)?;
    let (speed_x, speed_y) = (column(&c.speed_x, speed)?, column(&c.speed_y, speed)?);
    let speeds = column(&c.speed, speed)?;
    let angle = mapping.units.angle;
    let yaw = column(&c.heading, 1.0)?;
    let yaw = yaw.map(|yaw| yaw.into_iter().map(|a| angle.radians(a)).collect());
    let (long, wide) = (column(&c.length, length)?, column(&c.width, length)?);
    let (gap, lead_x) = (column(&c.gap, length)?, column(&c.lead_x, length)?);
    let lead_speed = column(&c.lead_speed, speed)?;
    let lead_length = column(&c.lead_length, length)?;

    let at = |column: &Option<Vec<f64>>, row: usize| column.as_ref().map_or(f64::NAN, |c| c[row]);
    let mut rows = Vec::with_capacity(table.rows());
    for row in 0..table.rows() {
        let (Some(stamp_ns), Some(id)) = (stamp_ns[row], id_codes[row]) else {
            continue;
        };
        let (Some(group), true) = (group_codes[row], x[row].is_finite()) else {
            continue;
        };
        let (vx, vy) = (at(&speed_x, row), at(&speed_y, row));
        let across = if vy.is_nan() { 0.0 } else { vy };
        let v = at(&speeds, row);
        let along = if mapping.forward == Forward::AgainstX {
            -1.0
        } else {
            1.0
        };
        let turned = if along < 0.0 {
            std::f64::consts::PI
        } else {
            0.0
        };
        rows.push(LongRow {
            group,
            id,
            stamp_ns,
            x_m: along * x[row],
            // Without a y everybody is on one line, until lanes say otherwise.
            y_m: y.as_ref().map_or(0.0, |y| along * y[row]),
            lane: at(&lane, row),
            speed_mps: if v.is_nan() { vx.hypot(across) } else { v },
            speed_x_mps: along * vx,
            yaw_rad: at(&yaw, row) + turned,
            length_m: at(&long, row),
            width_m: at(&wide, row),
            lead_id: lead_ids.as_ref().and_then(|l| l[row]),
            gap_m: at(&gap, row),
            lead_x_m: along * at(&lead_x, row),
            lead_speed_mps: at(&lead_speed, row),
            lead_length_m: at(&lead_length, row),
        });
    }
    // A row without the y or the lane that its table has stands nowhere.
    let by_lane = y.is_none() && lane.is_some();
    rows.retain(|r| r.y_m.is_finite() && (!by_lane || r.lane.is_finite()));
    Ok(LongColumns {
        left_out: table.rows() - rows.len(),
        rows,
        ids,
        groups,
    })
}

/// One number for each combination of groups.
fn groups(table: &Table, columns: &[String]) -> Result<(Vec<Option<u32>>, Groups), IngestError> {
    let mut parts = Vec::new();
    for name in columns {
        parts.push(table.codes(name)?);
    }
    let key = |row: usize| -> Option<Vec<u32>> { parts.iter().map(|(c, _)| c[row]).collect() };
    let mut numbers: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    for row in 0..table.rows() {
        if let Some(key) = key(row) {
            numbers.entry(key).or_default();
        }
    }
    for (i, number) in (0..).zip(numbers.values_mut()) {
        *number = i;
    }
    let value = |key: &Vec<u32>| -> Vec<String> {
        let named = key
            .iter()
            .zip(&parts)
            .map(|(&code, (_, names))| names[code as usize].clone());
        named.collect()
    };
    let groups = Groups {
        columns: columns.to_vec(),
        values: numbers.keys().map(value).collect(),
    };
    let codes = (0..table.rows())
        .map(|row| key(row).map(|k| numbers[&k]))
        .collect();
    Ok((codes, groups))
}

/// Leaders as places among the vehicles' names; beyond them those that have no rows of their own. 0 and -1 are none where no
/// vehicle is called so: some tables count from 0.
fn leads(
    table: &Table,
    name: &str,
    ids: &[String],
) -> Result<(Vec<Option<u32>>, Vec<String>), IngestError> {
    let (codes, names) = table.codes(name)?;
    let place = |(i, name): (u32, &String)| {
        let known = ids.binary_search(name).ok().map(|k| k as u32);
        match name.as_str() {
            "0" | "-1" => known,
            _ => known.or(Some(ids.len() as u32 + i)),
        }
    };
    let places: Vec<Option<u32>> = (0..).zip(&names).map(place).collect();
    let placed = codes
        .iter()
        .map(|c| c.and_then(|c| places[c as usize]))
        .collect();
    Ok((placed, names))
}
