//! Throttle, brake and steering: how commands become acceleration and wheel angle.

use super::Command;
use crate::scenario::VehicleSettings;

/// Rate of change of the acceleration, in m/s³, towards `wanted_mps2`: a first-order lag, bounded.
pub(super) fn jerk_mps3(
    settings: &VehicleSettings,
    acceleration_mps2: f64,
    wanted_mps2: f64,
) -> f64 {
    let lag_s = if wanted_mps2 < acceleration_mps2 {
        settings.brake_lag_s
    } else {
        settings.throttle_lag_s
    };
    let limit = settings.jerk_limit_mps3;
    ((wanted_mps2 - acceleration_mps2) / lag_s).clamp(-limit, limit)
}

/// The command within what throttle and brake can give, in m/s².
pub(super) fn within_limits(settings: &VehicleSettings, acceleration_mps2: f64) -> f64 {
    acceleration_mps2.clamp(-settings.braking_limit_mps2, settings.acceleration_limit_mps2)
}

/// Turn of the front wheels over one step, in rad: at the limited rate towards the command.
pub(super) fn turn_rad(settings: &VehicleSettings, steering_rad: f64, command: Command) -> f64 {
    let most = settings.steering_rate_limit_rad_per_s * settings.step_s;
    let limit = settings.steering_limit_rad;
    (command.steering_rad.clamp(-limit, limit) - steering_rad).clamp(-most, most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;

    #[test]
    fn commands_come_late_within_limits_and_at_limited_rates() {
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
        let scenario = Scenario::paper();
        let car = &scenario.settings().vehicle;
        // A lag of 0.3 s to the throttle and of half that to the brake, 100 m/s³ at most.
        near(jerk_mps3(car, 1.0, 1.6), 2.0);
        near(jerk_mps3(car, 1.0, 0.7), -2.0);
        near(jerk_mps3(car, 20.0, -8.0), -100.0);
        near(within_limits(car, 5.0), 3.0);
        near(within_limits(car, -9.0), -8.0);
        near(within_limits(car, -7.9), -7.9);
        let turn = |from_rad: f64, steering_rad: f64| {
            let command = Command { acceleration_mps2: 0.0, steering_rad };
            turn_rad(car, from_rad, command)
        };
        // 0.5 rad/s, and no further than 0.6 rad.
        let most = 0.5 * car.step_s;
        near(turn(0.0, 0.5 * most), 0.5 * most);
        near(turn(0.0, 0.3), most);
        near(turn(0.0, -0.3), -most);
        near(turn(0.6, 0.9), 0.0);
    }
}
