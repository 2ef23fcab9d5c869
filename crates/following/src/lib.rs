#![doc = include_str!("../README.md")]

mod abreast;
pub mod calibrate;
pub mod closed_loop;
mod driver_laws;
pub mod error;
pub mod evaluation;
pub mod method;
pub mod results;
pub mod run;
mod search;
pub mod settings;
pub mod simulation_errors;
#[cfg(test)]
mod testing;

pub use calibrate::{Calibrated, Family};
pub use closed_loop::{ClosedLoop, simulate};
pub use error::FollowingError;
pub use evaluation::evaluate;
pub use method::FollowingMethod;
pub use results::{
    Compared, DriverEvaluation, FollowingEvaluation, MethodErrors, MethodMean, MethodSeries,
    TestSeries, median,
};
pub use run::{FollowingColumns, FollowingRun, Stretch};
pub use search::SearchSettings;
pub use settings::FollowingSettings;
pub use simulation_errors::SimulationErrors;
