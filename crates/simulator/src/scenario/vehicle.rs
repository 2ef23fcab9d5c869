//! Settings of ego's car.

use super::{Range, check};
use crate::{error::SimulatorError, planner::PLANNING_STEP_S};
use serde::{Deserialize, Serialize};

/// What the car is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VehicleModel {
    /// It rolls where its wheels point.
    #[default]
    Kinematic,
    /// It has mass, and tyres that slip; see [`DynamicsSettings`].
    Dynamic,
}

/// How the kinematic car is moved on by one step; the dynamic one always by Runge and Kutta's method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Runge and Kutta's method of order four.
    #[default]
    Rk4,
    /// Actuators, speed and place one after the other, of order one: what the paper's scenario is driven with, so that
    /// its drives stay what they were.
    InTurn,
}

/// Mass and tyres of the dynamic car.
///
/// # Source
/// Chosen: a mid-size car that understeers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DynamicsSettings {
    /// Mass, in kg.
    pub mass_kg: f64,
    /// Moment of inertia about the vertical axis, in kg m².
    pub yaw_inertia_kg_m2: f64,
    /// Centre of mass to front axle, in m.
    pub front_axle_m: f64,
    /// Cornering stiffness of both front tyres together, in N/rad.
    pub front_stiffness_n_per_rad: f64,
    /// Cornering stiffness of both rear tyres together, in N/rad.
    pub rear_stiffness_n_per_rad: f64,
    /// Friction coefficient μ of tyres on road.
    pub friction: f64,
}

impl DynamicsSettings {
    pub(crate) const PAPER: Self = Self {
        mass_kg: 1550.0,
        yaw_inertia_kg_m2: 2800.0,
        front_axle_m: 1.25,
        front_stiffness_n_per_rad: 130_000.0,
        rear_stiffness_n_per_rad: 150_000.0,
        friction: 0.9,
    };

    fn check(&self, vehicle: &VehicleSettings) -> Result<(), SimulatorError> {
        // Beyond this l_f C_f > l_r C_r: the car oversteers, and above some speed nothing keeps it straight.
        let neutral = vehicle.wheelbase_m * self.rear_stiffness_n_per_rad
            / (self.front_stiffness_n_per_rad + self.rear_stiffness_n_per_rad);
        let stiffness = Range::Within(2e4, 1e6, "20000 to 1000000 N/rad");
        // Brakes that the road cannot hold would make the safe distance a promise nobody keeps.
        let grip = Range::Within(
            vehicle.braking_limit_mps2 / 9.806_65,
            1.5,
            "braking_limit_mps2 over gravity to 1.5",
        );
        let ranges = [
            (
                "mass_kg",
                self.mass_kg,
                Range::Within(300.0, 4e4, "300 to 40000 kg"),
            ),
            (
                "yaw_inertia_kg_m2",
                self.yaw_inertia_kg_m2,
                Range::Within(100.0, 1e6, "100 to 1000000 kg m²"),
            ),
            (
                "front_axle_m",
                self.front_axle_m,
                Range::Within(
                    0.2 * vehicle.wheelbase_m,
                    neutral,
                    "a fifth of wheelbase_m to where the car would oversteer",
                ),
            ),
            (
                "front_stiffness_n_per_rad",
                self.front_stiffness_n_per_rad,
                stiffness,
            ),
            (
                "rear_stiffness_n_per_rad",
                self.rear_stiffness_n_per_rad,
                stiffness,
            ),
            ("friction", self.friction, grip),
        ];
        ranges
            .into_iter()
            .try_for_each(|(key, found, range)| check("vehicle.dynamics", key, found, range))
    }
}

fn usual_step_s() -> f64 {
    VehicleSettings::PAPER.step_s
}

fn usual_jerk_mps3() -> f64 {
    VehicleSettings::PAPER.jerk_limit_mps3
}

fn usual_dynamics() -> DynamicsSettings {
    DynamicsSettings::PAPER
}

