//! Somebody with a link: their steps, and how far they have come.

use crate::{listed::Listed, steps::Step};
use maveric_domain::{BeyondWhy, Occasion, survey::Kind};
use maveric_seat_page::Fit;
use serde_json::{Value, json};

/// A style as the page or the seat learned it, without a score where the scale has none: it is beyond what the model has learned from.
pub(crate) fn on_the_scale(style: Fit) -> Fit {
    let (score, beyond) = BeyondWhy::of_reading(style.score, style.beyond);
    Fit {
        score,
        beyond,
        ..style
    }
}

/// A style as it is kept.
pub(crate) fn style_kept(fit: Option<&str>) -> Option<Fit> {
    serde_json::from_str(fit?).ok().map(on_the_scale)
}

/// How the part of somebody ended who does not take part.
pub(crate) const NOT_ADMITTED: &str = "not admitted";

/// How the part of somebody ended whom nobody waits for any more.
pub(crate) const NEVER_CAME: &str = "never came";

/// Somebody with a link.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Person {
    pub(crate) token: String,
    /// Never in a link.
    pub(crate) participant: String,
    pub(crate) steps: Vec<Step>,
    /// The step they are at.
    pub(crate) at: usize,
    /// How their part ended: `done`, `left`, [`NOT_ADMITTED`] or [`NEVER_CAME`].
    pub(crate) ended: Option<String>,
    /// Their style, as JSON.
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

    /// Whether they take part still, or did to the end: the others leave their row to whoever comes next.
    pub(crate) fn has_place(&self) -> bool {
        matches!(self.ended.as_deref(), None | Some("done"))
    }

    /// Whether they were not admitted.
    pub(crate) fn was_refused(&self) -> bool {
        self.ended.as_deref() == Some(NOT_ADMITTED)
    }

    /// Whether they take part: nobody does before they were judged.
    pub(crate) fn is_admitted(&self) -> bool {
        let ahead = self.steps.iter().skip(self.at);
        !self.was_refused() && !ahead.into_iter().any(|step| step.rules().is_some())
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

    /// Why the drive that their style was learned of is beyond what the model has learned from; none where it is not.
    pub(crate) fn beyond(&self) -> Option<BeyondWhy> {
        self.style()?.beyond
    }

    pub(crate) fn read(row: &rusqlite::Row<'_>) -> rusqlite::Result<Self> {
        let steps: String = row.get(2)?;
        let steps = steps_kept(&steps).map_err(|e| {
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

/// The steps of somebody who was let in. Before items had kinds a questionnaire kept their texts, and one range for all of them.
fn steps_kept(text: &str) -> serde_json::Result<Vec<Step>> {
    let mut steps: Vec<Value> = serde_json::from_str(text)?;
    for step in &mut steps {
        let (min, max) = (step["min"].clone(), step["max"].clone());
        let Some(items) = step.get_mut("items").and_then(Value::as_array_mut) else {
            continue;
        };
        for item in items.iter_mut().filter(|item| item.is_string()) {
            *item = json!({"kind": Kind::Likert, "min": min, "max": max, "step": 1, "text": item.take()});
        }
    }
    serde_json::from_value(Value::Array(steps))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_style_that_reads_as_no_score_of_the_scale_has_none_and_is_beyond() {
        let style = |score: f64| {
            on_the_scale(Fit {
                embedding: vec![0.5],
                covariance: None,
                score: Some(score),
                readings: 3,
                beyond: None,
            })
        };
        assert_eq!((style(30.0).score, style(30.0).beyond), (Some(30.0), None));
        for none in [-1.3, 55.5] {
            let style = style(none);
            assert_eq!((style.score, style.beyond), (None, Some(BeyondWhy::Scale)));
            assert_eq!(style.embedding, [0.5]);
        }
    }
}
