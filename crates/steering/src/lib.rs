#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod habits;
mod lending;
mod model_planner;
mod networks;
mod paper;
mod ride_style;

pub use habits::HabitRule;
pub use lending::Lending;
pub use model_planner::ModelPlanner;
pub use paper::PaperRule;
pub use ride_style::{PlacedStyle, RideStyle, Seed};
