#![doc = include_str!("../README.md")]

pub mod answers;
pub mod at_random;
pub mod cohort;
mod coverage;
pub mod effects;
pub mod error;
pub mod impression;
mod item_model;
mod linear;
mod part;
pub mod person;
pub mod presses;
pub mod ratings;
mod response;
mod scale_model;
pub mod settings;
mod trait_mixing;

pub use answers::answer_before;
pub use at_random::{answer_at_random, probes_at_random};
pub use cohort::{Cohort, PlannedDrive};
pub use effects::Effects;
pub use error::ParticipantError;
pub use part::Part;
pub use person::{Gender, Participant, Personality, Population, Trait};
pub use presses::{PressModel, presses_during};
pub use ratings::{Rated, RatingWarning, rate};
pub use settings::{CohortSettings, Group};
#[cfg(test)]
mod testing;
