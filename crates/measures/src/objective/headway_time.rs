//! Mean headway time.

use super::{Measure, Shown, mean};
use maveric_domain::{design::Sign, drive::Direction};

/// The time gap at which a person moves out to pass.
///
/// # Source
/// Paper, Metrics: "the distance between the lead vehicle and ego divided by the speed of the ego when a
/// lane change occurs"; method section 8: at the start of changes to the passing lane. The distance is
/// `lead_dx_m`, a gap; the paper's name is kept. A change that the drive's end cut short has a start as well and counts;
/// one with no vehicle ahead in ego's lane has no such distance and does not.
pub(super) const MEASURE: Measure = Measure {
    name: "mean_headway_time_s",
    title: "Mean headway time",
    unit: "s",
    shown: Shown::In("s"),
    aggression: Some(Sign::Minus),
    description: "Mean over changes to the passing lane of the gap to the lead vehicle over ego speed at the start of the change.",
    of_passing: true,
    grows: false,
    why_missing: "no change to the passing lane with a lead vehicle ahead, or a log without lateral positions",
    value: |drive| {
        let changes = drive.lane_changes().into_iter();
        let out = changes.filter(|c| c.direction == Direction::Left && drive.lead_ahead(c.start));
        mean(out.filter_map(|c| drive.time_gap_s(c.start)))
    },
};

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn moving_out_60_m_behind_at_30_mps_is_2_s() {
        // 5 m/s of closing speed from 85 m: 60 m are left at second 5, where the change starts.
        let drive = Scripted::new(40.0).lead(85.0, 25.0).pass(5.0, 30.0).drive();
        let found = MEASURE.of(&drive).unwrap();
        // The label finds the start where the lateral speed passes 0.15 m/s, a little after.
        assert!((found - 2.0).abs() < 0.06, "{found}");
    }

    #[test]
    fn a_change_on_an_empty_road_has_no_headway() {
        assert_eq!(MEASURE.of(&Scripted::new(40.0).pass(5.0, 20.0).drive()), None);
    }
}
