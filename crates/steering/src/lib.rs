#![doc = include_str!("../README.md")]

mod habits;
mod model_planner;
mod networks;
mod paper;
mod varying;

pub use habits::HabitRule;
pub use model_planner::ModelPlanner;
pub use paper::PaperRule;
pub use varying::Varying;
