//! A personal model as the planner of a car.
//!
//! [`ModelPlanner`] asks a model what its driver would do and says so to the simulator's controllers, as a speed, a gap and a wish.

mod habits;
mod model_planner;
mod networks;
mod paper;

pub use habits::HabitRule;
pub use model_planner::ModelPlanner;
pub use paper::PaperRule;
