//! One driver of the background: the Intelligent Driver Model's parameters.

use crate::scenario::setting::settings;
use maveric_laws::Idm;

settings! {
    /// A vehicle of the background traffic and how it follows, by the Intelligent Driver Model.
    ///
    /// # Source
    /// Treiber, Hennecke and Helbing 2000, Table I, for [`IdmDriver::CAR`].
    #[derive(Copy)]
    pub struct IdmDriver {
        /// v0, the speed wanted on free road.
        desired_speed_mps: f64, 1.0..=70.0;
        /// T, the time gap kept.
        time_gap_s: f64, 0.3..=10.0;
        /// s0, the gap at standstill.
        standstill_m: f64, 0.5..=20.0;
        /// a, the acceleration from standstill.
        acceleration_mps2: f64, 0.1..=5.0;
        /// b, the comfortable braking, positive.
        braking_mps2: f64, 0.3..=6.0;
        /// Bumper to bumper.
        length_m: f64, 1.0..=30.0;
    }
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
    pub const TRUCK: Self = Self { desired_speed_mps: 80.0 / 3.6, length_m: 12.0, ..Self::CAR };

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
