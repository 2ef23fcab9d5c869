//! What the player asks of its numbers before it packs them.

use super::drive::{PlayerDrive, Track, WatchPlayer};
use crate::error::ReportError;
use crate::figures::check::Check;

/// Positions further than this from the start of the drive cannot be written down, in m.
const FURTHEST_M: f64 = 5e6;

/// Checks names, lengths and numbers.
pub(super) fn check(player: &WatchPlayer) -> Result<(), ReportError> {
    let check = Check(&player.name);
    check.name()?;
    check.at_least(1, "drives", player.drives.len())?;
    player.drives.iter().try_for_each(|drive| check_drive(&player.name, drive))
}

fn check_drive(name: &str, drive: &PlayerDrive) -> Result<(), ReportError> {
    let check = Check(name);
    let field = |what: &str| format!("{what} of drive {}", drive.label);
    let rows = drive.time_s.len();
    check.at_least(2, &field("rows"), rows)?;
    check.finite(&field("time_s"), drive.time_s.iter().copied())?;
    check.that(
        drive.time_s.windows(2).all(|w| w[1] > w[0]) && drive.time_s[0] >= 0.0,
        &field("time_s"),
        drive.time_s[0],
        "0 or later, rising from row to row",
    )?;
    let longest = 6.0 * 3600.0;
    let last = drive.time_s[rows - 1];
    check.that(last <= longest, &field("time_s"), last, "6 hours at most")?;
    check.length(&field("segment"), drive.segment.len(), rows)?;
    check.length(&field("speed_mps"), drive.speed_mps.len(), rows)?;
    check.length(&field("gap_m"), drive.gap_m.len(), rows)?;
    check.length(&field("reference"), drive.reference.len(), rows)?;
    check.length(&field("ego.x_m"), drive.ego.x_m.len(), rows)?;
    check.length(&field("ego.first_row"), drive.ego.first_row, 0)?;
    check.finite(&field("speed_mps"), drive.speed_mps.iter().copied())?;
    check.finite(&field("gap_m"), drive.gap_m.iter().flatten().copied())?;
    let lanes = f64::from(drive.lanes);
    check.that(lanes >= 1.0, &field("lanes"), lanes, "at least 1")?;
    let width = drive.lane_width_m;
    let usable = width.is_finite() && width > 0.0;
    check.that(usable, &field("lane_width_m"), width, "a finite number above 0")?;
    for track in std::iter::once(&drive.ego).chain(&drive.others) {
        check_track(name, drive, track)?;
    }
    let changes = drive.lane_changes.iter().map(|c| (c.start_s, c.end_s));
    let interventions = drive.interventions.iter().flatten();
    let spans = changes.chain(interventions.map(|i| (i.start_s, i.end_s)));
    check.finite(&field("an event"), spans.flat_map(|(a, b)| [a, b]))?;
    if let Some(line) = &drive.centre_line {
        check.at_least(3, &field("centre_line.map_m"), line.map_m.len())?;
        let places = line.map_m.iter().flat_map(|place| [place.0, place.1]);
        check.finite(&field("centre_line.map_m"), places)?;
        check.finite(&field("centre_line.start_m"), [line.start_m])?;
        let usable = line.step_m.is_finite() && line.step_m >= 0.1;
        let expected = "a finite number of at least 0.1 m";
        check.that(usable, &field("centre_line.step_m"), line.step_m, expected)?;
    }
    Ok(())
}

fn check_track(name: &str, drive: &PlayerDrive, track: &Track) -> Result<(), ReportError> {
    let check = Check(name);
    let field = |what: &str| format!("{what} of vehicle {} of drive {}", track.id, drive.label);
    check.length(&field("y_m"), track.y_m.len(), track.x_m.len())?;
    let end = track.first_row + track.x_m.len();
    if end > drive.time_s.len() {
        return check.length(&field("x_m"), end, drive.time_s.len());
    }
    check.finite(&field("x_m"), track.x_m.iter().copied())?;
    check.finite(&field("y_m"), track.y_m.iter().copied())?;
    let start_m = drive.ego.x_m[0];
    let far = |x: &f64| (x - start_m).abs() > FURTHEST_M;
    if let Some(x) = track.x_m.iter().find(|x| far(x)) {
        let expected = "within 5000 km of where ego starts";
        check.that(false, &field("x_m"), *x, expected)?;
    }
    if let Some(y) = track.y_m.iter().find(|y| y.abs() > FURTHEST_M) {
        check.that(false, &field("y_m"), *y, "within 5000 km of the road")?;
    }
    for (what, size) in [("length_m", track.length_m), ("width_m", track.width_m)] {
        let usable = size.is_finite() && size > 0.0 && size < 100.0;
        check.that(usable, &field(what), size, "above 0 and below 100")?;
    }
    Ok(())
}
