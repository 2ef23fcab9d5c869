//! The time gap left to whoever was passed when merging back.

use super::{
    family::{Family, Outcome},
    head::{CARRIED, Event, Head},
    situation::STANDSTILL_MPS,
};
use maveric_domain::{Drive, drive::Direction};

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
    let rows = drive.rows();
    let event = |change: &maveric_domain::LaneChange| {
        let speed = rows.ego_speed_mps[change.start];
        if change.direction != Direction::Right || speed <= STANDSTILL_MPS {
            return None;
        }
        let gap_s = change.gap_behind_m? / speed;
        (gap_s > 0.0).then(|| Event {
            time_s: rows.time_s[change.start] - rows.time_s[0],
            reads: Vec::new(),
            outcome: Outcome::Value(gap_s),
        })
    };
    drive.lane_changes().iter().filter_map(event).collect()
}
