//! Controllers: what makes set-points safe and a car out of them.

mod automated;
mod emergency;
mod following;
mod lane_change;
pub(crate) mod path;
mod safety;
mod velocity;

pub(crate) use automated::{AutomatedDriver, Interventions};
pub use safety::safe_distance;
