//! Kinematic bicycle with lags and limits.

use super::{
    Command, FrontAxle, Pose, SCRAPING_MPS2, Vehicle,
    actuators::{jerk_mps3, turn_rad, within_limits},
    ahead_of,
    integrator::rk4,
};
use crate::{
    road::CentreLine,
    scenario::{Integrator, VehicleSettings},
};

/// A car that rolls where its wheels point.
///
/// # Source
/// Method section 5: x' = v cos(ψ + β), y' = v sin(ψ + β), ψ' = v sin β / l_r with β = atan(tan δ / 2), the
/// centre halfway between the axles; acceleration follows its command with a first-order lag. On a road that bends x and ψ are
/// those of the road frame, see [`CentreLine`].
#[derive(Debug, Clone)]
pub(crate) struct KinematicBicycle {
    settings: VehicleSettings,
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
    speed_mps: f64,
    acceleration_mps2: f64,
    steering_rad: f64,
}

impl KinematicBicycle {
    pub(super) fn new(settings: &VehicleSettings, y_m: f64, speed_mps: f64) -> Self {
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

    /// Actuators, speed and place one after the other, each with what the one before has just become.
    fn step_in_turn(&mut self, wanted_mps2: f64, turn_rad: f64, line: &CentreLine) {
        let s = &self.settings;
        let lag_s =
            if wanted_mps2 < self.acceleration_mps2 { s.brake_lag_s } else { s.throttle_lag_s };
        let most = s.jerk_limit_mps3 * s.step_s;
        let change = (wanted_mps2 - self.acceleration_mps2) * (s.step_s / lag_s).min(1.0);
        self.acceleration_mps2 += change.clamp(-most, most);
        let before = self.speed_mps;
        self.speed_mps = (before + self.acceleration_mps2 * s.step_s).max(0.0);
        self.steering_rad += turn_rad;

        let travelled = 0.5 * (before + self.speed_mps) * s.step_s;
        let slip = libm::atan(0.5 * libm::tan(self.steering_rad));
        let curvature = line.curvature_per_m(self.x_m);
        let along = travelled * libm::cos(self.heading_rad + slip) / (1.0 - curvature * self.y_m);
        self.x_m += along;
        self.y_m += travelled * libm::sin(self.heading_rad + slip);
        self.heading_rad += travelled * libm::sin(slip) / (0.5 * s.wheelbase_m) - curvature * along;
    }

    fn step_rk4(&mut self, wanted_mps2: f64, turn_rad: f64, line: &CentreLine) {
        let s = &self.settings;
        let steering = self.steering_rad;
        // The wheels turn evenly over the step; sin β and cos β at its start, middle and end.
        let slip = |share: f64| {
            let half = 0.5 * libm::tan(steering + share * turn_rad);
            let cos = 1.0 / (1.0 + half * half).sqrt();
            (half * cos, cos)
        };
        let slips = [slip(0.0), slip(0.5), slip(1.0)];
        let state = [self.x_m, self.y_m, self.heading_rad, self.speed_mps, self.acceleration_mps2];
        let after = rk4(state, s.step_s, |share, &[x, y, heading, speed, a]| {
            let (sin_slip, cos_slip) = slips[(2.0 * share) as usize];
            let (sin, cos) = libm::sincos(heading);
            let speed = speed.max(0.0);
            let curvature = line.curvature_per_m(x);
            let along = speed * (cos * cos_slip - sin * sin_slip) / (1.0 - curvature * y);
            [
                along,
                speed * (sin * cos_slip + cos * sin_slip),
                speed * sin_slip / (0.5 * s.wheelbase_m) - curvature * along,
                a,
                jerk_mps3(s, a, wanted_mps2),
            ]
        });
        [self.x_m, self.y_m, self.heading_rad, self.speed_mps, self.acceleration_mps2] = after;
        self.speed_mps = self.speed_mps.max(0.0);
        self.steering_rad += turn_rad;
    }
}

impl Vehicle for KinematicBicycle {
    fn step(&mut self, command: Command, line: &CentreLine) {
        let wanted = within_limits(&self.settings, command.acceleration_mps2);
        let turn = turn_rad(&self.settings, self.steering_rad, command);
        match self.settings.integrator {
            Integrator::InTurn => self.step_in_turn(wanted, turn, line),
            Integrator::Rk4 => self.step_rk4(wanted, turn, line),
        }
    }

