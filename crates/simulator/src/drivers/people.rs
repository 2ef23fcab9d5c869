//! Which kind of people there are.

use super::{DriverParams, EvidenceParams, EvidencePopulation, Population};
use crate::{error::SimulatorError, scenario::setting::check_section};
use maveric_domain::LatentTraits;
use serde::{Deserialize, Serialize};

/// A population of synthetic people: one table of a file, `[drivers]` as in a scenario or `[evidence]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub enum People {
    /// Who pass and merge back at time gaps.
    Drivers(Box<Population>),
    /// Who act when evidence has piled up.
    Evidence(Box<EvidencePopulation>),
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Unchecked {
    Drivers(Box<Population>),
    Evidence(Box<EvidencePopulation>),
}

impl TryFrom<Unchecked> for People {
    type Error = SimulatorError;
    fn try_from(raw: Unchecked) -> Result<Self, SimulatorError> {
        match raw {
            Unchecked::Drivers(population) => {
                check_section("drivers", &*population)?;
                Ok(Self::Drivers(population))
            }
            Unchecked::Evidence(population) => {
                check_section("evidence", &*population)?;
                Ok(Self::Evidence(population))
            }
        }
    }
}

impl People {
    /// The person with these latent traits and this `person_seed`, on the day `day_seed`.
    pub fn draw(&self, traits: &LatentTraits, person_seed: u64, day_seed: u64) -> Person {
        match self {
            Self::Drivers(p) => Person::Driver(p.draw(traits, person_seed, day_seed)),
            Self::Evidence(p) => Person::Evidence(p.draw(traits, person_seed, day_seed)),
        }
    }
}

/// Somebody of either kind, on one day.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum Person {
    /// Of the usual kind.
    Driver(DriverParams),
    /// Who acts on evidence.
    Evidence(EvidenceParams),
}
