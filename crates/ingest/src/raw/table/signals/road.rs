//! The road along a drive: what holds for most of it.

use super::{
    super::{lane::Lanes, open::Kind},
    rows::{Files, SignalRows},
};
use crate::{
    error::IngestError,
    mapping::{RoadMapping, RoadSignal, TableMapping},
    quality::{Warning, WarningKind},
};

/// Values of which the shares are told.
const MOST_TOLD: usize = 4;

/// The road of a drive.
#[derive(Debug, Default)]
pub(super) struct RoadAlong {
    /// In m/s, where it is told.
    pub(super) posted_speed_mps: Option<f64>,
    pub(super) lanes: Option<u8>,
    /// At which times ego was thought to be in which lane, 0 the right one.
    pub(super) lane: Vec<(i64, i64)>,
}

/// Reads what a signal says of the road.
///
/// # Errors
/// As [`Files::rows`]; [`IngestError::BadCell`] for a posted speed or a number of lanes that no road has.
pub(super) fn read(
    files: &mut Files<'_>,
    signal: &RoadSignal,
    mapping: &TableMapping,
    otherwise: &RoadMapping,
    warnings: &mut Vec<Warning>,
) -> Result<RoadAlong, IngestError> {
    let columns = [&signal.posted_speed, &signal.lanes, &signal.lane];
    let columns = columns.into_iter().flatten();
    let columns: Vec<(&str, Kind)> = columns.map(|c| (c.as_str(), Kind::Number)).collect();
    let rows = files.rows(&signal.file, &signal.time, &columns, None)?;
    rows.report(warnings);
    let mut road = RoadAlong::default();
    if let Some(name) = &signal.posted_speed {
        let unit = mapping.units.speed.metres_per_second();
        let expected = "a posted speed above 0; a number that stands for none belongs to `missing` of `table.signals.road`";
        let values = checked(&rows, name, &signal.missing, unit, expected, |v| v > 0.0)?;
        let shares = shares(&rows, &values);
        road.posted_speed_mps = shares.first().map(|s| s.0);
        let label = |v: f64| format!("{v:.2} m/s");
        let stands_in = label(otherwise.posted_speed_mps);
        warnings.extend(choice(&rows, "posted speed", &shares, label, &stands_in));
    }
    let whole = |v: f64| (1.0..=255.0).contains(&v) && v.fract().abs() < 1e-9;
    if let Some(name) = &signal.lanes {
        let expected = "a number of lanes from 1 to 255; a number that stands for none belongs to `missing` of `table.signals.road`";
        let values = checked(&rows, name, &signal.missing, 1.0, expected, whole)?;
        let shares = shares(&rows, &values);
        road.lanes = shares.first().map(|s| s.0 as u8);
        let label = |v: f64| format!("{v:.0}");
        let stands_in = label(f64::from(otherwise.lanes));
        warnings.extend(choice(&rows, "number of lanes", &shares, label, &stands_in));
    }
    if let Some(name) = &signal.lane {
        let lanes = road.lanes.unwrap_or(otherwise.lanes);
        let lanes = Lanes::new(
            mapping,
            &RoadMapping {
                lanes,
                ..*otherwise
            },
            None,
        );
        let values = rows.numbers(name, &signal.missing, 1.0)?;
        let known = rows.stamp_ns.iter().zip(values);
        let lane = |v: f64| lanes.counted_from_right(v);
        road.lane = known.filter_map(|(t, v)| Some((*t, lane(v?)))).collect();
    }
    Ok(road)
}

/// A column of which every number has to be possible.
fn checked(
    rows: &SignalRows,
    name: &str,
    missing: &[f64],
    unit: f64,
    expected: &str,
    is_possible: impl Fn(f64) -> bool,
) -> Result<Vec<Option<f64>>, IngestError> {
    let values = rows.numbers(name, missing, unit)?;
    let bad = |v: &Option<f64>| v.is_some_and(|v| !is_possible(v));
    match values.iter().position(bad) {
        None => Ok(values),
        Some(nth) => {
            let cell = values[nth].map_or(String::new(), |v| (v / unit).to_string());
            Err(rows.bad_cell(nth, name, cell, expected))
        }
    }
}

/// Each value with the share of the known time for which it held, the largest share first.
fn shares(rows: &SignalRows, values: &[Option<f64>]) -> Vec<(f64, f64)> {
    let mut shares: Vec<(f64, f64)> = Vec::new();
    for (nth, value) in values.iter().enumerate() {
        let Some(value) = value else { continue };
        let next = rows.stamp_ns.get(nth + 1);
        // The last row, or the only one, stands for a moment.
        let held = next.map_or(1, |next| (next - rows.stamp_ns[nth]).max(1)) as f64;
        match shares.iter_mut().find(|(v, _)| (v - value).abs() < 1e-9) {
            Some((_, time)) => *time += held,
            None => shares.push((*value, held)),
        }
    }
    let sum: f64 = shares.iter().map(|f| f.1).sum();
    for share in &mut shares {
        share.1 /= sum;
    }
    shares.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.total_cmp(&b.0)));
    shares
}

/// What is told of a value that changes along the drive, or that nobody knows.
fn choice(
    rows: &SignalRows,
    of: &str,
    shares: &[(f64, f64)],
    label: impl Fn(f64) -> String,
    stands_in: &str,
) -> Option<Warning> {
    let percent = |s: &(f64, f64)| format!("{} over {:.0} %", label(s.0), 100.0 * s.1);
    match shares {
        [] => {
            let what = format!("no row says the {of}: {stands_in} stands in");
            Some(Warning::new(&rows.path, WarningKind::Default, 1, what))
        }
        [_] => None,
        [first, others @ ..] => {
            let others: Vec<String> = others.iter().take(MOST_TOLD).map(percent).collect();
            let what = format!(
                "the {of} changes along the drive: {} of its time is taken for all of it; the others are {}",
                percent(first),
                others.join(", ")
            );
            Some(Warning::new(&rows.path, WarningKind::Choice, 1, what))
        }
    }
}
