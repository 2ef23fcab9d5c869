//! MCAP: the drives that rigs put into it.

mod beside_ego;
mod candidate;
pub(crate) mod channels;
pub(crate) mod choice;
pub(crate) mod decisions;
mod drive;
mod frames;
pub(crate) mod metadata;
pub(crate) mod read;
mod rigs;
mod roles;
pub(crate) mod samples;
pub(crate) mod signals;
pub(crate) mod slots;
pub(crate) mod write;