    fn pose(&self) -> Pose {
        Pose {
            x_m: self.x_m,
            y_m: self.y_m,
            heading_rad: self.heading_rad,
            speed_mps: self.speed_mps,
        }
    }

    fn front_axle(&self, line: &CentreLine) -> FrontAxle {
        let half = 0.5 * self.settings.wheelbase_m;
        ahead_of(line, self.x_m, self.y_m, self.heading_rad, half)
    }

    fn slide_along(&mut self, y_m: f64) {
        (self.y_m, self.heading_rad) = (y_m, 0.0);
        self.speed_mps = (self.speed_mps - SCRAPING_MPS2 * self.settings.step_s).max(0.0);
    }

    fn steering_rad(&self) -> f64 {
        self.steering_rad
    }

    fn front_slip_rad(&self, _: f64) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{road::Segment, scenario::Scenario};

    fn settings(step_s: f64) -> VehicleSettings {
        VehicleSettings {
            step_s,
            integrator: Integrator::Rk4,
            ..Scenario::paper().settings().vehicle.clone()
        }
    }

    /// These settings with either integrator.
    fn both(settings: &VehicleSettings) -> [VehicleSettings; 2] {
        [Integrator::InTurn, Integrator::Rk4]
            .map(|integrator| VehicleSettings { integrator, ..settings.clone() })
    }

    fn straight() -> CentreLine {
        CentreLine::default()
    }

    fn command(acceleration_mps2: f64, steering_rad: f64) -> Command {
        Command { acceleration_mps2, steering_rad }
    }

    #[test]
    fn braking_stops_after_the_distance_of_lag_and_limit_and_does_not_reverse() {
        for settings in both(&settings(0.01)) {
            let mut car = KinematicBicycle::new(&settings, 0.0, 30.0);
            for _ in 0..1000 {
                car.step(command(-100.0, 0.0), &straight());
            }
            assert!(car.speed_mps.abs() < 1e-12);
            // a(t) = −b (1 − e^{−t/τ}), so v = v0 − b t + b τ (1 − e^{−t/τ}): it stands at T = v0 / b + τ, having come
            // v0²/2b + v0 τ − b τ²/2, but for a part of e^{−T/τ}.
            let (b, lag) = (settings.braking_limit_mps2, settings.brake_lag_s);
            let exact = 30.0 * 30.0 / (2.0 * b) + 30.0 * lag - 0.5 * b * lag * lag;
            let tolerance = if settings.integrator == Integrator::Rk4 { 0.001 } else { 0.35 };
            assert!(
                (car.x_m - exact).abs() < tolerance,
                "{:?} {} {exact}",
                settings.integrator,
                car.x_m
            );
        }
    }

    #[test]
    fn in_turn_a_step_brings_acceleration_nearer_by_its_share_of_the_lag() {
        let settings = VehicleSettings { integrator: Integrator::InTurn, ..settings(0.01) };
        for (wanted, lag) in [(0.1, settings.throttle_lag_s), (-0.1, settings.brake_lag_s)] {
            let mut car = KinematicBicycle::new(&settings, 0.0, 30.0);
            let mut left = wanted;
            for _ in 0..3 {
                car.step(command(wanted, 0.0), &straight());
                left *= 1.0 - settings.step_s / lag;
                assert!((car.acceleration_mps2 - (wanted - left)).abs() < 1e-12, "{wanted}");
            }
        }
    }

    #[test]
    fn a_held_steering_angle_drives_a_circle_of_the_right_radius() {
        for settings in both(&settings(0.01)) {
            let mut car = KinematicBicycle::new(&settings, 0.0, 10.0);
            car.steering_rad = 0.1;
            let (mut low, mut high) = (f64::MAX, f64::MIN);
            for _ in 0..4000 {
                car.step(command(0.0, 0.1), &straight());
                low = low.min(car.y_m);
                high = high.max(car.y_m);
            }
            let slip = (0.5 * 0.1_f64.tan()).atan();
            let radius = 0.5 * settings.wheelbase_m / slip.sin();
            assert!((0.5 * (high - low) - radius).abs() < 0.002, "{:?}", settings.integrator);
        }
    }

