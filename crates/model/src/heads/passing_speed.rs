//! How much faster than the vehicle beside it somebody passes.

use super::{
    family::{Family, Outcome},
    free_speed,
    head::{BESIDE, Event, Head},
    situation::{blocks, mean, passing},
};
use maveric_domain::Drive;
use std::ops::Range;

/// Time after moving out in which the speed settles, in s.
const SETTLE_S: f64 = 2.0;
/// Length of a block, in s.
const BLOCK_S: f64 = 8.0;

pub(super) const HEAD: Head = Head {
    name: "passing_speed_mps",
    title: "Speed over the vehicle passed",
    unit: "m/s",
    family: Family::Gaussian,
    left_open: BESIDE,
    reads: &["own free speed minus the vehicle's, m/s"],
    events,
};

fn events(drive: &Drive) -> Vec<Event> {
    if !drive.sees().passing() {
        return Vec::new();
    }
    let Some(free_mps) = free_speed::own_mps(drive) else {
        return Vec::new();
    };
    let rows = drive.rows();
    let passes =
        blocks(drive, SETTLE_S, BLOCK_S, |row| passing(drive, row) && rows.changing[row] == 0);
    let event = |block: Range<usize>| {
        let lead_mps = mean(&rows.lead_speed_mps, &block);
        let over_mps = mean(&rows.ego_speed_mps, &block) - lead_mps;
        // One who drives away is not passed.
        let reads = vec![free_mps - lead_mps];
        (over_mps > 0.0).then(|| Event::at(drive, block.start, reads, Outcome::Value(over_mps)))
    };
    passes.into_iter().filter_map(event).collect()
}
