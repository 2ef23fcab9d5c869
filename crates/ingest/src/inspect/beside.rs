//! Which column of a table is a place to the side, and whether that is one in the lane.

use super::{
    columns::TableColumn,
    reader::Reader,
    words::{What, Whose},
};
use crate::{mapping::FOOT_M, raw::table::lateral::jumps};
use std::collections::BTreeMap;

/// The column of the place to the side, and whether its name says that it is one in the lane.
pub(super) fn lateral<'a>(
    reader: &Reader<'a>,
    along: Option<&'a TableColumn>,
    platoon: bool,
) -> Option<(&'a TableColumn, bool)> {
    if platoon {
        return None;
    }
    let is_along = |c: &&TableColumn| along.is_some_and(|along| along.name == c.name);
    let beside = along.and_then(|along| across(reader, along));
    let beside = beside
        .or_else(|| reader.number(Whose::Ego, What::Lateral))
        .filter(|c| !is_along(c));
    let in_lane = || reader.number(Whose::Ego, What::Offset).map(|c| (c, true));
    beside.map(|c| (c, false)).or_else(in_lane)
}

/// Widest lane, in m: a place in a lane has no greater range.
const WIDEST_M: f64 = 5.0;

/// Why a lateral column is a place in the lane: its numbers jump by a lane's width as those do, or its name says so and its range allows
/// it.
pub(super) fn place_in_lane(
    column: &TableColumn,
    named: bool,
    unit: &str,
    times_s: &[f64],
    series: &[u32],
) -> Option<String> {
    let to_m = if unit == "ft" { FOOT_M } else { 1.0 };
    let numbers = column.numbers.as_ref()?;
    let mut of_vehicle: BTreeMap<u32, (Vec<i64>, Vec<f64>)> = BTreeMap::new();
    for ((vehicle, y), t) in series.iter().zip(numbers).zip(times_s) {
        if y.is_finite() && t.is_finite() {
            let (times_ns, places_m) = of_vehicle.entry(*vehicle).or_default();
            times_ns.push((t * 1e9) as i64);
            places_m.push(y * to_m);
        }
    }
    let jumps = of_vehicle
        .values()
        .map(|(times_ns, places_m)| jumps(times_ns, places_m).len())
        .sum::<usize>();
    let name = &column.name;
    if jumps > 0 {
        return Some(format!(
            "`{name}` jumps by a lane's width {jumps} times while the vehicle goes on the way it went: it is a place in the lane"
        ));
    }
    let range_m = column
        .range()
        .map_or(0.0, |(least, most)| (most - least) * to_m);
    (named && range_m <= WIDEST_M)
        .then(|| format!("the name of `{name}` says that it is a place in the lane"))
}

/// The position across the road: the other one.
fn across<'a>(reader: &Reader<'a>, along: &TableColumn) -> Option<&'a TableColumn> {
    let swapped: String = along
        .name
        .chars()
        .map(|c| match c {
            'x' => 'y',
            'y' => 'x',
            'X' => 'Y',
            'Y' => 'X',
            c => c,
        })
        .collect();
    reader
        .all(Whose::Ego, What::Position)
        .find(|c| c.name == swapped && c.name != along.name)
}
