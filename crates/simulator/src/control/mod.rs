//! Controllers: what makes set-points safe and a car out of them.

pub(crate) mod action;
mod automated;
mod by_hand;
mod emergency;
mod following;
#[cfg(test)]
mod following_tests;
mod idm;
mod intervention;
mod lane_change;
mod lead;
mod passing;
pub(crate) mod path;
mod safety;
mod sideways;
mod velocity;

pub use action::Manoeuvre;
pub(crate) use automated::AutomatedDriver;
pub use by_hand::Hands;
pub use following::following_acceleration;
pub use intervention::{Intervention, InterventionKind};
pub use lead::Lead;
pub use path::{PathShape, Steering};
pub use safety::safe_distance;
pub(crate) use safety::safe_distance_m;
pub use velocity::{VelocityController, bounded_jerk};
