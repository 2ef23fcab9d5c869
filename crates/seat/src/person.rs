//! Somebody with a link: their steps, and how far they have come.

use crate::{listed::Listed, steps::Step};
use maveric_domain::Occasion;
use maveric_seat_page::Fit;

/// A style as it is kept.
pub(crate) fn style_kept(fit: Option<&str>) -> Option<Fit> {
    serde_json::from_str(fit?).ok()
}

/// How the part of somebody ended who does not take part.
pub(crate) const NOT_ADMITTED: &str = "not admitted";

/// How the part of somebody ended whom nobody waits for any more.
pub(crate) const NEVER_CAME: &str = "never came";

/// Whether nobody takes part before they went past this step: it is judged here, or agreed to.
pub(crate) fn lets_in(step: &Step) -> bool {
    step.rules().is_some() || matches!(step, Step::Text { agree: true, .. })
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Person {
    pub(crate) token: String,
    pub(crate) participant: String,
    pub(crate) steps: Vec<Step>,
    /// The step they are at.
    pub(crate) at: usize,
    /// How their part ended: `done`, `left`, [`NOT_ADMITTED`] or [`NEVER_CAME`].
    pub(crate) ended: Option<String>,
    pub(crate) fit: Option<String>,
    /// What stands of them in the study's table of people.
    pub(crate) listed: Listed,
    /// Their row of the square, counted on through all its repetitions from 0; none of who does not ride, or in an order of no row.
    pub(crate) row: Option<usize>,
}

impl Person {
    /// Somebody at the first of their steps.
    pub(crate) fn new(token: String, participant: String, steps: Vec<Step>) -> Self {
        Self {
            token,
            participant,
            steps,
            at: 0,
            ended: None,
            fit: None,
            listed: Listed::NotYet,
            row: None,
        }
    }

    /// Whether they were admitted and agreed, where people are judged and asked.
    pub(crate) fn is_let_in(&self) -> bool {
        let mut ahead = self.steps.iter().skip(self.at);
        let gone = matches!(self.ended.as_deref(), Some(NOT_ADMITTED | NEVER_CAME));
        !gone && !ahead.any(lets_in)
    }

    /// The conditions that they ride, in their order: that of each round of rides.
    pub(crate) fn rides(&self) -> Vec<String> {
        let ridden = self.steps.iter().filter_map(Step::ridden);
        ridden
            .filter(|ride| ride.occasion == Occasion::FIRST)
            .map(|ride| ride.condition.to_string())
            .collect()
    }

    /// The language that they chose; none where nobody was asked, or has not answered.
    pub(crate) fn language(&self) -> Option<&str> {
        self.steps.iter().find_map(|step| match step {
            Step::Language { chosen, .. } => chosen.as_deref(),
            _ => None,
        })
    }

    /// What was learned of their drive; none before that.
    pub(crate) fn style(&self) -> Option<Fit> {
        style_kept(self.fit.as_deref())
    }

    pub(crate) fn read(row: &rusqlite::Row<'_>) -> rusqlite::Result<Self> {
        let steps: String = row.get(2)?;
        let steps = serde_json::from_str(&steps).map_err(|e| {
            rusqlite::Error::FromSqlConversionFailure(2, rusqlite::types::Type::Text, Box::new(e))
        })?;
        Ok(Self {
            token: row.get(0)?,
            participant: row.get(1)?,
            steps,
            at: row.get::<_, i64>(3)? as usize,
            ended: row.get(4)?,
            fit: row.get(5)?,
            listed: Listed::read(row.get(6)?),
            row: row.get::<_, Option<i64>>(7)?.map(|row| row as usize),
        })
    }
}
