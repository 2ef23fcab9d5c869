//! Velocity controller: PI on v̂.

use crate::scenario::ControllerSettings;

/// Proportional and integral action on the speed error, with anti-windup.
#[derive(Debug, Clone, Default)]
pub struct VelocityController {
    integral_mps2: f64,
}

/// The integral never holds more than this, in m/s²: nothing on a flat road needs more.
const INTEGRAL_LIMIT_MPS2: f64 = 1.0;
/// Error above which the integral rests, in m/s: what the proportional part is there for.
const INTEGRAL_BAND_MPS: f64 = 2.0;

impl VelocityController {
    /// Acceleration wanted, in m/s², from the speed wanted and the car's (both in m/s); called once a step of `step_s` (s).
    ///
    /// `leads` says whether this controller had the car in the step before: while another one has it, or the error
    /// is large, the integral fades instead of winding up.
    pub fn command(
        &mut self,
        settings: &ControllerSettings,
        wanted_mps: f64,
        speed_mps: f64,
        leads: bool,
        step_s: f64,
    ) -> f64 {
        let error = wanted_mps - speed_mps;
        if leads && error.abs() < INTEGRAL_BAND_MPS {
            self.integral_mps2 += settings.velocity_integral_per_s2 * error * step_s;
        } else {
            self.integral_mps2 *= 1.0 - step_s;
        }
        self.integral_mps2 = self.integral_mps2.clamp(-INTEGRAL_LIMIT_MPS2, INTEGRAL_LIMIT_MPS2);
        settings.velocity_gain_per_s * error + self.integral_mps2
    }
}

/// Moves an acceleration towards the wanted one (m/s²), within a step of `step_s` (s) no further than the jerk bound allows.
pub fn bounded_jerk(
    settings: &ControllerSettings,
    last_mps2: f64,
    wanted_mps2: f64,
    step_s: f64,
) -> f64 {
    let most = settings.jerk_limit_mps3 * step_s;
    last_mps2 + (wanted_mps2 - last_mps2).clamp(-most, most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        road::CentreLine,
        scenario::Scenario,
        vehicle::{Command, build},
    };

    #[test]
    fn it_reaches_the_speed_without_much_overshoot() {
        let settings = ControllerSettings::default();
        for (from, to) in [(20.0, 30.0), (30.0, 20.0), (25.0, 26.0)] {
            let mut car = build(&Scenario::paper().settings().vehicle, 0.0, from);
            let mut controller = VelocityController::default();
            let (mut command, mut furthest) = (0.0, f64::MIN);
            let sign: f64 = if to > from { 1.0 } else { -1.0 };
            for tick in 0..1200 {
                let wanted = controller.command(&settings, to, car.pose().speed_mps, true, 0.05);
                command = bounded_jerk(&settings, command, wanted.clamp(-8.0, 3.0), 0.05);
                for _ in 0..5 {
                    let command = Command { acceleration_mps2: command, steering_rad: 0.0 };
                    car.step(command, &CentreLine::default());
                }
                furthest = furthest.max(sign * (car.pose().speed_mps - to));
                if tick > 400 {
                    assert!((car.pose().speed_mps - to).abs() < 0.2, "{from} {to} {tick}");
                }
            }
            assert!(furthest < 0.6, "{from} -> {to}: {furthest}");
        }
    }

    #[test]
    fn a_long_wait_behind_a_lead_does_not_wind_up() {
        let settings = ControllerSettings::default();
        let mut controller = VelocityController::default();
        for _ in 0..2000 {
            controller.command(&settings, 30.0, 28.5, false, 0.05);
        }
        let command = controller.command(&settings, 30.0, 30.0, false, 0.05);
        assert!(command.abs() < 1e-9);
    }

    #[test]
    fn the_integral_grows_while_it_leads_fades_while_not_and_has_an_end() {
        let settings = ControllerSettings::default();
        let mut controller = VelocityController::default();
        let mut next = |wanted: f64, leads| controller.command(&settings, wanted, 20.0, leads, 0.1);
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
        near(next(21.0, true), 0.6 + 0.005);
        near(next(21.0, true), 0.6 + 0.01);
        near(next(21.0, false), 0.6 + 0.009);
        // Too far off for the integral to take part.
        near(next(22.0, true), 1.2 + 0.0081);
        for (wanted, end) in [(21.9, 1.0), (18.1, -1.0)] {
            let last = (0..3000).map(|_| next(wanted, true)).last().unwrap();
            near(last, 0.6 * (wanted - 20.0) + end);
        }
    }

    #[test]
    fn an_acceleration_changes_by_the_bound_at_most() {
        let settings = ControllerSettings::default();
        for (last, wanted, expected) in
            [(0.0, 1.0, 0.2), (0.0, -1.0, -0.2), (0.0, 0.1, 0.1), (1.0, 0.0, 0.8)]
        {
            assert!((bounded_jerk(&settings, last, wanted, 0.05) - expected).abs() < 1e-12);
        }
    }
}
