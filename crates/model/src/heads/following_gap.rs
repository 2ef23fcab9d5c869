//! The time gap kept behind somebody.

use super::{
    family::{Family, Outcome},
    free_speed,
    head::{BESIDE, Event, Head},
    situation::{blocks, mean},
};
use maveric_domain::Drive;

/// Time in which the gap settles, in s.
const SETTLE_S: f64 = 3.0;
/// Length of a block, in s.
const BLOCK_S: f64 = 8.0;
/// Shortest time gap that counts, in s: a logarithm has to exist.
const SHORTEST_S: f64 = 0.1;

pub(super) const HEAD: Head = Head {
    name: "following_gap_s",
    title: "Time gap while following",
    unit: "s",
    family: Family::LogNormal,
    left_open: BESIDE,
    reads: &["logarithm of how much slower than the own free speed the vehicle is, m/s"],
    events,
};

/// What is read of a vehicle: people keep less behind one that holds them up. Below 0.5 m/s it does not.
pub(crate) fn held_up(free_mps: f64, lead_mps: f64) -> f64 {
    libm::log((free_mps - lead_mps).max(0.5))
}

fn events(drive: &Drive) -> Vec<Event> {
    // Without free road in the drive, the speed that is posted stands for the own.
    let free_mps = free_speed::own_mps(drive).unwrap_or(drive.road().posted_speed_mps);
    let rows = drive.rows();
    let followed =
        blocks(drive, SETTLE_S, BLOCK_S, |row| drive.sees().ahead && rows.following[row]);
    let event = |block: std::ops::Range<usize>| {
        let gap_s = mean(&rows.lead_dx_m, &block) / mean(&rows.ego_speed_mps, &block);
        let reads = vec![held_up(free_mps, mean(&rows.lead_speed_mps, &block))];
        (gap_s > SHORTEST_S).then(|| Event::at(drive, block.start, reads, Outcome::Value(gap_s)))
    };
    followed.into_iter().filter_map(event).collect()
}
