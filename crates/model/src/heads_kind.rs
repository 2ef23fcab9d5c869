//! Which heads a model has.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Which heads a model has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HeadsKind {
    /// Habits as events, linear in the style: [`crate::HEADS`].
    Linear,
    /// The paper's five networks.
    Paper,
}

impl fmt::Display for HeadsKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Linear => "linear",
            Self::Paper => "paper",
        })
    }
}
