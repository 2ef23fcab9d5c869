//! Which condition a drive belongs to.

use crate::error::DomainError;
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// Longest id of a condition, in characters.
const LONGEST: usize = 32;

/// The id of a condition, of the baseline or of a role: a label that a study's [`Design`](crate::Design) gives a meaning.
///
/// It stands in file names, orders of trials and answers. Small enough to copy; ordered as text.
///
/// # Example
/// ```
/// # use maveric_domain::ConditionId;
/// let calm: ConditionId = "calm".parse()?;
/// assert_eq!(calm.as_str(), "calm");
/// assert!("far too calm".parse::<ConditionId>().is_err());
/// # Ok::<(), maveric_domain::DomainError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ConditionId([u8; LONGEST]);

impl ConditionId {
    /// The paper's own drive by hand.
    pub const OWN: Self = Self::known("own");
    /// The paper's car that drives as the person does.
    pub const MIMIC: Self = Self::known("mimic");
    /// The paper's car shifted up the gradient of aggression.
    pub const AGGRESSIVE: Self = Self::known("aggressive");
    /// The paper's car shifted down the gradient of aggression.
    pub const CAUTIOUS: Self = Self::known("cautious");
    /// The paper's car moved within the plane perpendicular to the gradient.
    pub const PERPENDICULAR: Self = Self::known("perpendicular");
    /// The paper's four AV conditions, in the order in which pages show them.
    pub const AV: [Self; 4] = [
        Self::MIMIC,
        Self::AGGRESSIVE,
        Self::CAUTIOUS,
        Self::PERPENDICULAR,
    ];

    const fn known(text: &str) -> Self {
        let (bytes, mut id, mut i) = (text.as_bytes(), [0; LONGEST], 0);
        while i < bytes.len() {
            id[i] = bytes[i];
            i += 1;
        }
        Self(id)
    }

    /// Takes 1 to 32 letters, digits, `_` or `-`: what is safe in a file name everywhere.
    ///
    /// # Errors
    /// [`DomainError::BadCondition`] for anything else.
    pub fn new(text: &str) -> Result<Self, DomainError> {
        let fits = (1..=LONGEST).contains(&text.len())
            && text
                .bytes()
                .all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-');
        if fits {
            Ok(Self::known(text))
        } else {
            Err(DomainError::BadCondition {
                found: text.to_owned(),
            })
        }
    }

    /// The id as text.
    pub fn as_str(&self) -> &str {
        let end = self.0.iter().position(|&b| b == 0).unwrap_or(LONGEST);
        // Only ASCII was let in.
        std::str::from_utf8(&self.0[..end]).unwrap_or_default()
    }
}

impl fmt::Debug for ConditionId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Display for ConditionId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl FromStr for ConditionId {
    type Err = DomainError;
    fn from_str(text: &str) -> Result<Self, DomainError> {
        Self::new(text)
    }
}

impl TryFrom<String> for ConditionId {
    type Error = DomainError;
    fn try_from(text: String) -> Result<Self, DomainError> {
        Self::new(&text)
    }
}

impl From<ConditionId> for String {
    fn from(id: ConditionId) -> Self {
        id.as_str().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_condition_is_a_short_word_that_a_file_name_can_hold() {
        let longest = "a".repeat(32);
        for text in ["calm", "plus-15", "B_2", &longest] {
            assert_eq!(text.parse::<ConditionId>().unwrap().as_str(), text);
        }
        for text in ["", "../own", "so calm", "ruhig\u{e4}", &"a".repeat(33)] {
            assert!(text.parse::<ConditionId>().is_err(), "{text}");
        }
    }

    #[test]
    fn ids_are_ordered_as_their_texts_are() {
        let mut ids = ConditionId::AV.map(|c| c.to_string());
        ids.sort();
        let mut sorted = ConditionId::AV;
        sorted.sort();
        assert_eq!(sorted.map(|c| c.to_string()), ids);
    }
}
