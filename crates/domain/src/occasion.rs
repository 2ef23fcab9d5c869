//! Which of several drives of one person in one condition.

use crate::{
    condition::ConditionId,
    error::DomainError,
    ids::{DriveId, ParticipantId},
};
use serde::{Deserialize, Serialize};
use std::{fmt, num::NonZeroU32, str::FromStr};

/// The columns of a table that say which of several drives a row is about; a table has them where a row is not about the first.
pub const OCCASION: [&str; 2] = ["session", "trial"];

/// The first session, or the first drive of a session.
pub const fn first() -> NonZeroU32 {
    NonZeroU32::MIN
}

/// Whether a session or a trial is the first: files of a study that has no others do not name it.
pub fn is_first(number: &NonZeroU32) -> bool {
    *number == first()
}

/// A session, and the drive of a condition within it, both from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Occasion {
    /// Which visit of the participant, from 1.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub session: NonZeroU32,
    /// The drive of a condition within the session.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub trial: NonZeroU32,
}

impl Occasion {
    /// The only one where a study has no others.
    pub const FIRST: Self = Self { session: first(), trial: first() };

    /// A session and a trial, both from 1; none for a 0.
    pub fn new(session: u32, trial: u32) -> Option<Self> {
        Some(Self { session: NonZeroU32::new(session)?, trial: NonZeroU32::new(trial)? })
    }
}

impl Default for Occasion {
    fn default() -> Self {
        Self::FIRST
    }
}

impl fmt::Display for Occasion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "session {}, trial {}", self.session, self.trial)
    }
}

/// A drive in a condition, the baseline or a role, and which of several.
///
/// In a word it is the condition's id, with `:s2:t1` behind it where it is not the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Ride {
    /// The condition, the baseline or the role.
    pub condition: ConditionId,
    /// Which of several.
    pub occasion: Occasion,
}

impl From<ConditionId> for Ride {
    fn from(condition: ConditionId) -> Self {
        Self { condition, occasion: Occasion::FIRST }
    }
}

impl fmt::Display for Ride {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Occasion { session, trial } = self.occasion;
        match self.occasion {
            Occasion::FIRST => self.condition.fmt(f),
            _ => write!(f, "{}:s{session}:t{trial}", self.condition),
        }
    }
}

impl FromStr for Ride {
    type Err = DomainError;
    fn from_str(text: &str) -> Result<Self, DomainError> {
        let behind = |rest: &str| {
            let (session, trial) = rest.split_once(":t")?;
            let session = session.strip_prefix('s')?;
            Occasion::new(session.parse().ok()?, trial.parse().ok()?)
        };
        let repeated = text.split_once(':').and_then(|(id, rest)| Some((id, behind(rest)?)));
        let (id, occasion) = repeated.unwrap_or((text, Occasion::FIRST));
        Ok(Self { condition: id.parse()?, occasion })
    }
}

impl DriveId {
    /// The drive of a person in a condition, the baseline or a role, with `_s2_t1` behind it where it is not the first. Logs may call it
    /// otherwise; an id is never taken apart, since people and conditions may have a `-` of their own.
    ///
    /// # Errors
    /// [`DomainError::BadId`] where both together are longer than an id.
    ///
    /// # Example
    /// ```
    /// # use maveric_domain::{ConditionId, DriveId, ParticipantId, Ride};
    /// let (who, calm) = (ParticipantId::new("S2P07")?, ConditionId::new("plus-15")?);
    /// let drive = DriveId::in_condition(&who, calm)?;
    /// assert_eq!(drive.as_str(), "S2P07-plus-15");
    /// let again: Ride = "plus-15:s2:t1".parse()?;
    /// let drive = DriveId::in_condition(&who, again)?;
    /// assert_eq!(drive.as_str(), "S2P07-plus-15_s2_t1");
    /// # Ok::<(), maveric_domain::DomainError>(())
    /// ```
    pub fn in_condition(
        participant: &ParticipantId,
        ride: impl Into<Ride>,
    ) -> Result<Self, DomainError> {
        let Ride { condition, occasion } = ride.into();
        let Occasion { session, trial } = occasion;
        Self::new(match occasion {
            Occasion::FIRST => format!("{participant}-{condition}"),
            _ => format!("{participant}-{condition}_s{session}_t{trial}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ride_survives_its_text_and_the_first_is_its_condition_alone() {
        let again =
            Ride { condition: "calm".parse().unwrap(), occasion: Occasion::new(2, 3).unwrap() };
        assert_eq!(again.to_string(), "calm:s2:t3");
        assert_eq!("calm:s2:t3".parse::<Ride>().unwrap(), again);
        let first: Ride = "calm".parse().unwrap();
        assert_eq!((first.to_string().as_str(), first.occasion), ("calm", Occasion::FIRST));
        // An id of letters that look like a session is an id.
        assert_eq!("a_s2_t1".parse::<Ride>().unwrap().occasion, Occasion::FIRST);
        for text in ["calm:s0:t1", "calm:s2", "calm:s2:t", ":s1:t2", "calm:2:1"] {
            assert!(text.parse::<Ride>().is_err(), "{text}");
        }
        assert_eq!(Occasion::new(0, 1), None);
        assert_eq!(Occasion::new(1, 0), None);
    }

    #[test]
    fn the_first_is_named_in_no_file() {
        let json = |occasion: Occasion| serde_json::to_string(&occasion).unwrap();
        assert_eq!(json(Occasion::FIRST), "{}");
        assert_eq!(json(Occasion::new(1, 2).unwrap()), "{\"trial\":2}");
        let read: Occasion = serde_json::from_str("{\"session\":2}").unwrap();
        assert_eq!(read, Occasion::new(2, 1).unwrap());
        assert!(serde_json::from_str::<Occasion>("{\"session\":0}").is_err());
    }
}
