//! The car: what throttle, brake and steering do to where it is.

mod actuators;
mod dynamic;
mod integrator;
mod kinematic;

use crate::{
    road::CentreLine,
    scenario::{VehicleModel, VehicleSettings},
};
use maveric_domain::EgoState;

/// What the car is asked to do until the next integration step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Command {
    /// Acceleration along the car, in m/s², negative to brake.
    pub(crate) acceleration_mps2: f64,
    /// Angle of the front wheels, in rad, positive to the left.
    pub(crate) steering_rad: f64,
}

/// Where the car is, in the road frame; the point halfway between its axles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    /// Relative to the road, in rad.
    pub(crate) heading_rad: f64,
    pub(crate) speed_mps: f64,
}

/// The front axle, where Stanley's rule steers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FrontAxle {
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    /// Heading of the car relative to the road at the axle, in rad.
    pub(crate) heading_rad: f64,
}

/// A car: something with a pose that carries out commands as well as its limits allow.
pub(crate) trait Vehicle {
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

/// The car of the settings, in the middle of a lane, at x = 0.
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
    EgoState {
        x_m: pose.x_m,
        y_m: pose.y_m,
        speed_mps: pose.speed_mps,
        length_m,
    }
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
