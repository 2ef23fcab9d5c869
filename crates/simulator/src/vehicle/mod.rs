//! The car: what throttle, brake and steering do to where it is.

mod actuators;
mod dynamic;
mod integrator;
mod kinematic;

use crate::{
    error::SimulatorError,
    road::CentreLine,
    scenario::{
        VehicleModel, VehicleSettings,
        setting::{Range, check},
    },
};
use maveric_domain::EgoState;

/// What the car is asked to do until the next integration step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// Acceleration along the car, in m/s², negative to brake.
    pub acceleration_mps2: f64,
    /// Angle of the front wheels, in rad, positive to the left.
    pub steering_rad: f64,
}

/// Where the car is, in the road frame; the point halfway between its axles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Along the road, in m.
    pub x_m: f64,
    /// To the left of the right lane's centre, in m.
    pub y_m: f64,
    /// Relative to the road, in rad, positive to the left.
    pub heading_rad: f64,
    /// Along the car, in m/s.
    pub speed_mps: f64,
}

/// The front axle, where Stanley's rule steers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrontAxle {
    /// Along the road, in m.
    pub x_m: f64,
    /// To the left of the right lane's centre, in m.
    pub y_m: f64,
    /// Heading of the car relative to the road at the axle, in rad.
    pub heading_rad: f64,
}

/// A car: something with a pose that carries out commands as well as its limits allow.
pub trait Vehicle {
    /// Drives one integration step on.
    fn step(&mut self, command: Command, line: &CentreLine);

    /// Where it is.
    fn pose(&self) -> Pose;

    /// Where its front axle is.
    fn front_axle(&self, line: &CentreLine) -> FrontAxle;

    /// Slides along a barrier beside it, at `y_m`, for one integration step: along the road, and slower.
    fn slide_along(&mut self, y_m: f64);

    /// Angle of the front wheels, in rad, positive to the left.
    fn steering_rad(&self) -> f64;

    /// Angle by which the front wheels must point further inside a bend than they roll, in rad: the tyres' slip.
    fn front_slip_rad(&self, curvature_per_m: f64) -> f64;
}

/// What a barrier takes from a car that slides along it, in m/s².
const SCRAPING_MPS2: f64 = 3.0;

impl VehicleSettings {
    /// The car of these settings at x = 0, along the road, `y_m` to the left of the right lane's centre.
    ///
    /// # Errors
    /// [`SimulatorError::Setting`] for a setting, a place or a speed (in m/s) outside its range.
    ///
    /// # Example
    /// Our car with our controllers and nothing else: it speeds up and changes lanes. A car of one's own in its place implements
    /// [`Vehicle`]; a controller of one's own gives another [`Command`].
    /// ```
    /// use maveric_simulator::{CentreLine, Command, Manoeuvre, PathShape, Scenario, Steering, VelocityController};
    ///
    /// let scenario = Scenario::paper();
    /// let settings = scenario.settings();
    /// let (rule, step_s) = (&settings.controllers, settings.vehicle.step_s);
    /// let straight = CentreLine::default();
    /// let mut car = settings.vehicle.build(0.0, 20.0)?;
    /// let mut speed = VelocityController::default();
    /// let mut steering = Steering::new(3.66, rule.stanley_gain_per_s, 0, PathShape::Bezier);
    /// steering.begin(Manoeuvre::Change { lane: 1, duration_s: 5.0 }, car.pose());
    /// for _ in 0..3000 {
    ///     let acceleration_mps2 = speed.command(rule, 25.0, car.pose().speed_mps, true, step_s);
    ///     let steering_rad = steering.angle_rad(&*car, &straight);
    ///     car.step(Command { acceleration_mps2, steering_rad }, &straight);
    /// }
    /// let pose = car.pose();
    /// assert!((pose.speed_mps - 25.0).abs() < 0.2 && (pose.y_m - 3.66).abs() < 0.05, "{pose:?}");
    /// # Ok::<(), maveric_simulator::SimulatorError>(())
    /// ```
    pub fn build(&self, y_m: f64, speed_mps: f64) -> Result<Box<dyn Vehicle>, SimulatorError> {
        self.check_all()?;
        check("y_m", y_m, Range::Finite)?;
        check("speed_mps", speed_mps, Range::NotNegative)?;
        Ok(build(self, y_m, speed_mps))
    }
}

/// The car of settings that were checked, in the middle of a lane, at x = 0.
pub(crate) fn build(settings: &VehicleSettings, y_m: f64, speed_mps: f64) -> Box<dyn Vehicle> {
    match settings.model {
        VehicleModel::Kinematic => {
            Box::new(kinematic::KinematicBicycle::new(settings, y_m, speed_mps))
        }
        VehicleModel::Dynamic => Box::new(dynamic::DynamicBicycle::new(settings, y_m, speed_mps)),
    }
}

/// Ego as a scene has it.
pub(crate) fn ego_state(car: &dyn Vehicle, length_m: f64) -> EgoState {
    let pose = car.pose();
    EgoState { x_m: pose.x_m, y_m: pose.y_m, speed_mps: pose.speed_mps, length_m }
}

/// The point `ahead_m` in front of (x, y), and the heading relative to the road there.
///
/// To second order in `ahead_m` over the radius of the bend: millimetres at the tightest radius allowed.
fn ahead_of(line: &CentreLine, x_m: f64, y_m: f64, heading_rad: f64, ahead_m: f64) -> FrontAxle {
    let (sin, cos) = libm::sincos(heading_rad);
    let curvature = line.curvature_per_m(x_m);
    let along = ahead_m * cos / (1.0 - curvature * y_m);
    FrontAxle {
        x_m: x_m + along,
        y_m: y_m + ahead_m * sin - 0.5 * curvature * along * ahead_m * cos,
        heading_rad: heading_rad - curvature * along,
    }
}
