//! Dynamic bicycle: two axles on linear tyres that saturate at the friction limit.

use super::{
    Command, FrontAxle, Pose, SCRAPING_MPS2, Vehicle,
    actuators::{jerk_mps3, turn_rad, within_limits},
    ahead_of,
    integrator::rk4,
};
use crate::{
    road::CentreLine,
    scenario::{DynamicsSettings, VehicleSettings},
};

/// Standard gravity, in m/s².
const GRAVITY_MPS2: f64 = 9.806_65;
/// Below this speed slip angles mean nothing and the car rolls where its wheels point, in m/s.
const ROLLS_BELOW_MPS: f64 = 3.0;

/// A car with mass: side slip and yaw rate are states of their own.
///
/// With u and w the speeds along and across the car at its centre of mass, r its yaw rate and a the acceleration of its
/// drive: u' = a + w r − F_f sin δ / m, w' = (F_f cos δ + F_r) / m − u r, r' = (l_f F_f cos δ − l_r F_r) / I, with slip angles
/// α_f = atan((w + l_f r) / u) − δ and α_r = atan((w − l_r r) / u), and forces F = −C α, no larger than
/// √((μ F_z)² − (F_z a / g)²): what friction leaves beside drive and brakes.
///
/// # Source
/// Rajamani, Vehicle Dynamics and Control, sections 2.3 and 2.4, with the friction circle of section 13.
#[derive(Debug, Clone)]
pub(crate) struct DynamicBicycle {
    settings: VehicleSettings,
    // Of the centre of mass.
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
    along_mps: f64,
    across_mps: f64,
    yaw_rate_rad_per_s: f64,
    acceleration_mps2: f64,
    steering_rad: f64,
}

/// Side forces of the axles, in N.
#[derive(Debug, Clone, Copy)]
struct SideForces {
    front_n: f64,
    rear_n: f64,
}

impl DynamicsSettings {
    fn rear_axle_m(&self, wheelbase_m: f64) -> f64 {
        wheelbase_m - self.front_axle_m
    }

    fn side_forces(
        &self,
        wheelbase_m: f64,
        [along, across, yaw_rate]: [f64; 3],
        steering_rad: f64,
        acceleration_mps2: f64,
    ) -> SideForces {
        let (front, rear) = (self.front_axle_m, self.rear_axle_m(wheelbase_m));
        let weight = self.mass_kg * GRAVITY_MPS2;
        let used = acceleration_mps2 / GRAVITY_MPS2;
        let left = (self.friction * self.friction - used * used).max(0.0).sqrt();
        let force = |slip_rad: f64, stiffness: f64, load_share: f64| {
            let limit = left * weight * load_share;
            (-stiffness * slip_rad).clamp(-limit, limit)
        };
        let front_slip = libm::atan2(across + front * yaw_rate, along) - steering_rad;
        let rear_slip = libm::atan2(across - rear * yaw_rate, along);
        SideForces {
            front_n: force(front_slip, self.front_stiffness_n_per_rad, rear / wheelbase_m),
            rear_n: force(rear_slip, self.rear_stiffness_n_per_rad, front / wheelbase_m),
        }
    }
}

impl DynamicBicycle {
    pub(super) fn new(settings: &VehicleSettings, y_m: f64, speed_mps: f64) -> Self {
        let mut car = Self {
            settings: settings.clone(),
            x_m: 0.0,
            y_m,
            heading_rad: 0.0,
            along_mps: speed_mps,
            across_mps: 0.0,
            yaw_rate_rad_per_s: 0.0,
            acceleration_mps2: 0.0,
            steering_rad: 0.0,
        };
        car.x_m = -car.middle_m();
        car
    }

    /// The point halfway between the axles, ahead of the centre of mass, in m.
    fn middle_m(&self) -> f64 {
        self.settings.dynamics.front_axle_m - 0.5 * self.settings.wheelbase_m
    }

