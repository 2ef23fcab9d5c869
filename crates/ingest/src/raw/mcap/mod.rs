//! MCAP: the drives that rigs put into it.

pub(crate) mod channels;
pub(crate) mod choice;
pub(crate) mod decisions;
mod frames;
pub(crate) mod metadata;
pub(crate) mod read;
pub(crate) mod rigs;
pub(crate) mod roles;
mod scene;
mod schemas;
pub(crate) mod signals;
pub(crate) mod write;
