//! Synthetic people at the wheel, by another model than the automated car's.

mod distributions;
mod human;
mod idm;
mod noise;
mod params;
mod passing;
mod perception;
mod population;

pub use distributions::{Distribution, population_table};
pub(crate) use human::HumanDriver;
pub use params::DriverParams;
pub use population::{EncounterNoise, Law, Population};