    fn step_rolling(&mut self, wanted_mps2: f64, turn_rad: f64, line: &CentreLine) {
        let s = &self.settings;
        let rear = s.dynamics.rear_axle_m(s.wheelbase_m);
        let steering = self.steering_rad;
        let state = [self.x_m, self.y_m, self.heading_rad, self.along_mps, self.acceleration_mps2];
        let after = rk4(state, s.step_s, |share, &[x, y, heading, along, a]| {
            let along = along.max(0.0);
            let yaw_rate = along * libm::tan(steering + share * turn_rad) / s.wheelbase_m;
            let place = velocity(line, [x, y, heading], [along, rear * yaw_rate, yaw_rate]);
            [place[0], place[1], place[2], a, jerk_mps3(s, a, wanted_mps2)]
        });
        [self.x_m, self.y_m, self.heading_rad, self.along_mps, self.acceleration_mps2] = after;
        self.along_mps = self.along_mps.max(0.0);
        self.steering_rad += turn_rad;
        self.yaw_rate_rad_per_s = self.along_mps * libm::tan(self.steering_rad) / s.wheelbase_m;
        self.across_mps = rear * self.yaw_rate_rad_per_s;
    }

    fn step_sliding(&mut self, wanted_mps2: f64, turn_rad: f64, line: &CentreLine) {
        let s = &self.settings;
        let d = &s.dynamics;
        let (front, rear) = (d.front_axle_m, d.rear_axle_m(s.wheelbase_m));
        let steering = self.steering_rad;
        let wheels = [0.0, 0.5, 1.0].map(|share| libm::sincos(steering + share * turn_rad));
        let state = [
            self.x_m,
            self.y_m,
            self.heading_rad,
            self.along_mps,
            self.across_mps,
            self.yaw_rate_rad_per_s,
            self.acceleration_mps2,
        ];
        let after = rk4(state, s.step_s, |share, &[x, y, heading, u, w, r, a]| {
            let force = d.side_forces(s.wheelbase_m, [u, w, r], steering + share * turn_rad, a);
            let (sin, cos) = wheels[(2.0 * share) as usize];
            let place = velocity(line, [x, y, heading], [u, w, r]);
            [
                place[0],
                place[1],
                place[2],
                a + w * r - force.front_n * sin / d.mass_kg,
                (force.front_n * cos + force.rear_n) / d.mass_kg - u * r,
                (front * force.front_n * cos - rear * force.rear_n) / d.yaw_inertia_kg_m2,
                jerk_mps3(s, a, wanted_mps2),
            ]
        });
        [
            self.x_m,
            self.y_m,
            self.heading_rad,
            self.along_mps,
            self.across_mps,
            self.yaw_rate_rad_per_s,
            self.acceleration_mps2,
        ] = after;
        self.along_mps = self.along_mps.max(0.0);
        self.steering_rad += turn_rad;
    }
}

/// Rates of x, y and ψ in the road frame.
fn velocity(line: &CentreLine, [x, y, heading]: [f64; 3], [u, w, r]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = libm::sincos(heading);
    let curvature = line.curvature_per_m(x);
    let along = (u * cos - w * sin) / (1.0 - curvature * y);
    [along, u * sin + w * cos, r - curvature * along]
}

impl Vehicle for DynamicBicycle {
    fn step(&mut self, command: Command, line: &CentreLine) {
        let grip = self.settings.dynamics.friction * GRAVITY_MPS2;
        let wanted = within_limits(&self.settings, command.acceleration_mps2).clamp(-grip, grip);
        let turn = turn_rad(&self.settings, self.steering_rad, command);
        if self.along_mps < ROLLS_BELOW_MPS {
            self.step_rolling(wanted, turn, line);
        } else {
            self.step_sliding(wanted, turn, line);
        }
    }

    fn pose(&self) -> Pose {
        let (sin, cos) = libm::sincos(self.heading_rad);
        Pose {
            x_m: self.x_m + self.middle_m() * cos,
            y_m: self.y_m + self.middle_m() * sin,
            heading_rad: self.heading_rad,
            speed_mps: libm::hypot(self.along_mps, self.across_mps),
        }
    }

    fn front_axle(&self, line: &CentreLine) -> FrontAxle {
        let ahead_m = self.settings.dynamics.front_axle_m;
        ahead_of(line, self.x_m, self.y_m, self.heading_rad, ahead_m)
    }

