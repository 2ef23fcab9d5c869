//! Whether somebody passes a vehicle or stays behind it.

use super::{
    family::{Family, Outcome},
    free_speed,
    head::{BESIDE, Event, Head},
};
use maveric_domain::{Drive, drive::Direction};

/// Time gap within which somebody is behind a vehicle, in s.
const BEHIND_S: f64 = 4.0;
/// Time behind it after which not having passed is a choice, in s.
const STAYED_S: f64 = 40.0;

pub(super) const HEAD: Head = Head {
    name: "pass",
    title: "Passes rather than follows",
    unit: "1",
    family: Family::Logistic,
    left_open: BESIDE,
    reads: &["own free speed minus the vehicle's, m/s"],
    events,
};

/// The encounter under way.
#[derive(Clone)]
struct Behind {
    vehicle: Option<u32>,
    speeds: Vec<f64>,
    first_row: usize,
}

/// Vehicles that ego came up to: those it moved out to pass, and those it stayed behind.
fn events(drive: &Drive) -> Vec<Event> {
    // Nobody passes whom the rig does not see beside and behind: who leaves the view ahead was not passed.
    if !drive.sees().passing() {
        return Vec::new();
    }
    let Some(free_mps) = free_speed::own_mps(drive) else {
        return Vec::new();
    };
    let rows = drive.rows();
    let event = |row: usize, lead_mps: f64, done: f64| {
        Event::at(drive, row, vec![free_mps - lead_mps], Outcome::Value(done))
    };
    let mut starts = drive.lane_changes();
    starts.retain(|c| c.direction == Direction::Left && drive.lead_ahead(c.start));
    let mut events = Vec::new();
    let mut behind: Option<Behind> = None;
    let stayed = |b: &Behind| {
        let long = b.speeds.len() as f64 / drive.rate_hz() >= STAYED_S;
        let mut speeds = b.speeds.clone();
        speeds.sort_by(f64::total_cmp);
        long.then(|| event(b.first_row, speeds[speeds.len() / 2], 0.0))
    };
    for row in 0..drive.len() {
        if starts.iter().any(|c| c.start == row) {
            events.push(event(row, rows.lead_speed_mps[row], 1.0));
            behind = None;
            continue;
        }
        let near = rows.changing[row] == 0
            && drive.lead_ahead(row)
            && drive.time_gap_s(row).is_some_and(|g| g < BEHIND_S);
        let same = behind.as_ref().is_some_and(|b| b.vehicle == rows.lead_id[row]);
        if rows.lead_present[row] && !same {
            events.extend(behind.take().as_ref().and_then(stayed));
        }
        if near {
            let speed = rows.lead_speed_mps[row];
            match &mut behind {
                Some(b) => b.speeds.push(speed),
                None => {
                    behind = Some(Behind {
                        vehicle: rows.lead_id[row],
                        speeds: vec![speed],
                        first_row: row,
                    });
                }
            }
        }
    }
    events.extend(behind.as_ref().and_then(stayed));
    events
}
