//! What an evaluation gives: tables and series, ready for a file.

use super::{
    baselines::Baselines,
    closed_loop_network::ClosedLoopStudy,
    laws::helly::Gains,
    method::{FollowingMethod, Knows},
    open_loop::OpenLoop,
    simulation_errors::SimulationErrors,
};
use serde::{Deserialize, Serialize};

/// One method on one driver's test rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MethodErrors {
    /// The method.
    pub method: FollowingMethod,
    /// How far it came from the recording.
    #[serde(flatten)]
    pub errors: SimulationErrors,
}

/// One method over all drivers, every driver the same weight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MethodMean {
    /// The method.
    pub method: FollowingMethod,
    /// Mean RMSE of the gap, in m.
    pub gap_rmse_m: f64,
    /// Mean RMSE of the speed, in m/s.
    pub speed_rmse_mps: f64,
    /// Mean RMSE of the gap over the root mean square gap.
    pub nrmse: f64,
    /// Mean of the mixed error.
    pub mixed: f64,
    /// In how many drivers the simulated gap reached 0.
    pub reached_zero: usize,
    /// Number of drivers.
    pub drivers: usize,
}

/// Gap and speed under one method at the times of a [`TestSeries`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodSeries {
    /// The method.
    pub method: FollowingMethod,
    /// Simulated gap, in m, 0 where the leader was reached; shape `(k,)`.
    pub gap_m: Vec<f64>,
    /// Simulated speed, in m/s; shape `(k,)`.
    pub speed_mps: Vec<f64>,
}

/// The test rows once a second, to draw; every column has shape `(k,)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestSeries {
    /// Time, in s, as in the run.
    pub time_s: Vec<f64>,
    /// Recorded gap, in m.
    pub gap_m: Vec<f64>,
    /// Recorded speed of ego, in m/s.
    pub ego_speed_mps: Vec<f64>,
    /// Recorded speed of the leader, in m/s.
    pub lead_speed_mps: Vec<f64>,
    /// What each method made of it.
    pub simulated: Vec<MethodSeries>,
}

/// Every method on one driver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriverEvaluation {
    /// Name of the driver.
    pub driver: String,
    /// One entry a method that was tried, in the order of [`FollowingMethod::ALL`].
    pub methods: Vec<MethodErrors>,
    /// The gains with which F steered.
    pub steering_gains: Gains,
    /// RMSE of F with the own embedding against the recorded gap over test rows in which ego moves, in m, without driving.
    pub open_loop_own_rmse_m: Option<f64>,
    /// The same with the mean embedding.
    pub open_loop_mean_rmse_m: Option<f64>,
    /// The test rows, to draw.
    pub series: TestSeries,
}

/// Every method on every driver's test rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FollowingEvaluation {
    /// One entry a driver, in the order of the runs.
    pub drivers: Vec<DriverEvaluation>,
    /// One entry a method that was tried, in the order of [`FollowingMethod::ALL`].
    pub means: Vec<MethodMean>,
    /// The laws that stand beside the networks.
    pub baselines: Baselines,
    /// Predictions without driving; empty unless somebody made them.
    pub open_loop: Vec<OpenLoop>,
    /// The network trained in closed loop; `None` if it was not trained.
    pub closed_loop: Option<ClosedLoopStudy>,
}

impl FollowingEvaluation {
    /// The mean over drivers of one method, if it was tried.
    pub fn mean(&self, method: FollowingMethod) -> Option<&MethodMean> {
        self.means.iter().find(|m| m.method == method)
    }

    /// Whether a method's gap error is the least of its kind; the floor is no kind.
    pub fn is_best(&self, method: FollowingMethod) -> bool {
        let kind = self
            .means
            .iter()
            .filter(|m| m.method.knows() == method.knows());
        let best = kind.min_by(|a, b| a.gap_rmse_m.total_cmp(&b.gap_rmse_m));
        method.knows() != Knows::Test && best.is_some_and(|b| b.method == method)
    }

    /// The drivers whom `own` follows no better than `mean`, by the RMSE of the gap: whom personalising harms.
    pub fn harmed(&self, own: FollowingMethod, mean: FollowingMethod) -> Vec<&str> {
        self.drivers
            .iter()
            .filter(|d| match (d.gap_rmse_m(own), d.gap_rmse_m(mean)) {
                (Some(own), Some(mean)) => own >= mean,
                _ => false,
            })
            .map(|d| d.driver.as_str())
            .collect()
    }
}

impl DriverEvaluation {
    /// The gap's RMSE under a method, in m, if it was tried.
    pub fn gap_rmse_m(&self, method: FollowingMethod) -> Option<f64> {
        let found = self.methods.iter().find(|m| m.method == method);
        found.map(|m| m.errors.gap_rmse_m)
    }
}
