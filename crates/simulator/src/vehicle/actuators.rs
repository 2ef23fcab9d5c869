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
    acceleration_mps2.clamp(
        -settings.braking_limit_mps2,
        settings.acceleration_limit_mps2,
    )
}

/// Turn of the front wheels over one step, in rad: at the limited rate towards the command.
pub(super) fn turn_rad(settings: &VehicleSettings, steering_rad: f64, command: Command) -> f64 {
    let most = settings.steering_rate_limit_rad_per_s * settings.step_s;
    let limit = settings.steering_limit_rad;
    (command.steering_rad.clamp(-limit, limit) - steering_rad).clamp(-most, most)
}
