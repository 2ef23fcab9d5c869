//! The columns of a long table, in SI units.

use super::super::{
    named,
    open::{Kind, Table},
    time::{Clock, stamps},
};
use crate::{
    error::IngestError,
    mapping::{Columns, Forward, TableMapping},
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
    pub(super) centre_ahead_m: f64,
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
    /// How many of the names are vehicles'.
    vehicles: usize,
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
    named(path, "x", c.x.as_ref())?;
    let around = match c.around_id() {
        Some(around) => Some((around, Table::names(path, &bytes, mapping.into(), time)?)),
        None => None,
    };
    // Names of vehicles that have columns of their own, and those columns.
    let wide: Option<Vec<(String, Columns)>> = around.map(|((before, behind), names)| {
        let id = |name: &String| {
            name.strip_prefix(before)?
                .strip_suffix(behind)
                .map(str::to_owned)
        };
        let mut ids: Vec<String> = names
            .iter()
            .filter_map(id)
            .filter(|id| !id.is_empty())
            .collect();
        ids.sort();
        ids.dedup();
        ids.into_iter()
            .map(|id| (id.clone(), c.of_vehicle(&id)))
            .collect()
    });
    // Without any the error names the column that is wanted.
    let of: Vec<&Columns> = match &wide {
        Some(vehicles) if !vehicles.is_empty() => vehicles.iter().map(|(_, c)| c).collect(),
        _ => vec![c],
    };
    let mut wanted = vec![(time, clock.kind())];
    for columns in &of {
        wanted.extend(
            columns
                .given()
                .into_iter()
                .filter(|(key, _)| *key != "time")
                .map(|(key, name)| {
                    let word = ["id", "groups", "lead_id"].contains(&key);
                    (name, if word { Kind::Word } else { Kind::Number })
                }),
        );
    }
    let table = Table::open(path, bytes, mapping.into(), &wanted)?;
    let stamp_ns = stamps(&table, time, clock)?;
    let (group_codes, groups) = groups(&table, &c.groups)?;
    let mut found = LongColumns {
        rows: Vec::with_capacity(table.rows() * of.len()),
        ids: Vec::new(),
        groups,
        vehicles: 0,
        left_out: 0,
    };
    match wide {
        None => {
            let (codes, ids) = table.codes(named(path, "id", c.id.as_ref())?)?;
            (found.vehicles, found.ids) = (ids.len(), ids);
            let places = codes.iter().zip(&stamp_ns).zip(&group_codes);
            let places: Vec<Place> = places
                .map(|((id, ns), group)| Some(((*group)?, (*id)?, (*ns)?)))
                .collect();
            found.take(&table, mapping, c, &places)?;
            found.left_out = table.rows() - found.rows.len();
        }
        Some(vehicles) => {
            found.vehicles = vehicles.len();
            found.ids = vehicles.iter().map(|(id, _)| id.clone()).collect();
            for (id, (_, columns)) in (0..).zip(&vehicles) {
                let places = stamp_ns.iter().zip(&group_codes);
                let places: Vec<Place> = places
                    .map(|(ns, group)| Some(((*group)?, id, (*ns)?)))
                    .collect();
                // Where its columns are empty the vehicle is not there.
                found.take(&table, mapping, columns, &places)?;
            }
            found.left_out = stamp_ns.iter().filter(|ns| ns.is_none()).count();
        }
    }
    Ok(found)
}

/// Group, vehicle and time of a row.
type Place = Option<(u32, u32, i64)>;

