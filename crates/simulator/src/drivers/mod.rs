//! Synthetic people at the wheel, by another model than the automated car's.

mod human;
mod idm;
mod noise;
mod params;
mod passing;
mod perception;
mod population;

pub(crate) use human::HumanDriver;
pub use params::DriverParams;
pub use population::{EncounterNoise, Law, Population};
