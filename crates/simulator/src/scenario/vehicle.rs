//! Settings of ego's car.

use super::setting::{Range, check, check_section, choices, settings};
use crate::{error::SimulatorError, planner::PLANNING_STEP_S};
use serde::{Deserialize, Serialize};

/// What the car is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VehicleModel {
    /// It rolls where its wheels point.
    Kinematic,
    /// It has mass, and tyres that slip; see [`DynamicsSettings`].
    Dynamic,
}

/// How the kinematic car is moved on by one step; the dynamic one always by Runge and Kutta's method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Runge and Kutta's method of order four.
    Rk4,
    /// Actuators, speed and place one after the other, of order one: what the paper's scenario is driven with, so that
    /// its drives stay what they were.
    InTurn,
}

choices!(VehicleModel, Integrator);

settings! {
    /// Mass and tyres of the dynamic car.
    ///
    /// # Source
    /// Chosen: a mid-size car that understeers.
    pub struct DynamicsSettings {
        /// Mass.
        mass_kg: f64 = 1550.0, 300.0..=4e4;
        /// Moment of inertia about the vertical axis.
        yaw_inertia_kg_m2: f64 = 2800.0, 100.0..=1e6;
        /// Centre of mass to front axle: a fifth of `wheelbase_m` to where the car would oversteer.
        front_axle_m: f64 = 1.25, Range::Positive;
        /// Cornering stiffness of both front tyres together.
        front_stiffness_n_per_rad: f64 = 130_000.0, 2e4..=1e6;
        /// Cornering stiffness of both rear tyres together.
        rear_stiffness_n_per_rad: f64 = 150_000.0, 2e4..=1e6;
        /// Friction coefficient μ of tyres on road; with less than `braking_limit_mps2` over gravity the brakes could not be held.
        friction: f64 = 0.9, Range::Positive;
    }
}

settings! {
    /// Ego's car; all vehicles share its length and width.
    ///
    /// # Source
    /// Method section 5 for the limits of acceleration and braking; the rest is ours, a mid-size car.
    pub struct VehicleSettings {
        /// Bumper to bumper.
        length_m: f64 = 4.7, 1.0..=25.0;
        /// Side to side.
        width_m: f64 = 1.9, 0.5..=2.6;
        /// Axle to axle.
        wheelbase_m: f64 = 2.8, 0.5..=15.0;
        /// Strongest acceleration.
        acceleration_limit_mps2: f64 = 3.0, 0.5..=10.0;
        /// Strongest braking, positive.
        braking_limit_mps2: f64 = 8.0, 6.0..=12.0;
        /// Time constant of the throttle.
        throttle_lag_s: f64 = 0.3, 0.01..=1.0;
        /// Time constant of the brake.
        brake_lag_s: f64 = 0.15, 0.01..=0.5;
        /// Largest angle of the front wheels.
        steering_limit_rad: f64 = 0.6, 0.1..=1.2;
        /// Fastest turn of the front wheels.
        steering_rate_limit_rad_per_s: f64 = 0.5, 0.1..=5.0;
        /// Fastest change of acceleration that throttle and brake allow; the usual one is above what the lags do.
        jerk_limit_mps3: f64 = 100.0, 30.0..=1e4;
        /// What the car is made of.
        model: VehicleModel = VehicleModel::Kinematic;
        /// How the kinematic car is moved on by one step; `paper.toml` has `in_turn`, so that its drives stay what they were.
        integrator: Integrator = Integrator::Rk4;
        /// Time between two integration steps: a whole fraction of 0.05 s.
        step_s: f64 = 0.01, 0.0005..=PLANNING_STEP_S;
        /// Mass and tyres, for the dynamic model.
        dynamics: DynamicsSettings = DynamicsSettings::default();
    }
}

impl VehicleSettings {
    /// Integration steps between two rows of a drive.
    pub(crate) fn steps_per_row(&self) -> usize {
        (PLANNING_STEP_S / self.step_s).round() as usize
    }

    /// Refuses a number out of range, and what does not go together.
    pub(crate) fn check_all(&self) -> Result<(), SimulatorError> {
        check_section("vehicle", self)?;
        let steps = PLANNING_STEP_S / self.step_s;
        let whole = PLANNING_STEP_S / steps.round();
        let fraction = Range::Because(whole - 1e-9, whole + 1e-9, "a whole fraction of 0.05 s");
        check("vehicle.step_s", self.step_s, fraction)?;
        let tyres = &self.dynamics;
        // Beyond this l_f C_f > l_r C_r: the car oversteers, and above some speed nothing keeps it straight.
        let neutral_m = self.wheelbase_m * tyres.rear_stiffness_n_per_rad
            / (tyres.front_stiffness_n_per_rad + tyres.rear_stiffness_n_per_rad);
        let axle = Range::Because(
            0.2 * self.wheelbase_m,
            neutral_m,
            "a fifth of wheelbase_m to where the car would oversteer",
        );
        check("vehicle.dynamics.front_axle_m", tyres.front_axle_m, axle)?;
        // Brakes that the road cannot hold would make the safe distance a promise nobody keeps.
        let least = self.braking_limit_mps2 / 9.806_65;
        let grip = Range::Because(least, 1.5, "braking_limit_mps2 over gravity to 1.5");
        check("vehicle.dynamics.friction", tyres.friction, grip)
    }
}