    fn slide_along(&mut self, y_m: f64) {
        (self.y_m, self.heading_rad) = (y_m, 0.0);
        (self.across_mps, self.yaw_rate_rad_per_s) = (0.0, 0.0);
        self.along_mps = (self.along_mps - SCRAPING_MPS2 * self.settings.step_s).max(0.0);
    }

    fn steering_rad(&self) -> f64 {
        self.steering_rad
    }

    fn front_slip_rad(&self, curvature_per_m: f64) -> f64 {
        if self.along_mps < ROLLS_BELOW_MPS {
            return 0.0;
        }
        let s = &self.settings;
        let load = s.dynamics.mass_kg * s.dynamics.rear_axle_m(s.wheelbase_m) / s.wheelbase_m;
        load * self.along_mps.powi(2) * curvature_per_m / s.dynamics.front_stiffness_n_per_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        road::Segment,
        scenario::{Scenario, VehicleModel},
    };

    fn settings(step_s: f64) -> VehicleSettings {
        VehicleSettings {
            model: VehicleModel::Dynamic,
            step_s,
            ..Scenario::paper().settings().vehicle.clone()
        }
    }

    fn straight() -> CentreLine {
        CentreLine::default()
    }

    /// Speeds and yaw rate after the wheels have stood at `steering_rad` for a while at a held speed.
    fn settled(speed_mps: f64, steering_rad: f64) -> DynamicBicycle {
        let mut car = DynamicBicycle::new(&settings(0.005), 0.0, speed_mps);
        for _ in 0..8000 {
            let acceleration_mps2 = 5.0 * (speed_mps - car.along_mps);
            let command = Command { acceleration_mps2, steering_rad };
            car.step(command, &straight());
        }
        car
    }

    #[test]
    fn a_held_steering_angle_ends_in_the_steady_circle_of_the_understeer_gradient() {
        let s = settings(0.01);
        let d = &s.dynamics;
        let (front, rear) = (d.front_axle_m, d.rear_axle_m(s.wheelbase_m));
        // K = m / L · (l_r / C_f − l_f / C_r); on the steady circle δ = L / R + K v² / R.
        let gradient = d.mass_kg / s.wheelbase_m
            * (rear / d.front_stiffness_n_per_rad - front / d.rear_stiffness_n_per_rad);
        assert!(gradient > 0.0, "an understeering car");
        for speed in [10.0, 20.0, 30.0] {
            let steering = 0.004;
            let car = settled(speed, steering);
            let curvature = car.yaw_rate_rad_per_s / car.along_mps;
            let expected = steering / (s.wheelbase_m + gradient * speed * speed);
            let off = curvature / expected - 1.0;
            // The formula drops the part of the drive's force that holds the speed, and cos δ.
            assert!(off.abs() < 2e-3, "{speed}: {curvature} {expected}");
        }
        // The gradient itself, from two speeds at the same lateral acceleration level.
        let (slow, fast) = (settled(10.0, 0.004), settled(30.0, 0.004));
        let measured = |car: &DynamicBicycle| {
            let curvature = car.yaw_rate_rad_per_s / car.along_mps;
            (0.004 / curvature - s.wheelbase_m, car.along_mps.powi(2))
        };
        let ((a, v2), (b, u2)) = (measured(&slow), measured(&fast));
        let slope = (b - a) / (u2 - v2);
        assert!((slope / gradient - 1.0).abs() < 0.01, "{slope} {gradient}");
    }

    #[test]
    fn at_walking_pace_it_drives_the_circle_of_the_kinematic_car() {
        let car = settled(2.0, 0.2);
        let wheelbase = car.settings.wheelbase_m;
        let curvature = car.yaw_rate_rad_per_s / car.along_mps;
        assert!((curvature - 0.2_f64.tan() / wheelbase).abs() < 1e-9);
    }

    #[test]
    fn no_circle_is_driven_faster_than_friction_allows() {
        let car = settled(30.0, 0.3);
        let lateral = car.yaw_rate_rad_per_s * car.along_mps;
        let grip = car.settings.dynamics.friction * GRAVITY_MPS2;
        assert!(lateral <= grip + 1e-6, "{lateral}");
        assert!(lateral > 0.5 * grip, "{lateral}");
    }

