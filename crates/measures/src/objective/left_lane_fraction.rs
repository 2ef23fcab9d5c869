//! Fraction of time in the left lane.

use super::{Measure, Shown, WITHOUT_LANES};

pub(super) const MEASURE: Measure = Measure {
    name: "left_lane_fraction",
    title: "Fraction of time in left lane",
    unit: "1",
    shown: Shown::Plain,
    aggression: None,
    description: "Share of rows with ego left of the rightmost lane.",
    of_passing: true,
    grows: false,
    why_missing: WITHOUT_LANES,
    // Rows are evenly sampled, so a share of rows is a share of time.
    value: |drive| {
        let left = drive.rows().lane.iter().filter(|&&lane| lane > 0).count();
        drive.sees().lanes.then(|| left as f64 / drive.len() as f64)
    },
};

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn half_of_the_drive_to_the_left_is_one_half() {
        let found = MEASURE.of(&Scripted::new(40.0).pass(8.0, 28.0).drive()).unwrap();
        assert!((found - 0.5).abs() < 0.01, "{found}");
    }
}
