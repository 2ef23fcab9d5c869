//! One driver of the background: the Intelligent Driver Model's parameters.

use crate::{
    error::SimulatorError,
    scenario::{SettingRange, check_setting},
};
use maveric_laws::Idm;
use serde::{Deserialize, Serialize};

/// A vehicle of the background traffic and how it follows, by the Intelligent Driver Model.
///
/// # Source
/// Treiber, Hennecke and Helbing 2000, Table I, for [`IdmDriver::CAR`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdmDriver {
    /// v0, the speed wanted on free road, in m/s.
    pub desired_speed_mps: f64,
    /// T, the time gap kept, in s.
    pub time_gap_s: f64,
    /// s0, the gap at standstill, in m.
    pub standstill_m: f64,
    /// a, the acceleration from standstill, in m/s².
    pub acceleration_mps2: f64,
    /// b, the comfortable braking, in m/s², positive.
    pub braking_mps2: f64,
    /// Bumper to bumper, in m.
    pub length_m: f64,
}

impl IdmDriver {
    /// A car with the published parameters: v0 120 km/h, T 1.6 s, s0 2 m, a 0.73 m/s², b 1.67 m/s², 5 m long.
    pub const CAR: Self = Self {
        desired_speed_mps: 120.0 / 3.6,
        time_gap_s: 1.6,
        standstill_m: 2.0,
        acceleration_mps2: 0.73,
        braking_mps2: 1.67,
        length_m: 5.0,
    };

    /// A truck: the same with v0 80 km/h and 12 m (chosen).
    pub const TRUCK: Self = Self {
        desired_speed_mps: 80.0 / 3.6,
        length_m: 12.0,
        ..Self::CAR
    };

    /// Whether every number is in its range; `section` names them in the error.
    pub(crate) fn check(&self, section: &str) -> Result<(), SimulatorError> {
        let ranges = [
            (
                "desired_speed_mps",
                self.desired_speed_mps,
                SettingRange::Within(1.0, 70.0, "1 to 70 m/s"),
            ),
            (
                "time_gap_s",
                self.time_gap_s,
                SettingRange::Within(0.3, 10.0, "0.3 to 10 s"),
            ),
            (
                "standstill_m",
                self.standstill_m,
                SettingRange::Within(0.5, 20.0, "0.5 to 20 m"),
            ),
            (
                "acceleration_mps2",
                self.acceleration_mps2,
                SettingRange::Within(0.1, 5.0, "0.1 to 5 m/s²"),
            ),
            (
                "braking_mps2",
                self.braking_mps2,
                SettingRange::Within(0.3, 6.0, "0.3 to 6 m/s²"),
            ),
            (
                "length_m",
                self.length_m,
                SettingRange::Within(1.0, 30.0, "1 to 30 m"),
            ),
        ];
        ranges
            .into_iter()
            .try_for_each(|(key, found, range)| check_setting(section, key, found, range))
    }

    /// This driver's law.
    pub(super) fn law(&self) -> Idm {
        Idm {
            desired_speed_mps: self.desired_speed_mps,
            time_gap_s: self.time_gap_s,
            standstill_gap_m: self.standstill_m,
            max_accel_mps2: self.acceleration_mps2,
            comfortable_braking_mps2: self.braking_mps2,
        }
    }

    /// Speed at which this driver keeps `gap_m` behind a vehicle of the same speed, in m/s.
    pub fn equilibrium_speed_mps(&self, gap_m: f64) -> f64 {
        self.law().equilibrium_speed_mps(gap_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_equilibrium_speed_solves_the_equation() {
        let car = IdmDriver::CAR;
        for gap_m in [3.0, 10.0, 30.0, 100.0, 1000.0] {
            let v = car.equilibrium_speed_mps(gap_m);
            let wanted = (2.0 + 1.6 * v) / (1.0 - (v / (120.0 / 3.6)).powi(4)).sqrt();
            assert!((wanted - gap_m).abs() < 1e-6 * gap_m, "{gap_m} {wanted}");
        }
        assert!(car.equilibrium_speed_mps(1.0) < 1e-12);
    }
}
