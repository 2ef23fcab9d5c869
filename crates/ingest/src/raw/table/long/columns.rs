//! The columns of a long table, in SI units.

use super::super::{
    TableLog,
    ids::numbered,
    open::{Kind, Table},
    parts::stamps,
    time::Clock,
};
use crate::{
    error::IngestError,
    mapping::{Long, LongColumns, TableMapping},
};

/// One row, in SI units and the table's own frame; NaN stands for an empty cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct LongRow {
    pub(super) group: u32,
    pub(super) id: u32,
    /// Number of its row in the table.
    pub(super) nth: u32,
    pub(super) stamp_ns: i64,
    pub(super) x_m: f64,
    pub(super) y_m: f64,
    pub(super) lane: f64,
    /// As the table says it.
    pub(super) offset: f64,
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
pub(super) struct LongTable {
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
pub(super) fn read_rows(
    log: &mut TableLog<'_>,
    long: &Long,
    clock: Clock<'_>,
) -> Result<LongTable, IngestError> {
    let (mapping, c) = (log.mapping, &long.columns);
    // Names of vehicles that have columns of their own.
    let mut wide: Option<Vec<String>> = None;
    if let Some((before, behind)) = c.around_id() {
        let ids = wide.insert(Vec::new());
        for (path, bytes) in &log.files {
            let names = Table::names(path, bytes, mapping.into(), &c.time)?;
            let id =
                |name: &String| Some(name.strip_prefix(before)?.strip_suffix(behind)?.to_owned());
            ids.extend(names.iter().filter_map(id).filter(|id| !id.is_empty()));
        }
        ids.sort();
        ids.dedup();
    }
    // Without any the error names the column that is wanted.
    let ids = wide
        .clone()
        .filter(|ids| !ids.is_empty())
        .unwrap_or_else(|| vec![LongColumns::ID.to_owned()]);
    let given = mapping.layout.columns();
    let named = ids.iter().flat_map(|id| {
        given.iter().map(move |(key, name)| (key, LongColumns::of_vehicle(name, id)))
    });
    let named: Vec<(&String, String)> = named.filter(|(key, _)| *key != "time").collect();
    let mut wanted = vec![(c.time.as_str(), clock.kind())];
    wanted.extend(named.iter().map(|(key, name)| {
        let word = ["id", "groups", "lead_id"].contains(&key.as_str());
        (name.as_str(), if word { Kind::Word } else { Kind::Number })
    }));
    let table = log.open(&wanted)?;
    let stamp_ns = stamps(&table, &c.time, clock)?;
    let (group_codes, groups) = groups(&table, &c.groups)?;
    let mut long_table = LongTable {
        rows: Vec::with_capacity(table.rows() * ids.len()),
        ids: Vec::new(),
        groups,
        vehicles: 0,
        left_out: 0,
    };
    if let Some(groups) = wide {
        let (ids, vehicles) = wide_ids(&table, c, &groups)?;
        (long_table.vehicles, long_table.ids) = (ids.len(), ids);
        for (ids, name) in vehicles.iter().zip(&groups) {
            let places = stamp_ns.iter().zip(&group_codes).zip(ids);
            let places: Vec<Place> =
                places.map(|((ns, group), id)| Some(((*group)?, (*id)?, (*ns)?))).collect();
            // Where its columns are empty the vehicle is not there.
            long_table.take(&table, mapping, long, name, &places)?;
        }
        long_table.left_out = stamp_ns.iter().filter(|ns| ns.is_none()).count();
    } else if let Some(id) = &c.id {
        let (codes, ids) = table.codes(id)?;
        (long_table.vehicles, long_table.ids) = (ids.len(), ids);
        let places = codes.iter().zip(&stamp_ns).zip(&group_codes);
        let places: Vec<Place> =
            places.map(|((id, ns), group)| Some(((*group)?, (*id)?, (*ns)?))).collect();
        long_table.take(&table, mapping, long, "", &places)?;
        long_table.left_out = table.rows() - long_table.rows.len();
    }
    Ok(long_table)
}

/// The names of vehicles, and for each group of columns the place of the name that each row holds.
type WideIds = (Vec<String>, Vec<Vec<Option<u32>>>);

/// Returns the names of vehicles that have columns of their own, sorted, and for each group of columns the place of the name that
/// each row holds: that of `id`, else the group's own.
fn wide_ids(
    table: &Table,
    columns: &LongColumns,
    groups: &[String],
) -> Result<WideIds, IngestError> {
    let Some(id) = &columns.id else {
        let places = (0..).zip(groups).map(|(id, _)| vec![Some(id); table.rows()]).collect();
        return Ok((groups.to_vec(), places));
    };
    let mut words = Vec::new();
    for group in groups {
        words.push(table.words(&LongColumns::of_vehicle(id, group))?);
    }
    let names = numbered(words.iter().flatten().flatten().map(String::as_str));
    let place = |word: &Option<String>| word.as_deref().map(|word| names[word]);
    let places = words.iter().map(|words| words.iter().map(place).collect()).collect();
    Ok((names.keys().map(|name| (*name).to_owned()).collect(), places))
}

/// Group, vehicle and time of a row.
type Place = Option<(u32, u32, i64)>;

impl LongTable {
    /// Takes the rows of the columns of `vehicle`, or of all; those without place or position are passed over.
    fn take(
        &mut self,
        table: &Table,
        mapping: &TableMapping,
        long: &Long,
        vehicle: &str,
        places: &[Place],
    ) -> Result<(), IngestError> {
        let length = mapping.units.length.metres();
        let speed = mapping.units.speed.metres_per_second();
        let c = &long.columns;
        let named = |name: &String| LongColumns::of_vehicle(name, vehicle);
        let column =
            |name: &Option<String>, unit| table.scaled(name.as_ref().map(named).as_ref(), unit);
        let lead_ids = match c.lead_id.as_ref().map(named) {
            Some(name) if table.has(&name) => {
                Some(leads(table, &name, &mut self.ids, self.vehicles)?)
            }
            _ => None,
        };
        let x = table.times(&named(&c.x), length)?;
        let y = column(&c.y, length)?;
        let (lane, offset) = (column(&c.lane, 1.0)?, column(&c.offset, 1.0)?);
        let (speed_x, speed_y) = (column(&c.speed_x, speed)?, column(&c.speed_y, speed)?);
        let speeds = column(&c.speed, speed)?;
        let angle = mapping.units.angle;
        let yaw = column(&c.heading, 1.0)?;
        let yaw = yaw.map(|yaw| yaw.into_iter().map(|a| angle.radians(a)).collect());
        let (lengths, widths) = (column(&c.length, length)?, column(&c.width, length)?);
        let ahead = column(&c.centre_ahead, length)?;
        let (gap, lead_x) = (column(&c.gap, length)?, column(&c.lead_x, length)?);
        let lead_speed = column(&c.lead_speed, speed)?;
        let lead_length = column(&c.lead_length, length)?;
        let along = long.forward.sign();
        let turned = if along < 0.0 { std::f64::consts::PI } else { 0.0 };
        // A row without the y or the lane that its table has stands nowhere.
        let by_lane = y.is_none() && lane.is_some();

        let cell =
            |column: &Option<Vec<f64>>, row: usize| column.as_ref().map_or(f64::NAN, |c| c[row]);
        for (row, place) in places.iter().enumerate() {
            let &Some((group, id, stamp_ns)) = place else {
                continue;
            };
            let (vx, vy) = (cell(&speed_x, row), cell(&speed_y, row));
            let across = if vy.is_nan() { 0.0 } else { vy };
            let v = cell(&speeds, row);
            let long_row = LongRow {
                group,
                id,
                nth: row as u32,
                stamp_ns,
                x_m: along * x[row],
                // Without a y everybody is on one line, until lanes say otherwise.
                y_m: y.as_ref().map_or(0.0, |y| along * y[row]),
                lane: cell(&lane, row),
                offset: cell(&offset, row),
                speed_mps: if v.is_nan() { libm::hypot(vx, across) } else { v },
                speed_x_mps: along * vx,
                yaw_rad: cell(&yaw, row) + turned,
                length_m: cell(&lengths, row),
                width_m: cell(&widths, row),
                centre_ahead_m: cell(&ahead, row),
                lead_id: lead_ids.as_ref().and_then(|l| l[row]),
                gap_m: cell(&gap, row),
                lead_x_m: along * cell(&lead_x, row),
                lead_speed_mps: cell(&lead_speed, row),
                lead_length_m: cell(&lead_length, row),
            };
            if long_row.x_m.is_finite()
                && long_row.y_m.is_finite()
                && (!by_lane || long_row.lane.is_finite())
                && (offset.is_none() || long_row.offset.is_finite())
            {
                self.rows.push(long_row);
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
    let numbers = numbered((0..table.rows()).filter_map(key));
    let value = |key: &Vec<u32>| -> Vec<String> {
        let named = key.iter().zip(&parts).map(|(&code, (_, names))| names[code as usize].clone());
        named.collect()
    };
    let groups = Groups { columns: columns.to_vec(), values: numbers.keys().map(value).collect() };
    let codes = (0..table.rows()).map(|row| key(row).map(|k| numbers[&k])).collect();
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
