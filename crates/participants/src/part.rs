//! Learned from, or tested.

use serde::{Deserialize, Serialize};

/// What a person takes part in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// Their drives are learned from.
    Learn,
    /// They sit through the conditions.
    Test,
}

impl Part {
    /// The number that ids and folders of logs carry.
    pub fn number(self) -> &'static str {
        match self {
            Self::Learn => "1",
            Self::Test => "2",
        }
    }
}
