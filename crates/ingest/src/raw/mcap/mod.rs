//! MCAP: the container, and the drives that ROS 2 rigs put into it.

mod ahead;
pub(crate) mod channels;
pub(crate) mod choice;
pub(crate) mod chunk;
pub(crate) mod container;
pub(crate) mod decisions;
mod frames;
pub(crate) mod metadata;
pub(crate) mod parts;
pub(crate) mod read;
pub(crate) mod record;
pub(crate) mod rigs;
pub(crate) mod roles;
mod scene;
pub(crate) mod signals;
pub(crate) mod write;
