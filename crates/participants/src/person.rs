//! One synthetic person.

use maveric_domain::{ConditionId, DomainError, LatentTraits, ParticipantId};
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Gender as the paper reports it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Gender {
    /// Written `female`.
    Female,
    /// Written `male`.
    Male,
}

impl Gender {
    /// Lower-case word used in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Female => "female",
            Self::Male => "male",
        }
    }
}

impl FromStr for Gender {
    type Err = DomainError;
    /// In small or large letters, or by its first one.
    fn from_str(text: &str) -> Result<Self, DomainError> {
        match text.trim().to_lowercase().as_str() {
            "female" | "f" | "woman" | "w" => Ok(Self::Female),
            "male" | "m" | "man" => Ok(Self::Male),
            _ => Err(DomainError::UnknownWord {
                kind: "gender",
                found: text.to_owned(),
                expected: "female, male",
            }),
        }
    }
}

/// Where a participant was recruited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Population {
    /// Within the institution: all who are learned from and half of those who are tested.
    Internal,
    /// From the general public: half of those who are tested.
    External,
}

impl Population {
    /// Lower-case word used in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Internal => "internal",
            Self::External => "external",
        }
    }
}

impl FromStr for Population {
    type Err = DomainError;
    fn from_str(text: &str) -> Result<Self, DomainError> {
        match text {
            "internal" => Ok(Self::Internal),
            "external" => Ok(Self::External),
            _ => Err(DomainError::UnknownWord {
                kind: "population",
                found: text.to_owned(),
                expected: "internal, external",
            }),
        }
    }
}

/// The Big Five, each N(0, 1) in the population.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Personality {
    /// Extraversion (sociable, talkative).
    pub extraversion: f64,
    /// Agreeableness (kind, ready to help).
    pub agreeableness: f64,
    /// Conscientiousness (orderly, thorough).
    pub conscientiousness: f64,
    /// Neuroticism (easily upset, changing moods).
    pub neuroticism: f64,
    /// Openness (intellect/imagination).
    pub openness: f64,
}

/// A latent trait by name, as the file of effects refers to it; each is N(0, 1) in the population.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Trait {
    /// a of [`LatentTraits`].
    Aggressiveness,
    /// b of [`LatentTraits`].
    Spacing,
    /// c of [`LatentTraits`].
    Pace,
    /// Of [`Personality`].
    Extraversion,
    /// Of [`Personality`].
    Agreeableness,
    /// Of [`Personality`].
    Conscientiousness,
    /// Of [`Personality`].
    Neuroticism,
    /// Of [`Personality`].
    Openness,
    /// [`Participant::high_velocity`].
    HighVelocity,
}

impl Trait {
    /// All of them, in the order in which files list them.
    pub const ALL: [Self; 9] = [
        Self::Aggressiveness,
        Self::Spacing,
        Self::Pace,
        Self::Extraversion,
        Self::Agreeableness,
        Self::Conscientiousness,
        Self::Neuroticism,
        Self::Openness,
        Self::HighVelocity,
    ];

    /// Lower-case name used in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Aggressiveness => "aggressiveness",
            Self::Spacing => "spacing",
            Self::Pace => "pace",
            Self::Extraversion => "extraversion",
            Self::Agreeableness => "agreeableness",
            Self::Conscientiousness => "conscientiousness",
            Self::Neuroticism => "neuroticism",
            Self::Openness => "openness",
            Self::HighVelocity => "high_velocity",
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Participant {
    /// Such as `S2P07`.
    pub id: ParticipantId,
    pub population: Population,
    pub age_years: u32,
    /// As the paper reports it; it decides nothing of how they drive.
    pub gender: Gender,
    /// Whether they drive for a living and also demonstrate other styles.
    pub professional: bool,
    /// The conditions in the order in which they sit through them; empty for those who are learned from.
    pub order: Vec<ConditionId>,
    /// What their driving comes from.
    pub traits: LatentTraits,
    pub personality: Personality,
    /// How much of a high-velocity driver they think they are, N(0, 1).
    pub high_velocity: f64,
}

impl Participant {
    /// A latent trait by name.
    pub fn latent(&self, name: Trait) -> f64 {
        match name {
            Trait::Aggressiveness => self.traits.aggressiveness,
            Trait::Spacing => self.traits.spacing,
            Trait::Pace => self.traits.pace,
            Trait::Extraversion => self.personality.extraversion,
            Trait::Agreeableness => self.personality.agreeableness,
            Trait::Conscientiousness => self.personality.conscientiousness,
            Trait::Neuroticism => self.personality.neuroticism,
            Trait::Openness => self.personality.openness,
            Trait::HighVelocity => self.high_velocity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_their_text() {
        for gender in [Gender::Female, Gender::Male] {
            assert_eq!(gender.as_str().parse::<Gender>().unwrap(), gender);
        }
        for population in [Population::Internal, Population::External] {
            assert_eq!(population.as_str().parse::<Population>().unwrap(), population);
        }
        assert!("x".parse::<Gender>().is_err() && "x".parse::<Population>().is_err());
    }
}
