//! The speed on a road without anybody ahead.

use super::{
    family::{Family, Outcome},
    head::{CARRIED, Event, Head},
    situation::{blocks, mean},
};
use maveric_domain::Drive;
use std::ops::Range;

/// Time after which the speed that a drive starts with no longer counts, in s.
const FROM_S: f64 = 10.0;
/// Time to come back to the own speed after a vehicle ahead, or after a pass, in s.
const SETTLE_S: f64 = 5.0;
/// Length of a block, in s: speed wanders over some 20 s.
const BLOCK_S: f64 = 20.0;

pub(super) const HEAD: Head = Head {
    name: "free_speed_mps",
    title: "Free speed",
    unit: "m/s",
    family: Family::Gaussian,
    left_open: CARRIED,
    reads: &[],
    events,
};

/// Blocks of driving in lane without anybody ahead.
fn free(drive: &Drive) -> Vec<Range<usize>> {
    blocks(drive, SETTLE_S, BLOCK_S, |row| on_free_road(drive, row))
}

/// Whether the driver keeps the right lane at `row` with nobody ahead, and not at the speed that the drive started with. Where nobody
/// looked ahead, nobody knows.
pub(super) fn on_free_road(drive: &Drive, row: usize) -> bool {
    let rows = drive.rows();
    drive.sees().ahead
        && rows.time_s[row] >= rows.time_s[0] + FROM_S
        && !rows.lead_present[row]
        && rows.lane[row] == 0
        && rows.changing[row] == 0
}

/// The driver's own mean free speed, in m/s; none without free road.
pub(super) fn own_mps(drive: &Drive) -> Option<f64> {
    let blocks = free(drive);
    let means = blocks.iter().map(|b| mean(&drive.rows().ego_speed_mps, b));
    (!blocks.is_empty()).then(|| means.sum::<f64>() / blocks.len() as f64)
}

fn events(drive: &Drive) -> Vec<Event> {
    let event = |block: Range<usize>| {
        let speed_mps = mean(&drive.rows().ego_speed_mps, &block);
        Event::at(drive, block.start, Vec::new(), Outcome::Value(speed_mps))
    };
    free(drive).into_iter().map(event).collect()
}
