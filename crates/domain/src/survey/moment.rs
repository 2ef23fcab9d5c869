//! When a questionnaire was answered.

use crate::{ConditionId, error::DomainError};
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// When a questionnaire was answered.
///
/// In files it is `pre`, or the id of the condition. Only a condition that is itself called `pre` is written `after:pre`; `after:`
/// may stand before any other, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Moment {
    /// Before the drives; about oneself.
    Pre,
    /// After a drive in this condition; about that drive.
    After(ConditionId),
}

impl Moment {
    /// The word for [`Moment::Pre`].
    const PRE: &str = "pre";
    /// What tells a condition from that word; no condition's id has a colon.
    const AFTER: &str = "after:";

    /// Whether a condition's id is also the word for [`Moment::Pre`].
    pub fn is_shared_word(condition: ConditionId) -> bool {
        condition.as_str() == Self::PRE
    }
}

impl fmt::Display for Moment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pre => f.write_str(Self::PRE),
            Self::After(condition) if Self::is_shared_word(*condition) => {
                write!(f, "{}{condition}", Self::AFTER)
            }
            Self::After(condition) => condition.fmt(f),
        }
    }
}

impl FromStr for Moment {
    type Err = DomainError;
    fn from_str(text: &str) -> Result<Self, DomainError> {
        match text {
            Self::PRE => Ok(Self::Pre),
            other => other
                .strip_prefix(Self::AFTER)
                .unwrap_or(other)
                .parse()
                .map(Self::After)
                .map_err(|_| DomainError::UnknownMoment {
                    found: other.to_owned(),
                }),
        }
    }
}

impl TryFrom<String> for Moment {
    type Error = DomainError;
    fn try_from(text: String) -> Result<Self, DomainError> {
        text.parse()
    }
}

impl From<Moment> for String {
    fn from(moment: Moment) -> Self {
        moment.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_survive_their_text() {
        for text in ["pre", "own", "mimic", "perpendicular", "after:pre"] {
            assert_eq!(text.parse::<Moment>().unwrap().to_string(), text);
        }
        let after = |id: &str| Moment::After(id.parse().unwrap());
        assert_eq!("pre".parse::<Moment>().unwrap(), Moment::Pre);
        assert_eq!("after:pre".parse::<Moment>().unwrap(), after("pre"));
        assert_eq!("after:mimic".parse::<Moment>().unwrap(), after("mimic"));
        assert!("after:".parse::<Moment>().is_err() && "after:after:a".parse::<Moment>().is_err());
        assert!("after the drive".parse::<Moment>().is_err());
    }
}
