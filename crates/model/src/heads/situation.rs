//! Stretches of a drive in which something that a head reads goes on.

use maveric_domain::Drive;
use std::ops::Range;

/// Ego speed below which a gap is no time gap, in m/s.
pub(super) const STANDSTILL_MPS: f64 = 0.5;

/// Whether the reference vehicle is ahead in ego's own lane at `row`.
pub(super) fn lead_ahead(drive: &Drive, row: usize) -> bool {
    let rows = drive.rows();
    rows.lead_present[row]
        && rows.lead_dx_m[row] > 0.0
        && rows.lead_dy_m[row].abs() < 0.5 * drive.road().lane_width_m
}

/// Whether ego is beside or in front of a reference vehicle in the lane to the right.
pub(super) fn passing(drive: &Drive, row: usize) -> bool {
    let rows = drive.rows();
    rows.lead_present[row] && rows.lead_dy_m[row] < -0.5 * drive.road().lane_width_m
}

/// Gap ahead over ego speed, in s; none at standstill.
pub(super) fn time_gap_s(drive: &Drive, row: usize) -> Option<f64> {
    let rows = drive.rows();
    let speed = rows.ego_speed_mps[row];
    (speed > STANDSTILL_MPS).then(|| rows.lead_dx_m[row] / speed)
}

/// Runs of rows of one segment and one reference vehicle for which `holds`, their first `settle_s` seconds left out, cut into
/// blocks of `block_s`; what is left of a run is a block of its own from half that length on.
///
/// Neighbouring rows say the same thing again: a block is what counts once.
pub(super) fn blocks(
    drive: &Drive,
    settle_s: f64,
    block_s: f64,
    holds: impl Fn(usize) -> bool,
) -> Vec<Range<usize>> {
    let rows = drive.rows();
    let same = |row: usize| {
        rows.segment[row] == rows.segment[row - 1] && rows.lead_id[row] == rows.lead_id[row - 1]
    };
    let samples = |seconds: f64| ((seconds * drive.rate_hz()).round() as usize).max(1);
    let (settle, block) = (samples(settle_s), samples(block_s));
    let mut found = Vec::new();
    let mut start = 0;
    while start < drive.len() {
        if !holds(start) {
            start += 1;
            continue;
        }
        let mut end = start + 1;
        while end < drive.len() && holds(end) && same(end) {
            end += 1;
        }
        let mut from = start + settle;
        while from < end && 2 * (end - from) >= block {
            let to = (from + block).min(end);
            found.push(from..to);
            from = to;
        }
        start = end;
    }
    found
}

/// Mean of a column over some rows.
pub(super) fn mean(column: &[f64], rows: &Range<usize>) -> f64 {
    column[rows.clone()].iter().sum::<f64>() / rows.len() as f64
}
