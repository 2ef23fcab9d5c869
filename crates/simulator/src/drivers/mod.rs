//! Synthetic people at the wheel, by another model than the automated car's.

mod bounds;
mod caution;
mod distributions;
mod evidence;
mod habit;
mod human;
mod idm;
mod noise;
mod passing;
mod people;
mod perception;
mod population;

pub use distributions::{Distribution, population_table};
pub(crate) use evidence::EvidenceDriver;
pub use evidence::{BentLaw, EvidenceParams, EvidencePopulation};
pub(crate) use human::HumanDriver;
pub use noise::OrnsteinUhlenbeck;
pub use people::{People, Person};
pub use population::{DriverParams, EncounterNoise, Law, Population};
