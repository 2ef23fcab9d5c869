#![doc = include_str!("../README.md")]

mod abreast;
pub mod calibrate;
pub mod choice;
pub mod closed_loop;
pub mod closed_loop_network;
pub mod error;
pub mod evaluation;
pub mod keep_distance;
pub mod law;
pub mod method;
pub mod peers;
pub mod results;
pub mod run;
mod search;
pub mod settings;
pub mod shrinkage;
pub mod simulation_errors;
#[cfg(test)]
mod testing;

pub use calibrate::{Calibrated, Family};
pub use choice::{Candidate, Trial, ranked, trials, try_over_people};
pub use closed_loop::{ClosedLoop, simulate};
pub use closed_loop_network::{
    ClosedLoopNetwork, ClosedLoopSeed, ClosedLoopSettings, ClosedLoopStudy, TrainedClosedLoop,
    TrainedFor,
};
pub use error::FollowingError;
pub use evaluation::{DistanceLaw, Distances, evaluate};
pub use keep_distance::KeepDistance;
pub use law::{Law, Newell};
pub use method::{FollowingMethod, Knows};
pub use peers::Peers;
pub use results::{
    Compared, DriverEvaluation, FollowingEvaluation, MethodErrors, MethodMean, MethodSeries,
    TestSeries, median,
};
pub use run::{FollowingColumns, FollowingRun, Stretch};
pub use search::SearchSettings;
pub use settings::{FollowingSettings, SAFETY};
pub use shrinkage::Shrinkage;
pub use simulation_errors::SimulationErrors;
