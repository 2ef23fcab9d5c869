//! When a questionnaire was answered.

use crate::{ConditionId, Occasion, Ride, error::DomainError};
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// When a questionnaire was answered.
///
/// In a word it is `pre`, `post`, `probe:` with the id of the condition, or that id alone. Only a condition that is itself called `pre` or
/// `post` is written `after:pre`; `after:` may stand before any other, too. Of several drives in a condition, `:s2:t1` stands behind the id
/// of one that is not the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Moment {
    /// Before the drives; about oneself.
    Pre,
    /// After a drive in this condition; about that drive.
    After(Ride),
    /// During a drive in this condition, again and again.
    Probe(Ride),
    /// At the end, after all drives.
    Post,
}

impl Moment {
    /// The words for [`Moment::Pre`] and [`Moment::Post`].
    const PRE: &str = "pre";
    const POST: &str = "post";
    /// What tells a condition from those words; no condition's id has a colon.
    const AFTER: &str = "after:";
    const PROBE: &str = "probe:";

    /// Whether a condition's id is also the word for [`Moment::Pre`].
    pub fn is_shared_word(condition: ConditionId) -> bool {
        condition.as_str() == Self::PRE
    }

    /// After a drive.
    pub fn after(ride: impl Into<Ride>) -> Self {
        Self::After(ride.into())
    }

    /// During a drive.
    pub fn probe(ride: impl Into<Ride>) -> Self {
        Self::Probe(ride.into())
    }

    /// The drive that it is about.
    pub fn ride(self) -> Option<Ride> {
        match self {
            Self::After(ride) | Self::Probe(ride) => Some(ride),
            Self::Pre | Self::Post => None,
        }
    }

    /// The condition that it is about.
    pub fn condition(self) -> Option<ConditionId> {
        self.ride().map(|ride| ride.condition)
    }

    /// The same after or during another drive of the condition.
    #[must_use]
    pub fn on(self, occasion: Occasion) -> Self {
        match self {
            Self::After(ride) => Self::After(Ride { occasion, ..ride }),
            Self::Probe(ride) => Self::Probe(Ride { occasion, ..ride }),
            Self::Pre | Self::Post => self,
        }
    }
}

impl fmt::Display for Moment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pre => f.write_str(Self::PRE),
            Self::Post => f.write_str(Self::POST),
            Self::Probe(ride) => write!(f, "{}{ride}", Self::PROBE),
            Self::After(ride) if [Self::PRE, Self::POST].contains(&ride.condition.as_str()) => {
                write!(f, "{}{ride}", Self::AFTER)
            }
            Self::After(ride) => ride.fmt(f),
        }
    }
}

impl FromStr for Moment {
    type Err = DomainError;
    fn from_str(text: &str) -> Result<Self, DomainError> {
        let (make, id): (fn(Ride) -> Self, &str) = match text {
            Self::PRE => return Ok(Self::Pre),
            Self::POST => return Ok(Self::Post),
            other => match other.strip_prefix(Self::PROBE) {
                Some(id) => (Self::Probe, id),
                None => (Self::After, other.strip_prefix(Self::AFTER).unwrap_or(other)),
            },
        };
        id.parse().map(make).map_err(|_| DomainError::UnknownMoment { found: text.to_owned() })
    }
}

crate::as_text::as_text!(Moment);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_survive_their_text() {
        for text in [
            "pre",
            "own",
            "mimic",
            "after:pre",
            "post",
            "after:post",
            "probe:mimic",
            "probe:post",
            "mimic:s2:t1",
            "after:post:s1:t2",
            "probe:mimic:s2:t2",
        ] {
            assert_eq!(text.parse::<Moment>().unwrap().to_string(), text);
        }
        let after = |id: &str| Moment::after(id.parse::<ConditionId>().unwrap());
        assert_eq!("pre".parse::<Moment>().unwrap(), Moment::Pre);
        assert_eq!("post".parse::<Moment>().unwrap(), Moment::Post);
        assert_eq!("after:pre".parse::<Moment>().unwrap(), after("pre"));
        assert_eq!("after:post".parse::<Moment>().unwrap(), after("post"));
        let probe = "probe:mimic".parse::<Moment>().unwrap();
        assert_eq!(
            (probe.condition(), Moment::Post.condition()),
            (after("mimic").condition(), None)
        );
        assert_eq!("after:mimic".parse::<Moment>().unwrap(), after("mimic"));
        assert!("probe:".parse::<Moment>().is_err() && "probe:after:a".parse::<Moment>().is_err());
        assert!("after:".parse::<Moment>().is_err() && "after:after:a".parse::<Moment>().is_err());
        let again = Moment::After("mimic:s2:t1".parse().unwrap());
        assert_eq!(after("mimic").on(Occasion::new(2, 1).unwrap()), again);
        assert_eq!(again.condition(), after("mimic").condition());
        assert_ne!(again, after("mimic"));
        assert!("after the drive".parse::<Moment>().is_err());
    }
}
