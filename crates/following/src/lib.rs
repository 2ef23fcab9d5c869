//! Car-following on recorded people: closed-loop runs behind a recorded leader, and the models beside them.
//!
//! A [`FollowingRun`] is one driver behind one leader. [`simulate`] lets any acceleration law drive in that
//! driver's place; [`SimulationErrors`] says how far it came from the recording. [`Baselines`] are what a few
//! parameters can do, and [`evaluate`] puts a following distance learned by the network beside them.

pub mod baselines;
pub mod calibrate;
pub mod closed_loop;
pub mod closed_loop_network;
pub mod error;
pub mod evaluation;
pub mod laws;
#[cfg(test)]
mod made_up;
pub mod method;
pub mod open_loop;
mod optimise;
pub mod results;
pub mod run;
pub mod settings;
pub mod simulation_errors;
pub mod steering;
#[cfg(test)]
#[path = "../../model/tests/support/drives.rs"]
mod test_drives;
pub mod velocity;

pub use baselines::{Baselines, DriverBaselines};
pub use calibrate::{
    Calibrated, SearchSettings, calibrate_gipps, calibrate_helly, calibrate_idm,
    calibrate_idm_along, calibrate_idm_time_gap, calibrate_idm_time_gap_and_standstill,
    calibrate_newell,
};
pub use closed_loop::{ClosedLoop, simulate};
pub use closed_loop_network::{
    ClosedLoopNetwork, ClosedLoopSeed, ClosedLoopSettings, ClosedLoopStudy, TrainedClosedLoop,
};
pub use error::FollowingError;
pub use evaluation::{Contender, DistanceLaw, InPlaceOf, evaluate, evaluate_beside};
pub use laws::{
    gipps::Gipps,
    helly::{Gains, Helly},
    idm::Idm,
    idm_directions::IdmDirections,
    keep_distance::{KeepDistance, SafetyBound},
    newell::Newell,
    time_gap::ConstantTimeGap,
};
pub use method::{FollowingMethod, Knows};
pub use open_loop::{OpenLoop, Predicted, distance_rmse_m, speed_rmse_mps, straight_line};
pub use results::{
    DriverEvaluation, FollowingEvaluation, MethodErrors, MethodMean, MethodSeries, TestSeries,
};
pub use run::{FollowingColumns, FollowingRun, Stretch};
pub use settings::FollowingSettings;
pub use simulation_errors::SimulationErrors;
pub use steering::SteeringGains;
pub use velocity::{predicted_speeds_mps, velocity_law};
