//! How jerkily a person drives.

use super::{Measure, Shown, low_pass::acceleration_and_jerk};
use maveric_domain::design::Sign;

/// The jerk that one sample in twenty exceeds.
///
/// # Source
/// Ours: the 95 % quantile (linear between ranks) of the absolute jerk of the speed behind a second-order low pass at 2 Hz.
pub(super) const MEASURE: Measure = Measure {
    name: "jerk_95_mps3",
    title: "Jerk exceeded in 5 % of the time",
    unit: "m/s³",
    shown: Shown::In("m/s³"),
    aggression: Some(Sign::Plus),
    description: "95 % quantile of the absolute jerk of the speed behind a second-order 2 Hz low pass.",
    of_passing: false,
    grows: false,
    why_missing: "below 10 Hz",
    value: |drive| {
        let [_, jerk] = acceleration_and_jerk(drive)?;
        let mut sizes: Vec<f64> = jerk.into_iter().flatten().map(f64::abs).collect();
        sizes.sort_by(f64::total_cmp);
        let position = SHARE * sizes.len().checked_sub(1)? as f64;
        let (low, high) = (sizes[position.floor() as usize], sizes[position.ceil() as usize]);
        Some(low + (position - position.floor()) * (high - low))
    },
};

/// The share of samples below it.
const SHARE: f64 = 0.95;

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;

    #[test]
    fn a_slow_swing_of_speed_has_the_jerk_of_its_second_derivative() {
        // 2 m/s about 25 m/s with a period of 10 s: at most 2·(2π/10)² m/s³.
        let swing = |t: f64| 25.0 + 2.0 * (std::f64::consts::TAU * t / 10.0).sin();
        let drive = Scripted::new(200.0).speed(swing).drive();
        let most = 2.0 * (std::f64::consts::TAU / 10.0).powi(2);
        let expected = most * (0.475 * std::f64::consts::PI).sin();
        let found = MEASURE.of(&drive).unwrap();
        assert!((found / expected - 1.0).abs() < 0.02, "{found}, not {expected}");
    }

    #[test]
    fn an_even_speed_has_none_of_it_and_one_jerk_in_a_thousand_does_not_count() {
        let even = MEASURE.of(&by_rows(20.0, 400, |_| ())).unwrap();
        assert!(even < 1e-9, "{even}");
        let once = by_rows(20.0, 2000, |rows| rows.ego_speed_mps[1000] = 10.0);
        assert!(MEASURE.of(&once).unwrap() < 1e-3);
        assert_eq!(MEASURE.of(&by_rows(5.0, 100, |_| ())), None);
    }
}
