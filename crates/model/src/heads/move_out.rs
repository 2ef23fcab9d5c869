//! The time gap at which somebody moves out to pass.

use super::{
    family::{Family, Outcome},
    head::{CARRIED, Event, Head},
};
use maveric_domain::{Drive, drive::Direction};

/// Whoever has followed this long before moving out was kept from it, in s.
const FOLLOWED_S: f64 = 2.0;

pub(super) const HEAD: Head = Head {
    name: "move_out_s",
    title: "Time gap when moving out",
    unit: "s",
    family: Family::LogNormal,
    left_open: CARRIED,
    reads: &[],
    events,
};

/// Moves out behind a vehicle; one made while still following it says only that the gap wanted is at least that long.
fn events(drive: &Drive) -> Vec<Event> {
    if !drive.sees().ahead {
        return Vec::new();
    }
    let rows = drive.rows();
    let back = (FOLLOWED_S * drive.rate_hz()).round() as usize;
    let followed = |start: usize| {
        let before = start.saturating_sub(back)..start;
        before.len() == back && before.into_iter().all(|row| rows.following[row])
    };
    let event = |change: &maveric_domain::LaneChange| {
        let start = change.start;
        if change.direction != Direction::Left || !drive.lead_ahead(start) {
            return None;
        }
        let gap_s = drive.time_gap_s(start).filter(|g| *g > 0.0)?;
        let outcome = if followed(start) { Outcome::AtLeast(gap_s) } else { Outcome::Value(gap_s) };
        Some(Event::at(drive, start, Vec::new(), outcome))
    };
    drive.lane_changes().iter().filter_map(event).collect()
}
