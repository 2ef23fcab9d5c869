//! Headway when merging back, as a distance and as a time.

use super::{Measure, Shown, mean};
use maveric_domain::{
    Drive,
    design::Sign,
    drive::{Direction, STANDSTILL_MPS},
};

/// Room left to the vehicle behind when merging back.
///
/// # Source
/// Paper, Metrics: "the distance between the following vehicle and ego when merging back"; method section 8: the gap to
/// the vehicle behind in the lane merged into, here at the start of the change. Merging back with nobody behind within 200 m
/// leaves no distance and does not count; a merge that the drive's end cut short does.
pub(super) const DISTANCE: Measure = Measure {
    name: "headway_merge_back_m",
    title: "Distance headway merge back",
    unit: "m",
    shown: Shown::In("m"),
    aggression: Some(Sign::Minus),
    description: "Mean over changes back of the gap to the vehicle behind in the lane merged into, at the start of the change.",
    of_passing: true,
    grows: false,
    why_missing: "never merged back in front of a vehicle, or a log without lateral positions",
    value: |drive| mean(merges(drive).map(|(gap, _)| gap)),
};

/// The same distance over ego speed at that moment.
pub(super) const TIME: Measure = Measure {
    name: "headway_merge_back_s",
    title: "Time headway merge back",
    unit: "s",
    shown: Shown::In("s"),
    aggression: Some(Sign::Minus),
    description: "Mean over changes back of the gap to the vehicle behind in the lane merged into over ego speed, at the start of the change.",
    of_passing: true,
    grows: false,
    why_missing: "never merged back in front of a vehicle, or a log without lateral positions",
    value: |drive| {
        let moving = merges(drive).filter(|(_, speed)| *speed > STANDSTILL_MPS);
        mean(moving.map(|(gap, speed)| gap / speed))
    },
};

/// Gap (m) and ego speed (m/s) at the start of each change back.
fn merges(drive: &Drive) -> impl Iterator<Item = (f64, f64)> {
    let changes = drive.lane_changes().into_iter();
    let back = changes.filter(|c| c.direction == Direction::Right);
    back.filter_map(move |c| Some((c.gap_behind_m?, drive.rows().ego_speed_mps[c.start])))
}

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn merging_back_45_m_ahead_at_30_mps_is_one_and_a_half_seconds() {
        // 80 m ahead at the start, 5 m/s slower, both cars 5 m long: 45 m behind ego's bumper at second 27.
        let drive = Scripted::new(40.0).lead(80.0, 25.0).pass(4.0, 27.0).drive();
        let metres = DISTANCE.of(&drive).unwrap();
        assert!((metres - 45.0).abs() < 1.5, "{metres}");
        assert!((TIME.of(&drive).unwrap() - metres / 30.0).abs() < 1e-9);
    }

    #[test]
    fn a_drive_that_never_merges_back_has_no_value() {
        let drive = Scripted::new(40.0).lead(80.0, 25.0).pass(4.0, 1e9).drive();
        assert_eq!((DISTANCE.of(&drive), TIME.of(&drive)), (None, None));
    }

    #[test]
    fn merging_back_with_nobody_behind_has_no_value() {
        assert_eq!(DISTANCE.of(&Scripted::new(40.0).pass(4.0, 20.0).drive()), None);
    }
}
