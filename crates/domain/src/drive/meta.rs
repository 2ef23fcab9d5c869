//! Whose a drive is, and which of several.

use crate::{
    ConditionId,
    error::DomainError,
    ids::{DriveId, ParticipantId},
    occasion::{Occasion, Ride, first, is_first},
};
use serde::{Deserialize, Serialize};
use std::{num::NonZeroU32, str::FromStr};

/// Who or what drove.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DrivenBy {
    /// A person.
    Human,
    /// A script in a person's place, at the same wheel and pedals.
    Scripted,
    /// A driver model standing in for a person.
    Synthetic,
    /// The learned model through its controllers.
    Automated,
}

impl DrivenBy {
    /// Lower-case word used in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Human => "human",
            Self::Scripted => "scripted",
            Self::Synthetic => "synthetic",
            Self::Automated => "automated",
        }
    }
}

impl FromStr for DrivenBy {
    type Err = DomainError;
    fn from_str(text: &str) -> Result<Self, DomainError> {
        [Self::Human, Self::Scripted, Self::Synthetic, Self::Automated]
            .into_iter()
            .find(|d| d.as_str() == text)
            .ok_or_else(|| DomainError::UnknownWord {
                kind: "driver kind",
                found: text.to_owned(),
                expected: "human, scripted, synthetic, automated",
            })
    }
}

/// Whose drive it is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DriveMeta {
    /// Unique in a study.
    pub drive: DriveId,
    /// The participant whose style it shows.
    pub participant: ParticipantId,
    /// The condition, the baseline or the role: a label of the study's design.
    pub condition: ConditionId,
    /// Who or what drove.
    pub driven_by: DrivenBy,
    /// In which session.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub session: NonZeroU32,
    /// Which drive of the condition within the session.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub trial: NonZeroU32,
}

impl DriveMeta {
    /// Whose a drive is, the first of its condition.
    pub fn new(
        drive: DriveId,
        participant: ParticipantId,
        condition: ConditionId,
        driven_by: DrivenBy,
    ) -> Self {
        Self { drive, participant, condition, driven_by, session: first(), trial: first() }
    }

    /// The same, of another session or trial.
    #[must_use]
    pub fn on(self, Occasion { session, trial }: Occasion) -> Self {
        Self { session, trial, ..self }
    }

    /// Which of several drives of the condition it is.
    pub fn occasion(&self) -> Occasion {
        Occasion { session: self.session, trial: self.trial }
    }

    /// The condition, and which of several drives in it.
    pub fn ride(&self) -> Ride {
        Ride { condition: self.condition, occasion: self.occasion() }
    }

    /// The same of ids as texts.
    ///
    /// # Errors
    /// [`DomainError::BadId`] or [`DomainError::BadCondition`] for a text that is none.
    ///
    /// # Example
    /// ```
    /// # use maveric_domain::{DriveMeta, DrivenBy};
    /// let meta = DriveMeta::named("P01-own", "P01", "own", DrivenBy::Human)?;
    /// assert_eq!(meta.participant.as_str(), "P01");
    /// # Ok::<(), maveric_domain::DomainError>(())
    /// ```
    pub fn named(
        drive: impl Into<String>,
        participant: impl Into<String>,
        condition: &str,
        driven_by: DrivenBy,
    ) -> Result<Self, DomainError> {
        Ok(Self::new(
            DriveId::new(drive)?,
            ParticipantId::new(participant)?,
            condition.parse()?,
            driven_by,
        ))
    }
}
