//! Whose style a drive shows.

use crate::error::DomainError;
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// Whose style a drive shows.
///
/// In Study 2 every participant has one [`Own`](Self::Own) drive by hand and the four AV
/// conditions. In Study 1 the professionals also *demonstrated* an aggressive and a cautious
/// style by hand: [`DrivenBy`](crate::DrivenBy) tells the two apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Condition {
    /// The participant's own style, by hand.
    Own,
    /// The participant's embedding as fitted.
    Mimic,
    /// Shifted up the gradient of aggression.
    Aggressive,
    /// Shifted down the gradient of aggression.
    Cautious,
    /// Moved within the plane perpendicular to the gradient.
    Perpendicular,
}

impl Condition {
    /// The four AV conditions, in the order in which pages show them.
    pub const AV: [Self; 4] = [
        Self::Mimic,
        Self::Aggressive,
        Self::Cautious,
        Self::Perpendicular,
    ];

    /// Lower-case word used in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::Mimic => "mimic",
            Self::Aggressive => "aggressive",
            Self::Cautious => "cautious",
            Self::Perpendicular => "perpendicular",
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl FromStr for Condition {
    type Err = DomainError;
    fn from_str(text: &str) -> Result<Self, DomainError> {
        [Self::Own]
            .into_iter()
            .chain(Self::AV)
            .find(|c| c.as_str() == text)
            .ok_or_else(|| DomainError::UnknownWord {
                kind: "condition",
                found: text.to_owned(),
                expected: "own, mimic, aggressive, cautious, perpendicular",
            })
    }
}
