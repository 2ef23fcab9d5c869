//! Stretches of a drive in which something that a head reads goes on.

use maveric_domain::Drive;
use std::ops::Range;

/// Whether ego is beside or in front of a reference vehicle in the lane to the right.
pub(super) fn passing(drive: &Drive, row: usize) -> bool {
    let rows = drive.rows();
    rows.lead_present[row] && rows.lead_dy_m[row] < -0.5 * drive.road().lane_width_m
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
    let mut blocks = Vec::new();
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
            blocks.push(from..to);
            from = to;
        }
        start = end;
    }
    blocks
}

/// Mean of a column over some rows.
pub(super) fn mean(column: &[f64], rows: &Range<usize>) -> f64 {
    column[rows.clone()].iter().sum::<f64>() / rows.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{DriveMeta, DrivenBy, EgoTrack, Recording, Road};

    /// Ten seconds at 20 Hz with a hole of two seconds before row 150.
    fn drive() -> Drive {
        let time_s = (0..200).map(|i| f64::from(i) / 20.0 + if i < 150 { 0.0 } else { 2.0 });
        let time_s: Vec<f64> = time_s.collect();
        let ego = EgoTrack {
            length_m: 4.8,
            x_m: time_s.iter().map(|t| 20.0 * t).collect(),
            y_m: vec![0.0; 200],
            speed_mps: vec![20.0; 200],
        };
        let segment = (0..200).map(|i| u32::from(i >= 150)).collect();
        let recording = Recording::new(Road::PAPER, 20.0, time_s, segment, ego, Vec::new());
        let meta = DriveMeta::named("P01-baseline", "P01", "baseline", DrivenBy::Human).unwrap();
        Drive::from_recording(meta, &recording.unwrap()).unwrap()
    }

    #[test]
    fn runs_are_cut_into_blocks_behind_what_settles_and_half_a_block_is_one() {
        let drive = drive();
        let of = |settle_s, block_s, holds: &dyn Fn(usize) -> bool| {
            blocks(&drive, settle_s, block_s, holds)
        };
        let some = |row: usize| (20..100).contains(&row) || row >= 120;
        // Of 80 rows 20 settle, and 40 and 20 are left; of 30 before the hole 10; of 50 behind it 30.
        assert_eq!(of(1.0, 2.0, &some), [40..80, 80..100, 170..200]);
        // One more to settle, and 19 rows are no half of a block.
        assert_eq!(of(1.05, 2.0, &some), [41..81, 171..200]);
        assert_eq!(of(2.5, 1.0, &some), [70..90, 90..100]);
        assert_eq!(of(0.0, 10.0, &|row| row == 7), [0..0; 0]);
        assert_eq!(of(0.0, 0.0, &|row| (7..10).contains(&row)), [8..9, 9..10]);
        assert!(of(1.0, 1.0, &|_| false).is_empty());
    }
}
