//! The Intelligent Driver Model and its improved form.

use crate::LEAST_GAP_M;
use serde::{Deserialize, Serialize};

/// The Intelligent Driver Model: a·(1 − (v/v0)⁴ − (s*/gap)²), s* = s0 + max(0, v·T + v·(v − v_lead)/(2√(a·b))).
///
/// # Source
/// Treiber, Hennecke and Helbing 2000.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Idm {
    /// v0: speed on a free road, in m/s.
    pub desired_speed_mps: f64,
    /// T: time gap, in s.
    pub time_gap_s: f64,
    /// s0: gap at standstill, in m.
    pub standstill_gap_m: f64,
    /// a: greatest acceleration, in m/s².
    pub max_accel_mps2: f64,
    /// b: comfortable braking, in m/s².
    pub comfortable_braking_mps2: f64,
}

impl Idm {
    /// s*: the gap wanted at these speeds, in m.
    #[inline]
    pub fn desired_gap_m(&self, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        self.desired_gap_closing_m(self.closing_m(ego_speed_mps, lead_speed_mps), ego_speed_mps)
    }

    #[inline]
    fn desired_gap_closing_m(&self, closing_m: f64, ego_speed_mps: f64) -> f64 {
        let dynamic = ego_speed_mps * self.time_gap_s + closing_m;
        self.standstill_gap_m + dynamic.max(0.0)
    }

    #[inline]
    fn closing_m(&self, v: f64, lead_speed_mps: f64) -> f64 {
        v * (v - lead_speed_mps) / self.braking_mps2()
    }

    /// 2√(a·b): what closing in is divided by, in m/s².
    #[inline]
    pub fn braking_mps2(&self) -> f64 {
        2.0 * (self.max_accel_mps2 * self.comfortable_braking_mps2).sqrt()
    }

    /// Acceleration, in m/s².
    #[inline]
    pub fn accel_mps2(&self, gap_m: f64, ego_speed_mps: f64, lead_speed_mps: f64) -> f64 {
        let share = ego_speed_mps / self.desired_speed_mps;
        let closing_m = self.closing_m(ego_speed_mps, lead_speed_mps);
        self.accel_of_mps2(share, closing_m, gap_m, ego_speed_mps)
    }

    /// [`Idm::accel_mps2`] from v/v0 and v·(v − v_lead)/(2√(a·b)) in m, for who works those out without a division.
    #[inline]
    pub fn accel_of_mps2(
        &self,
        share_of_desired_speed: f64,
        closing_m: f64,
        gap_m: f64,
        ego_speed_mps: f64,
    ) -> f64 {
        let desired = self.desired_gap_closing_m(closing_m, ego_speed_mps);
        let free = share_of_desired_speed.powi(4);
        self.max_accel_mps2 * (1.0 - free - (desired / gap_m.max(LEAST_GAP_M)).powi(2))
    }

    /// Acceleration by the improved model, in m/s²; `gap_factor` multiplies the wanted gap: below 1 for a driver who is
    /// about to pass.
    ///
    /// # Source
    /// Treiber and Kesting, Traffic Flow Dynamics (2013), section 11.3.7: unlike the first model its equilibrium gap does
    /// not grow near the desired speed.
    pub fn improved_accel_mps2(
        &self,
        gap_m: f64,
        ego_speed_mps: f64,
        lead_speed_mps: f64,
        gap_factor: f64,
    ) -> f64 {
        let (a, b) = (self.max_accel_mps2, self.comfortable_braking_mps2);
        let ratio = ego_speed_mps / self.desired_speed_mps;
        let free = if ratio <= 1.0 {
            a * (1.0 - ratio.powi(4))
        } else {
            -b * (1.0 - libm::pow(ratio, -4.0 * a / b))
        };
        if gap_m == f64::INFINITY {
            return free;
        }
        let desired = gap_factor * self.desired_gap_m(ego_speed_mps, lead_speed_mps);
        let z = desired / gap_m.max(LEAST_GAP_M);
        match (ratio <= 1.0, z >= 1.0) {
            (true, true) => a * (1.0 - z * z),
            (true, false) if free > 1e-6 => free * (1.0 - libm::pow(z, 2.0 * a / free)),
            (false, true) => free + a * (1.0 - z * z),
            (_, false) => free,
        }
    }

    /// The interaction with the lead alone, a·(1 − (s*/gap)²), in m/s², where the gap is shorter than wanted.
    pub fn held_back_mps2(
        &self,
        gap_m: f64,
        ego_speed_mps: f64,
        lead_speed_mps: f64,
    ) -> Option<f64> {
        let z = self.desired_gap_m(ego_speed_mps, lead_speed_mps) / gap_m.max(LEAST_GAP_M);
        (z >= 1.0).then_some(self.max_accel_mps2 * (1.0 - z * z))
    }