/// Ego's car; all vehicles share its length and width.
///
/// # Source
/// Method section 5 for the limits of acceleration and braking; the rest is ours, a mid-size car.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleSettings {
    /// Bumper to bumper, in m.
    pub length_m: f64,
    /// Side to side, in m.
    pub width_m: f64,
    /// Axle to axle, in m.
    pub wheelbase_m: f64,
    /// Strongest acceleration, in m/s².
    pub acceleration_limit_mps2: f64,
    /// Strongest braking, in m/s², positive.
    pub braking_limit_mps2: f64,
    /// Time constant of the throttle, in s.
    pub throttle_lag_s: f64,
    /// Time constant of the brake, in s.
    pub brake_lag_s: f64,
    /// Largest angle of the front wheels, in rad.
    pub steering_limit_rad: f64,
    /// Fastest turn of the front wheels, in rad/s.
    pub steering_rate_limit_rad_per_s: f64,
    /// Fastest change of acceleration that throttle and brake allow, in m/s³; the usual one is above what the lags do.
    #[serde(default = "usual_jerk_mps3")]
    pub jerk_limit_mps3: f64,
    /// What the car is made of.
    #[serde(default)]
    pub model: VehicleModel,
    /// How it is moved on by one step.
    #[serde(default)]
    pub integrator: Integrator,
    /// Time between two integration steps, in s: a whole fraction of 0.05 s.
    #[serde(default = "usual_step_s")]
    pub step_s: f64,
    /// Mass and tyres, for the dynamic model.
    #[serde(default = "usual_dynamics")]
    pub dynamics: DynamicsSettings,
}

impl VehicleSettings {
    pub(crate) const PAPER: Self = Self {
        length_m: 4.7,
        width_m: 1.9,
        wheelbase_m: 2.8,
        acceleration_limit_mps2: 3.0,
        braking_limit_mps2: 8.0,
        throttle_lag_s: 0.3,
        brake_lag_s: 0.15,
        steering_limit_rad: 0.6,
        steering_rate_limit_rad_per_s: 0.5,
        jerk_limit_mps3: 100.0,
        model: VehicleModel::Kinematic,
        integrator: Integrator::InTurn,
        step_s: 0.01,
        dynamics: DynamicsSettings::PAPER,
    };

    /// Integration steps between two rows of a drive.
    pub(crate) fn steps_per_row(&self) -> usize {
        (PLANNING_STEP_S / self.step_s).round() as usize
    }

    pub(crate) fn check(&self) -> Result<(), SimulatorError> {
        let ranges = [
            (
                "length_m",
                self.length_m,
                Range::Within(1.0, 25.0, "1 to 25 m"),
            ),
            (
                "width_m",
                self.width_m,
                Range::Within(0.5, 2.6, "0.5 to 2.6 m"),
            ),
            (
                "wheelbase_m",
                self.wheelbase_m,
                Range::Within(0.5, 15.0, "0.5 to 15 m"),
            ),
            (
                "acceleration_limit_mps2",
                self.acceleration_limit_mps2,
                Range::Within(0.5, 10.0, "0.5 to 10 m/s²"),
            ),
            (
                "braking_limit_mps2",
                self.braking_limit_mps2,
                Range::Within(6.0, 12.0, "6 to 12 m/s²"),
            ),
            (
                "throttle_lag_s",
                self.throttle_lag_s,
                Range::Within(0.01, 1.0, "0.01 to 1 s"),
            ),
            (
                "brake_lag_s",
                self.brake_lag_s,
                Range::Within(0.01, 0.5, "0.01 to 0.5 s"),
            ),
            (
                "steering_limit_rad",
                self.steering_limit_rad,
                Range::Within(0.1, 1.2, "0.1 to 1.2 rad"),
            ),
            (
                "steering_rate_limit_rad_per_s",
                self.steering_rate_limit_rad_per_s,
                Range::Within(0.1, 5.0, "0.1 to 5 rad/s"),
            ),
            (
                "jerk_limit_mps3",
                self.jerk_limit_mps3,
                Range::Within(30.0, 1e4, "30 to 10000 m/s³"),
            ),
            (
                "step_s",
                self.step_s,
                Range::Within(0.0005, PLANNING_STEP_S, "0.0005 to 0.05 s"),
            ),
        ];
        ranges
            .into_iter()
            .try_for_each(|(key, found, range)| check("vehicle", key, found, range))?;
        let steps = PLANNING_STEP_S / self.step_s;
        check(
            "vehicle",
            "step_s",
            self.step_s,
            if (steps - steps.round()).abs() < 1e-6 {
                Range::Positive
            } else {
                Range::Within(0.0, 0.0, "a whole fraction of 0.05 s")
            },
        )?;
        self.dynamics.check(self)
    }
}
