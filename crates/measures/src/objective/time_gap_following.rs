//! Mean time gap while following.

use super::{Measure, Shown, mean};
use maveric_domain::design::Sign;

/// The time gap that a person keeps behind a vehicle.
///
/// # Source
/// SAE J2944, of which its editor writes that a gap is the distance from the front bumper to the rear bumper ahead, and a headway that from
/// front to front (P. Green, cps-vo.org/node/23612); that its time gap is that distance over ego's speed was not read there (?). What
/// following is: method section 2. It is a gap where the paper's headway times, taken as ego moves out to pass, are called headways.
pub(super) const MEASURE: Measure = Measure {
    name: "time_gap_following_s",
    title: "Time gap while following",
    unit: "s",
    shown: Shown::In("s"),
    aggression: Some(Sign::Minus),
    description: "Mean over the rows at which ego follows of the gap to the lead vehicle over ego speed.",
    of_passing: false,
    grows: false,
    why_missing: "ego follows nobody",
    value: |drive| {
        let follows = (0..drive.len()).filter(|row| drive.rows().following[*row]);
        mean(follows.filter_map(|row| drive.time_gap_s(row)))
    },
};

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn only_rows_of_following_count_and_standing_has_no_time_gap() {
        // Half of the time 40 m at 20 m/s, then 20 m, which is not following.
        let drive = by_rows(10.0, 100, |rows| {
            rows.lead_dx_m[50..].fill(20.0);
            rows.following[50..].fill(false);
        });
        assert_eq!(MEASURE.of(&drive), Some(2.0));
        let nearer = by_rows(10.0, 100, |rows| rows.lead_dx_m[50..].fill(20.0));
        assert_eq!(MEASURE.of(&nearer), Some(1.5));
        let standing = by_rows(10.0, 100, |rows| rows.ego_speed_mps.fill(0.0));
        assert_eq!(MEASURE.of(&standing), None);
        assert_eq!(MEASURE.of(&Scripted::new(40.0).drive()), None);
    }
}