impl LongColumns {
    /// Takes the rows of one set of columns; those without place or position are passed over.
    ///
    /// # Errors
    /// As [`crate::read_log`].
    fn take(
        &mut self,
        table: &Table,
        mapping: &TableMapping,
        c: &Columns,
        places: &[Place],
    ) -> Result<(), IngestError> {
        let length = mapping.units.length.metres();
        let speed = mapping.units.speed.metres_per_second();
        let column = |name: &Option<String>, unit| table.scaled(name.as_ref(), unit);
        let lead_ids = match &c.lead_id {
            Some(name) if table.has(name) => {
                Some(leads(table, name, &mut self.ids, self.vehicles)?)
            }
            _ => None,
        };
        let x = column(&c.x, length)?;
        let y = column(&c.y, length)?;
        let lane = column(&c.lane, 1.0)?;
        let (speed_x, speed_y) = (column(&c.speed_x, speed)?, column(&c.speed_y, speed)?);
        let speeds = column(&c.speed, speed)?;
        let angle = mapping.units.angle;
        let yaw = column(&c.heading, 1.0)?;
        let yaw = yaw.map(|yaw| yaw.into_iter().map(|a| angle.radians(a)).collect());
        let (long, wide) = (column(&c.length, length)?, column(&c.width, length)?);
        let ahead = column(&c.centre_ahead, length)?;
        let (gap, lead_x) = (column(&c.gap, length)?, column(&c.lead_x, length)?);
        let lead_speed = column(&c.lead_speed, speed)?;
        let lead_length = column(&c.lead_length, length)?;
        let (along, turned) = match mapping.forward {
            Forward::AlongX => (1.0, 0.0),
            Forward::AgainstX => (-1.0, std::f64::consts::PI),
        };
        // A row without the y or the lane that its table has stands nowhere.
        let by_lane = y.is_none() && lane.is_some();

        let at =
            |column: &Option<Vec<f64>>, row: usize| column.as_ref().map_or(f64::NAN, |c| c[row]);
        for (row, place) in places.iter().enumerate() {
            let &Some((group, id, stamp_ns)) = place else {
                continue;
            };
            let (vx, vy) = (at(&speed_x, row), at(&speed_y, row));
            let across = if vy.is_nan() { 0.0 } else { vy };
            let v = at(&speeds, row);
            let found = LongRow {
                group,
                id,
                stamp_ns,
                x_m: along * at(&x, row),
                // Without a y everybody is on one line, until lanes say otherwise.
                y_m: y.as_ref().map_or(0.0, |y| along * y[row]),
                lane: at(&lane, row),
                speed_mps: if v.is_nan() {
                    libm::hypot(vx, across)
                } else {
                    v
                },
                speed_x_mps: along * vx,
                yaw_rad: at(&yaw, row) + turned,
                length_m: at(&long, row),
                width_m: at(&wide, row),
                centre_ahead_m: at(&ahead, row),
                lead_id: lead_ids.as_ref().and_then(|l| l[row]),
                gap_m: at(&gap, row),
                lead_x_m: along * at(&lead_x, row),
                lead_speed_mps: at(&lead_speed, row),
                lead_length_m: at(&lead_length, row),
            };
            if found.x_m.is_finite()
                && found.y_m.is_finite()
                && (!by_lane || found.lane.is_finite())
            {
                self.rows.push(found);
            }
        }
        Ok(())
    }
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

/// Leaders as places among the vehicles' names, which are sorted; beyond them those that have no rows of their own, added here. 0
/// and -1 are none where no vehicle is called so: some tables count from 0.
fn leads(
    table: &Table,
    name: &str,
    ids: &mut Vec<String>,
    vehicles: usize,
) -> Result<Vec<Option<u32>>, IngestError> {
    let (codes, names) = table.codes(name)?;
    let mut place = |name: String| {
        let known = ids[..vehicles].binary_search(&name).ok();
        let known =
            known.or_else(|| Some(vehicles + ids[vehicles..].iter().position(|n| *n == name)?));
        if known.is_none() && !matches!(name.as_str(), "0" | "-1") {
            ids.push(name);
            return Some(ids.len() as u32 - 1);
        }
        known.map(|k| k as u32)
    };
    let places: Vec<Option<u32>> = names.into_iter().map(&mut place).collect();
    let placed = codes.iter().map(|c| c.and_then(|c| places[c as usize]));
    Ok(placed.collect())
}
