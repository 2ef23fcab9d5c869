//! ROS messages without ROS: definitions, plans compiled from them, and the bytes that they describe.

pub(crate) mod cdr;
pub(crate) mod definition;
pub(crate) mod plan;
mod step;
mod walk;
