//! Which condition a drive belongs to.

use crate::{error::DomainError, ids::is_file_name};
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// Longest id of a condition, in characters.
const LONGEST: usize = 32;

/// The id of a condition, of the baseline or of a role: a label that a study's design gives a meaning.
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
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
#[cfg_attr(feature = "schema", schemars(extend("pattern" = "^[A-Za-z0-9_-]{1,32}$")))]
pub struct ConditionId([u8; LONGEST]);

impl ConditionId {
    /// Takes 1 to 32 letters, digits, `_` or `-`, and no name of a device of Windows: what is safe in a file name everywhere.
    ///
    /// # Errors
    /// [`DomainError::BadCondition`] for anything else.
    pub fn new(text: &str) -> Result<Self, DomainError> {
        if is_file_name(text, LONGEST) {
            let mut id = [0; LONGEST];
            id[..text.len()].copy_from_slice(text.as_bytes());
            Ok(Self(id))
        } else {
            Err(DomainError::BadCondition { found: text.to_owned() })
        }
    }

    /// Ids in a row, for a message: `a, b, c`.
    pub fn listed(ids: &[Self]) -> String {
        let ids: Vec<&str> = ids.iter().map(Self::as_str).collect();
        ids.join(", ")
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

crate::as_text::as_text!(ConditionId);

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
        let words = ["sporty", "calm", "plus-15", "B_2", "calmer"];
        let mut ids = words.map(|word| word.parse::<ConditionId>().unwrap());
        ids.sort();
        let mut sorted = words;
        sorted.sort_unstable();
        assert_eq!(ids.map(|c| c.to_string()), sorted);
    }
}
