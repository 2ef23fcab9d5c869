#![doc = include_str!("../README.md")]

mod habits;
mod model_planner;
mod networks;
mod paper;

pub use habits::HabitRule;
pub use model_planner::ModelPlanner;
pub use paper::PaperRule;
