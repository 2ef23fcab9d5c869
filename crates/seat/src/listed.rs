//! What stands of people and their answers in the study's tables.

use crate::sheet::Sheet;

/// What stands of a row in the study's tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Listed {
    /// It was not written yet.
    NotYet,
    Written,
    /// It was written, and somebody took it out by hand.
    TakenOut,
}

impl Listed {
    pub(crate) fn number(self) -> i64 {
        match self {
            Self::NotYet => 0,
            Self::Written => 1,
            Self::TakenOut => 2,
        }
    }

    pub(crate) fn read(number: i64) -> Self {
        match number {
            0 => Self::NotYet,
            1 => Self::Written,
            _ => Self::TakenOut,
        }
    }
}

/// A sheet of answers as it is kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct KeptSheet {
    pub(crate) step: usize,
    pub(crate) body: String,
    /// When it was given, in s since 1970.
    pub(crate) given: i64,
    pub(crate) listed: Listed,
}

impl KeptSheet {
    /// What was answered: only what was checked was kept.
    pub(crate) fn sheet(&self) -> Option<Sheet> {
        serde_json::from_str(&self.body).ok()
    }
}
