//! Whose drives are written as logs too, and where; whether somebody who is asked for is there.

use super::Simulate;
use crate::{error::StudyError, once::first_names};
use maveric_domain::{ConditionRow, ParticipantId};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LogChoice {
    All,
    Of(String),
}

impl std::str::FromStr for LogChoice {
    type Err = std::convert::Infallible;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "all" => Self::All,
            participant => Self::Of(participant.to_owned()),
        })
    }
}

impl LogChoice {
    /// Whether a participant's logs are written.
    pub fn cover(&self, participant: &ParticipantId) -> bool {
        match self {
            Self::All => true,
            Self::Of(one) => one == participant.as_str(),
        }
    }

    /// Checks that the one asked for is among the participants.
    ///
    /// # Errors
    /// [`StudyError::NotPossible`] naming some who are.
    pub fn check<'a>(
        &self,
        participants: impl Iterator<Item = &'a ParticipantId>,
    ) -> Result<(), StudyError> {
        match self {
            Self::Of(one) => known(one, participants),
            Self::All => Ok(()),
        }
    }
}

/// The participants whose drives are written as logs too.
pub(super) struct Logged<'a> {
    wished: Option<&'a LogChoice>,
    shown: Option<&'a ParticipantId>,
}

impl<'a> Logged<'a> {
    /// Those of whom logs are asked; without such a wish the one whom the report shows: a log takes longer to write than its drive
    /// to be driven, and nothing else reads it.
    pub(super) fn new(options: &'a Simulate, conditions: &'a [ConditionRow]) -> Self {
        let shown = options.logs.is_none().then(|| in_the_middle(conditions));
        Self { wished: options.logs.as_ref(), shown: shown.flatten() }
    }

    pub(super) fn cover(&self, participant: &ParticipantId) -> bool {
        let wished = self.wished.is_some_and(|whose| whose.cover(participant));
        self.shown == Some(participant) || wished
    }
}

/// Whose own style reads as the middle score of all: both directions of the dial show best there.
pub(super) fn in_the_middle(conditions: &[ConditionRow]) -> Option<&ParticipantId> {
    let unmoved = |row: &&ConditionRow| row.moved_points.is_some_and(|by| by.abs() < 1e-9);
    let mut rows: Vec<&ConditionRow> = conditions.iter().filter(unmoved).collect();
    if rows.is_empty() {
        rows = conditions.iter().collect();
    }
    // Who reads as no score comes last.
    let score = |row: &ConditionRow| row.adb_hat.unwrap_or(f64::INFINITY);
    rows.sort_by(|a, b| score(a).total_cmp(&score(b)));
    let scored = rows.iter().filter(|row| row.adb_hat.is_some()).count();
    Some(&rows.get(scored.saturating_sub(1) / 2)?.participant)
}

/// Where the log of a drive lies.
pub(super) fn log_of(out: &Path, drive: &str) -> PathBuf {
    out.join("logs").join(format!("{drive}.mcap"))
}

/// Checks that a participant is among those there are.
pub(super) fn known<'a>(
    wanted: &str,
    participants: impl Iterator<Item = &'a ParticipantId>,
) -> Result<(), StudyError> {
    let there: BTreeSet<&str> = participants.map(ParticipantId::as_str).collect();
    if there.contains(wanted) {
        return Ok(());
    }
    let problem = format!(
        "there is no participant {wanted} among the {}: {}",
        there.len(),
        first_names(&there, 5)
    );
    Err(StudyError::not_possible(problem).with_help("give one of them"))
}