    #[test]
    fn straight_braking_takes_the_closed_form_distance() {
        let s = settings(0.01);
        let mut car = DynamicBicycle::new(&s, 0.0, 30.0);
        let start = car.x_m;
        for _ in 0..1000 {
            let command = Command { acceleration_mps2: -100.0, steering_rad: 0.0 };
            car.step(command, &straight());
        }
        let (b, lag) = (s.braking_limit_mps2, s.brake_lag_s);
        let exact = 30.0 * 30.0 / (2.0 * b) + 30.0 * lag - 0.5 * b * lag * lag;
        assert!((car.x_m - start - exact).abs() < 0.001, "{}", car.x_m - start);
        assert!(car.along_mps.abs() < 1e-12 && car.y_m.abs() < 1e-12);
    }

    #[test]
    fn tyres_take_the_energy_that_the_car_loses_and_never_give_any() {
        let s = settings(0.001);
        let d = &s.dynamics;
        let (front, rear) = (d.front_axle_m, d.rear_axle_m(s.wheelbase_m));
        let mut car = DynamicBicycle::new(&s, 0.0, 30.0);
        let energy = |c: &DynamicBicycle| {
            0.5 * d.mass_kg * (c.along_mps.powi(2) + c.across_mps.powi(2))
                + 0.5 * d.yaw_inertia_kg_m2 * c.yaw_rate_rad_per_s.powi(2)
        };
        // Power of the tyres: force times the speed of the axle along it.
        let power = |c: &DynamicBicycle| {
            let state = [c.along_mps, c.across_mps, c.yaw_rate_rad_per_s];
            let force = d.side_forces(s.wheelbase_m, state, c.steering_rad, 0.0);
            let (sin, cos) = c.steering_rad.sin_cos();
            let at_front = cos * (c.across_mps + front * c.yaw_rate_rad_per_s) - sin * c.along_mps;
            let at_rear = c.across_mps - rear * c.yaw_rate_rad_per_s;
            force.front_n * at_front + force.rear_n * at_rear
        };
        let (first, mut work) = (energy(&car), 0.0);
        for tick in 0..6000 {
            let before = power(&car);
            let command = Command {
                acceleration_mps2: 0.0,
                // Slow enough for the rate limit, strong enough to saturate the tyres.
                steering_rad: 0.08 * (0.002 * f64::from(tick)).sin(),
            };
            let last = energy(&car);
            car.step(command, &straight());
            assert!(energy(&car) <= last + 1e-6 && car.along_mps > ROLLS_BELOW_MPS, "{tick}");
            work += 0.5e-3 * (before + power(&car));
        }
        let lost = energy(&car) - first;
        assert!(lost < -1e4 && (lost - work).abs() < 1e-3 * lost.abs(), "{lost} {work}");
    }

    #[test]
    fn the_integration_is_of_order_four_while_no_tyre_saturates() {
        let run = |step_s: f64, steering_rad: f64| {
            let line = CentreLine::new(&[
                Segment::Clothoid { length_m: 400.0, to_radius_m: Some(200.0) },
                Segment::Straight { length_m: 10.0 },
            ]);
            let mut car = DynamicBicycle::new(&settings(step_s), 0.0, 30.0);
            car.steering_rad = steering_rad;
            for _ in 0..(2.0 / step_s).round() as usize {
                let command = Command { acceleration_mps2: -2.0, steering_rad };
                car.step(command, &line);
            }
            (car.x_m, car.y_m)
        };
        let order = |steering_rad: f64| {
            let exact = run(0.02 / 32.0, steering_rad);
            let error = |step_s| {
                let at = run(step_s, steering_rad);
                (at.0 - exact.0).hypot(at.1 - exact.1)
            };
            (error(0.02) / error(0.01)).log2()
        };
        assert!((order(0.01) - 4.0).abs() < 0.4, "{}", order(0.01));
        assert!(order(0.2) < 3.5, "{}", order(0.2));
    }
}
