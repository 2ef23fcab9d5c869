//! The time gap left to whoever was passed when merging back.

use super::{
    family::{Family, Outcome},
    head::{CARRIED, Event, Head},
};
use maveric_domain::{
    Drive, LaneChange,
    drive::{Direction, STANDSTILL_MPS},
};

pub(super) const HEAD: Head = Head {
    name: "merge_back_s",
    title: "Time gap when merging back",
    unit: "s",
    family: Family::LogNormal,
    left_open: CARRIED,
    reads: &[],
    events,
};

fn events(drive: &Drive) -> Vec<Event> {
    // A rig that does not look back does not see who was passed.
    if !drive.sees().passing() {
        return Vec::new();
    }
    let event = |change: &LaneChange| {
        let speed = drive.rows().ego_speed_mps[change.start];
        if change.direction != Direction::Right || speed <= STANDSTILL_MPS {
            return None;
        }
        let gap_s = change.gap_behind_m? / speed;
        (gap_s > 0.0).then(|| Event::at(drive, change.start, Vec::new(), Outcome::Value(gap_s)))
    };
    drive.lane_changes().iter().filter_map(event).collect()
}
