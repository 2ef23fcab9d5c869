//! How hard a person brakes at most.

use super::{Measure, Shown, low_pass::acceleration_and_jerk};
use maveric_domain::design::Sign;

/// The strongest deceleration of a drive.
///
/// # Source
/// Ours: the largest deceleration of the speed behind a second-order low pass at 2 Hz, so that one sample that trembles is no braking.
pub(super) const MEASURE: Measure = Measure {
    name: "strongest_braking_mps2",
    title: "Strongest braking",
    unit: "m/s²",
    shown: Shown::In("m/s²"),
    aggression: Some(Sign::Plus),
    description: "Largest deceleration of the speed behind a second-order 2 Hz low pass; 0 where ego never slows down.",
    of_passing: false,
    grows: true,
    why_missing: "below 10 Hz",
    value: |drive| {
        let [acceleration, _] = acceleration_and_jerk(drive)?;
        let braking = acceleration.into_iter().flatten().map(|a| -a);
        braking.reduce(f64::max).map(|most| most.max(0.0))
    },
};

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn three_mps2_for_four_seconds_is_three_and_speeding_up_is_no_braking() {
        let brakes = |t: f64| 30.0 - 3.0 * (t - 8.0).clamp(0.0, 4.0);
        let drive = Scripted::new(20.0).speed(brakes).drive();
        let found = MEASURE.of(&drive).unwrap();
        // The filter overshoots a ramp by some percent.
        assert!((3.0..3.3).contains(&found), "{found}");
        let faster = Scripted::new(20.0).speed(|t| 20.0 + t).drive();
        assert_eq!(MEASURE.of(&faster), Some(0.0));
        let slow = by_rows(5.0, 100, |_| ());
        assert_eq!(MEASURE.of(&slow), None);
    }

    #[test]
    fn a_sample_that_trembles_is_far_less_than_its_difference_says() {
        // 1 m/s up and down within a tenth of a second would be 10 m/s² and more.
        let drive = by_rows(20.0, 200, |rows| rows.ego_speed_mps[100] += 1.0);
        let found = MEASURE.of(&drive).unwrap();
        assert!((0.1..4.0).contains(&found), "{found}");
    }
}
