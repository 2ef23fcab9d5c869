//! Car-following: the improved Intelligent Driver Model.

/// What a driver wants of the road at one instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Idm {
    /// Speed wanted on free road, in m/s, above 0.
    pub(crate) desired_speed_mps: f64,
    /// Time gap kept behind a lead, in s.
    pub(crate) time_gap_s: f64,
    /// Gap kept at standstill, in m.
    pub(crate) standstill_m: f64,
    /// Acceleration from standstill, in m/s².
    pub(crate) acceleration_mps2: f64,
    /// Comfortable braking, in m/s².
    pub(crate) braking_mps2: f64,
    /// Factor on the whole desired gap: below 1 for a driver who is about to pass.
    pub(crate) gap_factor: f64,
}

/// The lead as a driver sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeenLead {
    /// Bumper to bumper, in m.
    pub(crate) gap_m: f64,
    /// Ego's speed minus the lead's, in m/s.
    pub(crate) closing_mps: f64,
}

impl Idm {
    /// Acceleration wanted at `speed_mps`, in m/s², never below -8.
    ///
    /// # Source
    /// Treiber and Kesting, Traffic Flow Dynamics, section 11.3.7 (improved IDM): unlike IDM its equilibrium
    /// gap does not grow near the desired speed.
    pub(crate) fn acceleration(&self, speed_mps: f64, lead: Option<SeenLead>) -> f64 {
        let (a, b) = (self.acceleration_mps2, self.braking_mps2);
        let ratio = speed_mps / self.desired_speed_mps;
        let free = if ratio <= 1.0 {
            a * (1.0 - ratio.powi(4))
        } else {
            -b * (1.0 - ratio.powf(-4.0 * a / b))
        };
        let Some(lead) = lead else {
            return free;
        };
        let z = self.desired_gap_m(speed_mps, lead.closing_mps) / lead.gap_m.max(0.1);
        let wanted = match (ratio <= 1.0, z >= 1.0) {
            (true, true) => a * (1.0 - z * z),
            (true, false) if free > 1e-6 => free * (1.0 - z.powf(2.0 * a / free)),
            (false, true) => free + a * (1.0 - z * z),
            (_, false) => free,
        };
        wanted.max(-8.0)
    }

    /// s*, the gap wanted at these speeds, in m.
    fn desired_gap_m(&self, speed_mps: f64, closing_mps: f64) -> f64 {
        let braking = 2.0 * (self.acceleration_mps2 * self.braking_mps2).sqrt();
        let dynamic = speed_mps * (self.time_gap_s + closing_mps / braking);
        self.gap_factor * (self.standstill_m + dynamic.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRIVER: Idm = Idm {
        desired_speed_mps: 30.0,
        time_gap_s: 1.2,
        standstill_m: 2.0,
        acceleration_mps2: 1.4,
        braking_mps2: 2.5,
        gap_factor: 1.0,
    };

    #[test]
    fn the_desired_speed_is_an_equilibrium_on_free_road() {
        assert!(DRIVER.acceleration(30.0, None).abs() < 1e-12);
        assert!(DRIVER.acceleration(20.0, None) > 0.5);
        assert!(DRIVER.acceleration(33.0, None) < -0.3);
    }

    #[test]
    fn the_equilibrium_gap_is_the_time_gap_even_near_the_desired_speed() {
        for speed in [15.0, 29.9] {
            let lead = SeenLead {
                gap_m: 2.0 + 1.2 * speed,
                closing_mps: 0.0,
            };
            assert!(DRIVER.acceleration(speed, Some(lead)).abs() < 1e-9);
        }
    }

    #[test]
    fn a_driver_stops_behind_a_standing_car() {
        let (mut x, mut v) = (0.0, 30.0);
        for _ in 0..6000 {
            let lead = SeenLead {
                gap_m: 200.0 - x,
                closing_mps: v,
            };
            v = (v + 0.01 * DRIVER.acceleration(v, Some(lead))).max(0.0);
            x += 0.01 * v;
        }
        assert!(x < 200.0 && x > 190.0 && v < 0.2, "{x} {v}");
    }
}
