//! Time to collision: the least of a drive, and how often it is short.

use super::{Measure, Shown};
use maveric_domain::{Drive, design::Sign, drive::STANDSTILL_MPS};

/// The least time to collision with a vehicle ahead.
///
/// # Source
/// Hayward (1972), Near-miss determination through use of a scale of danger, by its abstract (the time measured until two vehicles
/// collide) and as others quote it (the time required for two vehicles to collide if they continue at their present speeds and on the
/// same path): the gap over the speed at which it closes. Ours: only above 0.5 m/s of closing speed, below which noise in the
/// speeds makes any number of it, and only while ego keeps its lane.
pub(super) const LEAST: Measure = Measure {
    name: "min_time_to_collision_s",
    title: "Least time to collision",
    unit: "s",
    shown: Shown::In("s"),
    aggression: Some(Sign::Minus),
    description: "Smallest gap to a lead vehicle over the speed at which it closes, where that is above 0.5 m/s.",
    of_passing: false,
    grows: true,
    why_missing: "ego closes in on nobody in its lane",
    value: |drive| {
        let times = (0..drive.len()).filter_map(|row| time_to_collision_s(drive, row));
        times.min_by(f64::total_cmp)
    },
};

/// How often a collision is less than 1.5 s away.
///
/// # Source
/// The border of 1.5 s: van der Horst and Hogema (1993) (?). Following here is driving less than 3 s behind a vehicle, closing in or not:
/// the method's following rows leave out whoever closes in, of whom a time to collision is told.
pub(super) const SHORT: Measure = Measure {
    name: "short_time_to_collision_share",
    title: "Share of time with a collision below 1.5 s away",
    unit: "1",
    shown: Shown::Plain,
    aggression: Some(Sign::Plus),
    description: "Share of the rows less than 3 s behind a lead vehicle at which the time to collision is below 1.5 s.",
    of_passing: false,
    grows: false,
    why_missing: "ego is never less than 3 s behind a vehicle in its lane",
    value: |drive| {
        let rows = drive.rows();
        let behind = |row: &usize| {
            let (gap_m, speed_mps) = (rows.lead_dx_m[*row], rows.ego_speed_mps[*row]);
            let near = speed_mps > STANDSTILL_MPS && gap_m < FOLLOWING_S * speed_mps;
            rows.changing[*row] == 0 && near && drive.lead_ahead(*row)
        };
        let behind: Vec<usize> = (0..drive.len()).filter(behind).collect();
        let short = |row: &&usize| time_to_collision_s(drive, **row).is_some_and(|t| t < SHORT_S);
        let short = behind.iter().filter(short).count();
        (!behind.is_empty()).then(|| short as f64 / behind.len() as f64)
    },
};

/// Closing speed above which there is a time to collision, in m/s.
const CLOSING_MPS: f64 = 0.5;
/// Longest time gap of following, in s.
const FOLLOWING_S: f64 = 3.0;
/// Below this a collision is near, in s.
const SHORT_S: f64 = 1.5;

/// The time to collision at a row, in s; `None` where nobody is ahead in ego's lane, ego changes lane, or the gap does not close.
pub(super) fn time_to_collision_s(drive: &Drive, row: usize) -> Option<f64> {
    let rows = drive.rows();
    let closing_mps = rows.ego_speed_mps[row] - rows.lead_speed_mps[row];
    let closes = closing_mps > CLOSING_MPS && rows.changing[row] == 0 && drive.lead_ahead(row);
    closes.then(|| rows.lead_dx_m[row] / closing_mps)
}

/// The inverse of the time to collision at a row, in 1/s, with a vehicle ahead in ego's lane: 0 where the gap opens or nobody is ahead.
pub(crate) fn inverse_time_to_collision(drive: &Drive, row: usize) -> f64 {
    let rows = drive.rows();
    let closing_mps = (rows.ego_speed_mps[row] - rows.lead_speed_mps[row]).max(0.0);
    if drive.lead_ahead(row) { closing_mps / rows.lead_dx_m[row] } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn the_gap_over_the_closing_speed_is_least_where_it_is_nearest() {
        // 40 m at 5 m/s of closing speed are 8 s, 10 m are 2 s; a lead that runs away has none.
        let drive = by_rows(10.0, 100, |rows| {
            rows.lead_speed_mps.fill(15.0);
            rows.lead_dx_m[60..].fill(10.0);
        });
        assert_eq!(LEAST.of(&drive), Some(2.0));
        let away = by_rows(10.0, 100, |rows| rows.lead_speed_mps.fill(25.0));
        assert_eq!(LEAST.of(&away), None);
        // At the border of what is closing, and below it.
        let closing = |mps: f64| by_rows(10.0, 100, |rows| rows.lead_speed_mps.fill(20.0 - mps));
        assert_eq!(LEAST.of(&closing(0.5)), None);
        assert_eq!(LEAST.of(&closing(1.0)), Some(40.0));
        let changing = by_rows(10.0, 100, |rows| {
            rows.lead_speed_mps.fill(15.0);
            rows.changing.fill(1);
        });
        assert_eq!(LEAST.of(&changing), None);
    }

    #[test]
    fn a_quarter_of_the_time_behind_somebody_is_a_quarter_and_far_behind_is_not_behind() {
        let near = |rows: &mut maveric_domain::drive::Rows| {
            rows.lead_speed_mps[..20].fill(10.0);
            rows.lead_dx_m[..20].fill(14.0);
            // 3 s of gap and more are nobody's following.
            rows.lead_dx_m[80..].fill(60.0);
        };
        assert_eq!(SHORT.of(&by_rows(10.0, 100, near)), Some(0.25));
        let farther = by_rows(10.0, 100, |rows| {
            near(rows);
            rows.lead_dx_m[..20].fill(15.0);
        });
        assert_eq!(SHORT.of(&farther), Some(0.0));
        let alone = by_rows(10.0, 100, |rows| rows.lead_present.fill(false));
        assert_eq!(SHORT.of(&alone), None);
    }
}