    #[test]
    fn no_command_exceeds_the_limits() {
        let settings = VehicleSettings { jerk_limit_mps3: 5.0, ..settings(0.01) };
        for settings in both(&settings) {
            let mut car = KinematicBicycle::new(&settings, 0.0, 30.0);
            for tick in 0..600 {
                let (a, steering) = (car.acceleration_mps2, car.steering_rad);
                let sign = if tick < 300 { 1.0 } else { -1.0 };
                car.step(command(sign * 50.0, sign * 5.0), &straight());
                assert!((-8.0..=3.0).contains(&car.acceleration_mps2));
                assert!(car.steering_rad.abs() <= 0.6 + 1e-12);
                assert!((car.acceleration_mps2 - a).abs() <= 5.0 * 0.01 + 1e-12);
                assert!((car.steering_rad - steering).abs() <= 0.5 * 0.01 + 1e-12);
            }
        }
    }

    /// Place after 4 s of braking and steering on a clothoid, by steps of `step_s`.
    fn end(step_s: f64, jerk_limit_mps3: f64) -> [f64; 3] {
        let line = CentreLine::new(&[
            Segment::Clothoid { length_m: 400.0, to_radius_m: Some(200.0) },
            Segment::Straight { length_m: 10.0 },
        ]);
        let settings = VehicleSettings { jerk_limit_mps3, ..settings(step_s) };
        let mut car = KinematicBicycle::new(&settings, 0.0, 30.0);
        car.steering_rad = 0.01;
        for _ in 0..(4.0 / step_s).round() as usize {
            car.step(command(-3.0, 0.01), &line);
        }
        [car.x_m, car.y_m, car.heading_rad]
    }

    fn order(run: impl Fn(f64) -> [f64; 3], coarse_s: f64) -> f64 {
        let exact = run(coarse_s / 64.0);
        let error = |step_s| {
            let at = run(step_s);
            at.iter().zip(exact).map(|(a, e)| (a - e).powi(2)).sum::<f64>()
        };
        0.5 * (error(coarse_s) / error(coarse_s / 2.0)).log2()
    }

    #[test]
    fn the_integration_is_of_order_four_and_a_limit_that_binds_inside_a_step_costs_order() {
        let smooth = order(|step_s| end(step_s, 1000.0), 0.1);
        assert!((smooth - 4.0).abs() < 0.3, "{smooth}");
        // The jerk bound lets go in the middle of a step.
        let bounded = order(|step_s| end(step_s, 7.3), 0.1);
        assert!(bounded > 1.0 && bounded < 3.7, "{bounded}");
    }

    #[test]
    fn the_road_frame_drives_the_path_of_the_map() {
        let line = CentreLine::new(&[
            Segment::Clothoid { length_m: 60.0, to_radius_m: Some(-90.0) },
            Segment::Arc { length_m: 80.0, radius_m: -90.0 },
            Segment::Clothoid { length_m: 60.0, to_radius_m: None },
        ]);
        let mut on_road = KinematicBicycle::new(&settings(0.01), 1.0, 12.0);
        let mut on_map = on_road.clone();
        for tick in 0..1200 {
            let wave = 0.04 * (0.01 * f64::from(tick)).sin() - 0.02;
            on_road.step(command(0.3, wave), &line);
            on_map.step(command(0.3, wave), &straight());
            let pose = line.map_pose(on_road.x_m, on_road.y_m);
            let apart = (pose.x_m - on_map.x_m).hypot(pose.y_m - on_map.y_m);
            assert!(apart < 1e-3, "{tick}: {apart}");
            let heading = pose.heading_rad + on_road.heading_rad - on_map.heading_rad;
            assert!(heading.abs() < 1e-5, "{tick}: {heading}");
        }
        assert!(on_road.x_m > 80.0);
    }
}
