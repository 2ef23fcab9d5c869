//! Car-following on recorded people: closed-loop runs behind a recorded leader, and the models beside them.
//!
//! A [`FollowingRun`] is one driver behind one leader. [`simulate`] lets any acceleration law drive in that
//! driver's place; [`SimulationErrors`] says how far it came from the recording. [`Baselines`] are what a few
//! parameters can do, and [`evaluate`] puts a following distance learned by the network beside them.

pub mod baselines;
pub mod calibrate;
pub mod closed_loop;
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

pub use baselines::{Baselines, DriverBaselines};
pub use calibrate::{
    Calibrated, SearchSettings, calibrate_helly, calibrate_idm, calibrate_idm_time_gap,
};
pub use closed_loop::{ClosedLoop, simulate};
pub use error::FollowingError;
pub use evaluation::{DistanceLaw, evaluate, evaluate_beside};
pub use laws::{
    helly::{Gains, Helly},
    idm::Idm,
    keep_distance::{KeepDistance, SafetyBound},
    time_gap::ConstantTimeGap,
};
pub use method::FollowingMethod;
pub use open_loop::distance_rmse_m;
pub use results::{
    DriverEvaluation, FollowingEvaluation, MethodErrors, MethodMean, MethodSeries, TestSeries,
};
pub use run::{FollowingColumns, FollowingRun, Stretch};
pub use settings::FollowingSettings;
pub use simulation_errors::SimulationErrors;
pub use steering::SteeringGains;
