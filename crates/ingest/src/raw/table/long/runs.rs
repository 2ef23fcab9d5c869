//! Several runs over the same times in one long table.

use super::columns::LongRow;
use crate::{
    clock::{SET_BACK_NS, runs},
    error::IngestError,
    quality::{Warning, WarningKind},
    raw::{EgoSample, EgoSamples},
};
use std::{collections::BTreeMap, path::Path};

/// Puts each run over times that are in the table already behind the run before it, `hole_ns` apart.
///
/// Rows are those of the file, of any order. The clock of all vehicles of a group is set back together.
///
/// # Errors
/// [`IngestError::BadTable`] if one vehicle has several runs, and the order of rows does not show which rows of others belong to
/// which of them.
pub(super) fn separate(
    path: &Path,
    rows: &mut [LongRow],
    ids: &[String],
    hole_ns: i64,
) -> Result<Option<Warning>, IngestError> {
    if !any_clock_goes_back(rows) {
        return Ok(None);
    }
    let mut groups: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (place, row) in rows.iter().enumerate() {
        groups.entry(row.group).or_default().push(place);
    }
    let mut spans = Vec::new();
    for places in groups.values_mut() {
        places.sort_by_key(|&place| rows[place].nth);
        let of_vehicles = runs_of_vehicles(rows, places);
        let Some((&id, _)) = of_vehicles.first_key_value() else {
            continue;
        };
        let starts = set_back(rows, places);
        let most = of_vehicles.values().map(Vec::len).max().unwrap_or(0);
        let is_at_start =
            |&(before, from): &(u32, u32)| starts.iter().any(|s| before < *s && *s <= from);
        if starts.len() != most || !of_vehicles.values().flatten().all(is_at_start) {
            let name = ids.get(id as usize).map_or("", String::as_str);
            let what = format!(
                "vehicle {name} has rows twice over the same times, and the order of rows does not show which rows of others belong to \
                 which of its runs: name a column that tells the runs apart in `groups`"
            );
            return Err(IngestError::bad_table(path, what));
        }
        spans.extend(lay_behind(rows, places, &starts, hole_ns));
    }
    let what = "the clock was set back over times that are recorded already: what follows is laid behind the rest, after a hole of no known length";
    Ok((!spans.is_empty()).then(|| {
        Warning::new(path, WarningKind::ClockRestart, spans.len(), what).with_spans(spans)
    }))
}

/// Whether the clock of any vehicle goes back in the order of rows.
fn any_clock_goes_back(rows: &[LongRow]) -> bool {
    let mut last: BTreeMap<(u32, u32), i64> = BTreeMap::new();
    rows.iter().any(|row| {
        let before = last.insert((row.group, row.id), row.stamp_ns);
        before.is_some_and(|before| row.stamp_ns < before.saturating_sub(SET_BACK_NS))
    })
}

/// For each vehicle with several runs, the number of the last row before each run but the first, and of the run's first row.
fn runs_of_vehicles(rows: &[LongRow], places: &[usize]) -> BTreeMap<u32, Vec<(u32, u32)>> {
    let mut vehicles: BTreeMap<u32, EgoSamples> = BTreeMap::new();
    for row in places.iter().map(|&place| &rows[place]) {
        vehicles.entry(row.id).or_default().push(EgoSample {
            stamp_ns: row.stamp_ns,
            log_ns: row.stamp_ns,
            nth: row.nth,
            x_m: row.x_m,
            y_m: row.y_m,
            yaw_rad: None,
            speed_mps: None,
        });
    }
    let of_vehicle = |(id, samples): (u32, EgoSamples)| {
        let starts = runs(&samples).into_iter();
        let starts: Vec<_> = starts.map(|i| (samples.nth[i - 1], samples.nth[i])).collect();
        (!starts.is_empty()).then_some((id, starts))
    };
    vehicles.into_iter().filter_map(of_vehicle).collect()
}

/// Numbers of the rows at which the clock of a group is set back, in the order of rows.
fn set_back(rows: &[LongRow], places: &[usize]) -> Vec<u32> {
    let mut starts = Vec::new();
    let mut most = i64::MIN;
    for row in places.iter().map(|&place| &rows[place]) {
        if row.stamp_ns < most.saturating_sub(SET_BACK_NS) {
            starts.push(row.nth);
            most = row.stamp_ns;
        }
        most = most.max(row.stamp_ns);
    }
    starts
}

/// Moves the runs of a group behind each other; gives the holes between them, in s from the first.
fn lay_behind(
    rows: &mut [LongRow],
    places: &[usize],
    starts: &[u32],
    hole_ns: i64,
) -> Vec<(f64, f64)> {
    let run_of = |row: &LongRow| starts.partition_point(|start| *start <= row.nth);
    let mut spans = vec![(i64::MAX, i64::MIN); starts.len() + 1];
    for row in places.iter().map(|&place| &rows[place]) {
        let span = &mut spans[run_of(row)];
        *span = (span.0.min(row.stamp_ns), span.1.max(row.stamp_ns));
    }
    let (mut shifts, mut holes) = (vec![0_i64], Vec::new());
    let begin_ns = spans[0].0;
    let seconds = |ns: i64| ns.saturating_sub(begin_ns) as f64 / 1e9;
    for (run, pair) in spans.windows(2).enumerate() {
        let end_ns = pair[0].1.saturating_add(shifts[run]);
        let next_ns = end_ns.saturating_add(hole_ns);
        shifts.push(next_ns.saturating_sub(pair[1].0));
        holes.push((seconds(end_ns), seconds(next_ns)));
    }
    for &place in places {
        let shift_ns = shifts[run_of(&rows[place])];
        rows[place].stamp_ns = rows[place].stamp_ns.saturating_add(shift_ns);
    }
    holes
}
