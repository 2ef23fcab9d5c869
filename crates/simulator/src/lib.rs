#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod collision;
mod control;
mod drivers;
mod elsewhere;
pub mod error;
pub mod flow;
mod neighbours;
mod normal;
mod outcome;
pub mod planner;
pub mod road;
mod rollout;
pub mod scenario;
mod session;
#[cfg(test)]
mod testing;
mod traffic;
mod vehicle;
mod watch;
mod world;

pub use collision::{Collision, CollisionCause};
pub use control::{
    Hands, Intervention, InterventionKind, Lead, Manoeuvre, PathShape, Steering,
    VelocityController, bounded_jerk, following_acceleration, safe_distance,
};
pub use drivers::{
    BentLaw, Distribution, DriverParams, EncounterNoise, EvidenceParams, EvidencePopulation, Law,
    OrnsteinUhlenbeck, People, Person, Population, population_table,
};
pub use error::SimulatorError;
pub use outcome::{Rollout, RolloutReport};
pub use planner::{PLANNING_RATE_HZ, PLANNING_STEP_S, Planner, View};
pub use road::{CentreLine, MapPose, Segment};
pub use rollout::rollout;
pub use scenario::{
    ChangeRule, ControllerSettings, DynamicsSettings, FollowingRule, Integrator, Scenario,
    ScenarioSettings, ScriptStep, VehicleModel, VehiclePlacement,
};
pub use session::{CarState, Driver, LEFT_SHOULDER_M, RIGHT_SHOULDER_M, Session};
pub use vehicle::{Command, FrontAxle, Pose, Vehicle};
