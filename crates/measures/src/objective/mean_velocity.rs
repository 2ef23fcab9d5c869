//! Mean velocity.

use super::{Measure, Shown, mean};
use maveric_domain::design::Sign;

pub(super) const MEASURE: Measure = Measure {
    name: "mean_velocity_mps",
    title: "Mean velocity",
    unit: "m/s",
    shown: Shown::Speed,
    aggression: Some(Sign::Plus),
    description: "Mean of ego speed over the drive.",
    of_passing: false,
    grows: false,
    why_missing: "never missing",
    value: |drive| mean(drive.rows().ego_speed_mps.iter().copied()),
};

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn half_the_time_at_20_and_half_at_30_is_25() {
        let drive = Scripted::new(20.0).speed(|t| if t < 10.0 { 20.0 } else { 30.0 }).drive();
        assert!((MEASURE.of(&drive).unwrap() - 25.0).abs() < 1e-9);
    }
}
