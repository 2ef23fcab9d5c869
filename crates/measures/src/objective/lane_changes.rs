//! Number of lane changes.

use super::{Measure, Shown, WITHOUT_LANES};
use maveric_domain::design::Sign;

pub(super) const MEASURE: Measure = Measure {
    name: "lane_changes",
    title: "Number of lane changes",
    unit: "1",
    shown: Shown::Plain,
    aggression: Some(Sign::Plus),
    description: "Count of completed lane changes, to either side.",
    of_passing: true,
    grows: true,
    why_missing: WITHOUT_LANES,
    value: |drive| {
        let completed = drive.lane_changes().iter().filter(|c| c.completed).count();
        drive.sees().lanes.then_some(completed as f64)
    },
};

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn a_pass_counts_two_and_a_change_cut_by_the_end_none() {
        assert_eq!(MEASURE.of(&Scripted::new(40.0).pass(5.0, 20.0).drive()), Some(2.0));
        assert_eq!(MEASURE.of(&Scripted::new(22.6).pass(5.0, 20.0).drive()), Some(1.0));
    }
}
