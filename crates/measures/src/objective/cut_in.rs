//! How near vehicles cut in.

use super::{Measure, Shown, mean, time_to_collision::time_to_collision_s};
use maveric_domain::Drive;

/// The time gap that a vehicle leaves as it cuts in.
///
/// # Source
/// Ours: a vehicle cuts in at the first row at which it is the reference vehicle ahead in ego's lane, a quarter of a lane or more beside
/// ego, while ego keeps its lane. One that comes up far ahead is in the lane's middle, and so is one that shows as another leaves. Into a
/// passing lane only vehicles that become the reference (method section 2) are seen.
pub(super) const GAP: Measure = Measure {
    name: "cut_in_time_gap_s",
    title: "Time gap at cut-ins",
    unit: "s",
    shown: Shown::In("s"),
    aggression: None,
    description: "Mean over vehicles that cut in of the gap over ego speed at the moment at which they cross the line.",
    of_passing: true,
    grows: false,
    why_missing: "nobody cuts in, or a log without lateral positions",
    value: |drive| mean(cut_ins(drive).filter_map(|row| drive.time_gap_s(row))),
};

/// The time to collision as a vehicle cuts in.
///
/// # Source
/// As [`GAP`]; the time to collision is that of its own measure.
pub(super) const TIME_TO_COLLISION: Measure = Measure {
    name: "cut_in_time_to_collision_s",
    title: "Time to collision at cut-ins",
    unit: "s",
    shown: Shown::In("s"),
    aggression: None,
    description: "Mean over vehicles that cut in and are slower of the time to collision at the moment at which they cross the line.",
    of_passing: true,
    grows: false,
    why_missing: "nobody slower cuts in, or a log without lateral positions",
    value: |drive| mean(cut_ins(drive).filter_map(|row| time_to_collision_s(drive, row))),
};

/// Share of a lane that a vehicle is beside ego at least as it crosses the line.
const BESIDE: f64 = 0.25;

/// The rows at which a vehicle has just cut in.
pub(crate) fn cut_ins(drive: &Drive) -> impl Iterator<Item = usize> {
    let rows = drive.rows();
    let beside_m = BESIDE * drive.road().lane_width_m;
    let keeps_lane = move |row: usize| {
        rows.changing[row] == 0
            && rows.lane[row] == rows.lane[row - 1]
            && rows.segment[row] == rows.segment[row - 1]
    };
    let was_ahead =
        move |row: usize| rows.lead_id[row] == rows.lead_id[row - 1] && drive.lead_ahead(row - 1);
    (1..drive.len()).filter(move |&row| {
        drive.lead_ahead(row)
            && !was_ahead(row)
            && keeps_lane(row)
            && rows.lead_dy_m[row].abs() >= beside_m
            && drive.time_gap_s(row).is_some()
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;
    use maveric_domain::drive::Rows;

    /// From row 50 another vehicle is ahead: this far aside, this near, this fast.
    fn another(dy_m: f64, dx_m: f64, speed_mps: f64, more: impl FnOnce(&mut Rows)) -> Drive {
        by_rows(10.0, 100, |rows| {
            rows.lead_id[50..].fill(Some(2));
            rows.lead_dy_m[50..60].fill(dy_m);
            rows.lead_dx_m[50..].fill(dx_m);
            rows.lead_speed_mps[50..].fill(speed_mps);
            more(rows);
        })
    }

    #[test]
    fn a_vehicle_that_crosses_the_line_ten_metres_ahead_cuts_in_at_half_a_second() {
        let slower = another(1.8, 10.0, 15.0, |_| ());
        assert_eq!((GAP.of(&slower), TIME_TO_COLLISION.of(&slower)), (Some(0.5), Some(2.0)));
        let faster = another(-1.8, 10.0, 25.0, |_| ());
        assert_eq!((GAP.of(&faster), TIME_TO_COLLISION.of(&faster)), (Some(0.5), None));
    }

    #[test]
    fn who_comes_up_in_the_middle_of_the_lane_or_is_driven_up_to_by_a_change_does_not_cut_in() {
        assert_eq!(GAP.of(&another(0.0, 10.0, 15.0, |_| ())), None);
        assert_eq!(GAP.of(&another(1.8, 10.0, 15.0, |rows| rows.changing[45..55].fill(1))), None);
        assert_eq!(GAP.of(&another(1.8, 10.0, 15.0, |rows| rows.lane[50..].fill(1))), None);
        assert_eq!(GAP.of(&another(1.8, 10.0, 15.0, |rows| rows.segment[50..].fill(1))), None);
        // The same vehicle that moves within the lane was there before.
        assert_eq!(GAP.of(&another(1.8, 10.0, 15.0, |rows| rows.lead_id.fill(Some(2)))), None);
    }
}
