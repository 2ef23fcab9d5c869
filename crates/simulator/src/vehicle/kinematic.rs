//! Kinematic bicycle with lags and limits.

use crate::{road::CentreLine, scenario::VehicleSettings};
use maveric_domain::EgoState;

/// Time between two integration steps, in s.
pub(crate) const STEP_S: f64 = 0.01;

/// A car that rolls where its front wheel points.
///
/// # Source
/// Method section 5: x' = v cos(ψ + β), y' = v sin(ψ + β), ψ' = v sin β / l_r with β = atan(tan δ / 2), the
/// centre halfway between the axles; acceleration follows its command with a first-order lag. On a road that bends x and ψ are
/// those of the road frame, see [`CentreLine`].
#[derive(Debug, Clone)]
pub(crate) struct KinematicBicycle {
    settings: VehicleSettings,
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    pub(crate) heading_rad: f64,
    pub(crate) speed_mps: f64,
    pub(crate) acceleration_mps2: f64,
    pub(crate) steering_rad: f64,
}

impl KinematicBicycle {
    pub(crate) fn new(settings: &VehicleSettings, y_m: f64, speed_mps: f64) -> Self {
        Self {
            settings: settings.clone(),
            x_m: 0.0,
            y_m,
            heading_rad: 0.0,
            speed_mps,
            acceleration_mps2: 0.0,
            steering_rad: 0.0,
        }
    }

    /// Position of the front axle, in m, and the car's heading relative to the road there, in rad.
    ///
    /// To second order in the wheelbase over the radius of the bend: below a millimetre at 50 m.
    pub(crate) fn front_axle(&self, line: &CentreLine) -> (f64, f64, f64) {
        let half = 0.5 * self.settings.wheelbase_m;
        let (sin, cos) = self.heading_rad.sin_cos();
        let curvature = line.curvature_per_m(self.x_m);
        let along = half * cos / (1.0 - curvature * self.y_m);
        (
            self.x_m + along,
            self.y_m + half * sin - 0.5 * curvature * along * half * cos,
            self.heading_rad - curvature * along,
        )
    }

    pub(crate) fn state(&self) -> EgoState {
        EgoState {
            x_m: self.x_m,
            y_m: self.y_m,
            speed_mps: self.speed_mps,
            length_m: self.settings.length_m,
        }
    }

    /// Drives one [`STEP_S`] on, as near to the commands as lags and limits allow.
    pub(crate) fn step(&mut self, acceleration_mps2: f64, steering_rad: f64, line: &CentreLine) {
        let s = &self.settings;
        let wanted = acceleration_mps2.clamp(-s.braking_limit_mps2, s.acceleration_limit_mps2);
        let lag_s = if wanted < self.acceleration_mps2 {
            s.brake_lag_s
        } else {
            s.throttle_lag_s
        };
        self.acceleration_mps2 += (wanted - self.acceleration_mps2) * (STEP_S / lag_s).min(1.0);
        let before = self.speed_mps;
        self.speed_mps = (before + self.acceleration_mps2 * STEP_S).max(0.0);
        let turn = s.steering_rate_limit_rad_per_s * STEP_S;
        let target = steering_rad.clamp(-s.steering_limit_rad, s.steering_limit_rad);
        self.steering_rad += (target - self.steering_rad).clamp(-turn, turn);

        let travelled = 0.5 * (before + self.speed_mps) * STEP_S;
        let slip = (0.5 * self.steering_rad.tan()).atan();
        let curvature = line.curvature_per_m(self.x_m);
        let along = travelled * (self.heading_rad + slip).cos() / (1.0 - curvature * self.y_m);
        self.x_m += along;
        self.y_m += travelled * (self.heading_rad + slip).sin();
        self.heading_rad += travelled * slip.sin() / (0.5 * s.wheelbase_m) - curvature * along;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;

    fn car(speed_mps: f64) -> KinematicBicycle {
        KinematicBicycle::new(&Scenario::paper().settings().vehicle, 0.0, speed_mps)
    }

    #[test]
    fn braking_stops_and_does_not_reverse() {
        let mut car = car(30.0);
        for _ in 0..1000 {
            car.step(-100.0, 0.0, &CentreLine::default());
        }
        assert!(car.speed_mps.abs() < 1e-12);
        // 30²/(2·8) = 56 m and the lag's distance.
        assert!(car.x_m > 56.0 && car.x_m < 64.0, "{}", car.x_m);
    }

    #[test]
    fn a_held_steering_angle_drives_a_circle_of_the_right_radius() {
        let mut car = car(10.0);
        car.steering_rad = 0.1;
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for _ in 0..4000 {
            car.step(0.0, 0.1, &CentreLine::default());
            low = low.min(car.y_m);
            high = high.max(car.y_m);
        }
        let wheelbase = Scenario::paper().settings().vehicle.wheelbase_m;
        let slip = (0.5 * 0.1_f64.tan()).atan();
        let radius = 0.5 * wheelbase / slip.sin();
        assert!((0.5 * (high - low) - radius).abs() < 0.05);
    }

    #[test]
    fn no_command_exceeds_the_limits() {
        let mut car = car(20.0);
        for _ in 0..300 {
            car.step(50.0, 5.0, &CentreLine::default());
            assert!(car.acceleration_mps2 <= 3.0 && car.steering_rad <= 0.6);
        }
    }
}