    /// Speed at which the first model keeps `gap_m` behind a vehicle of the same speed, in m/s.
    ///
    /// Solves s0 + v·T = gap·√(1 − (v/v0)⁴) by bisection.
    pub fn equilibrium_speed_mps(&self, gap_m: f64) -> f64 {
        let excess = |v: f64| {
            let free = (1.0 - (v / self.desired_speed_mps).powi(4)).max(0.0);
            self.standstill_gap_m + v * self.time_gap_s - gap_m * free.sqrt()
        };
        let (mut low, mut high) = (0.0, self.desired_speed_mps);
        if excess(low) >= 0.0 {
            return 0.0;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// The same driver with another time gap, in s.
    #[must_use]
    pub fn with_time_gap_s(self, time_gap_s: f64) -> Self {
        Self { time_gap_s, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRIVER: Idm = Idm {
        desired_speed_mps: 30.0,
        time_gap_s: 1.2,
        standstill_gap_m: 2.0,
        max_accel_mps2: 1.4,
        comfortable_braking_mps2: 2.5,
    };

    #[test]
    fn the_gap_at_which_idm_keeps_its_speed_is_the_published_one() {
        let v: f64 = 20.0;
        let gap = (2.0 + v * 1.2) / (1.0 - (v / 30.0).powi(4)).sqrt();
        assert!(DRIVER.accel_mps2(gap, v, v).abs() < 1e-12);
    }

    #[test]
    fn the_speed_of_an_equilibrium_is_one() {
        for gap in [5.0, 20.0, 60.0] {
            let v = DRIVER.equilibrium_speed_mps(gap);
            assert!(DRIVER.accel_mps2(gap, v, v).abs() < 1e-9, "{gap} {v}");
        }
        assert!(DRIVER.equilibrium_speed_mps(1.0).abs() < 1e-12);
    }

    #[test]
    fn a_lead_holds_back_only_nearer_than_the_wanted_gap() {
        let wanted = DRIVER.desired_gap_m(25.0, 24.0);
        assert!(DRIVER.held_back_mps2(1.01 * wanted, 25.0, 24.0).is_none());
        assert!(DRIVER.held_back_mps2(0.4 * wanted, 25.0, 24.0).is_some_and(|a| a < -4.0));
    }

    #[test]
    fn a_gap_of_zero_is_a_hard_braking_and_an_infinite_one_a_free_road() {
        let accel = DRIVER.accel_mps2(0.0, 10.0, 10.0);
        assert!(accel.is_finite() && accel < -8.0);
        assert!(DRIVER.accel_mps2(f64::INFINITY, 30.0, 30.0).abs() < 1e-12);
        let free = DRIVER.improved_accel_mps2(f64::INFINITY, 33.0, 33.0, 1.0);
        assert!(free < -0.3);
    }

    #[test]
    fn the_improved_equilibrium_gap_is_the_time_gap_even_near_the_desired_speed() {
        for speed in [15.0, 29.9] {
            let gap = 2.0 + 1.2 * speed;
            assert!(DRIVER.improved_accel_mps2(gap, speed, speed, 1.0).abs() < 1e-9);
            let half = DRIVER.improved_accel_mps2(0.5 * gap, speed, speed, 0.5);
            assert!(half.abs() < 1e-9);
        }
    }

    #[test]
    fn every_regime_has_the_value_worked_out_by_hand() {
        let driver = Idm {
            desired_speed_mps: 40.0,
            max_accel_mps2: 2.0,
            comfortable_braking_mps2: 8.0,
            ..DRIVER
        };
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
        // 2 + 20 · 1.2 + 20 · 8 / (2√16), and of the free road's 1 a sixteenth is gone at half the desired speed.
        near(driver.desired_gap_m(20.0, 12.0), 46.0);
        near(driver.accel_mps2(23.0, 20.0, 12.0), 2.0 * (1.0 - 1.0 / 16.0 - 4.0));
        near(driver.held_back_mps2(23.0, 20.0, 12.0).unwrap(), -6.0);
        near(driver.improved_accel_mps2(23.0, 20.0, 12.0, 1.0), -6.0);
        let free = 2.0 * 15.0 / 16.0;
        let held = 1.0 - 0.5_f64.powf(4.0 / free);
        near(driver.improved_accel_mps2(92.0, 20.0, 12.0, 1.0), free * held);
        // Half a second more of 20 m/s.
        let further = driver.with_time_gap_s(1.7);
        near(further.desired_gap_m(20.0, 12.0), 56.0);
        // Who draws away is wanted no further than at standstill.
        near(driver.desired_gap_m(20.0, 40.0), 2.0);
        // At twice the desired speed: -8 (1 - 2⁻¹), and half the wanted 98 m.
        near(driver.improved_accel_mps2(49.0, 80.0, 80.0, 1.0), -4.0 - 6.0);
        near(driver.improved_accel_mps2(99.0, 80.0, 80.0, 1.0), -4.0);
    }
}
