//! Somebody with a link: their steps, and how far they have come.

use crate::{listed::Listed, steps::Step};
use maveric_domain::{Occasion, survey::Kind};
use maveric_seat_page::Fit;
use serde_json::{Value, json};

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

/// The steps of somebody who was let in. Before items had kinds a questionnaire kept their texts, and one range for all of them; so did
/// what is asked on the way.
fn steps_kept(text: &str) -> serde_json::Result<Vec<Step>> {
    let mut steps: Vec<Value> = serde_json::from_str(text)?;
    for step in &mut steps {
        for key in ["probe", "again"] {
            if let Some(probe) = step.get_mut(key) {
                let range = (probe["min"].clone(), probe["max"].clone());
                if let Some(text) = probe.get_mut("question") {
                    boxes(text, &range);
                }
            }
        }
        let range = (step["min"].clone(), step["max"].clone());
        let items = step.get_mut("items").and_then(Value::as_array_mut);
        for text in items.into_iter().flatten() {
            boxes(text, &range);
        }
    }
    serde_json::from_value(Value::Array(steps))
}

/// Makes an item of what was kept as a text alone.
fn boxes(text: &mut Value, (min, max): &(Value, Value)) {
    if text.is_string() {
        *text =
            json!({"kind": Kind::Likert, "min": min, "max": max, "step": 1, "text": text.take()});
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steps::AskedProbe;

    #[test]
    fn what_was_kept_as_a_text_alone_is_boxes_and_a_probe_with_its_item_stays() {
        let rule = json!({"rule": "misc >= 6", "than": ">=", "value": 6});
        let probe = |question: Value| {
            let mut probe = json!({"scale": "misc", "question": question, "every_s": 60.0, "within_s": 10.0, "stop": rule});
            if probe["question"].is_string() {
                (probe["min"], probe["max"]) = (json!(0), json!(10));
            }
            probe
        };
        let practice = |probe: Value| json!({"kind": "practice", "seconds": 60.0, "lane_kept_s": 3.0, "passes": 0, "seed": "1", "probe": probe});
        let ladder = json!({"kind": "ladder", "min": 0, "max": 1, "step": 1, "text": "Sick?", "anchors": ["no", "yes"]});
        let steps = json!([
            practice(probe(json!("How sick?"))),
            {"kind": "scale", "scale": "mood", "moment": "pre", "items": ["Calm?"], "min": 1, "max": 5},
            practice(probe(ladder)),
            {"kind": "aftercare", "text": "Rest.", "again": probe(json!("How sick?"))},
        ]);
        let steps = steps_kept(&steps.to_string()).unwrap();
        let is_boxes = |probe: &AskedProbe| {
            let item = &probe.question.item;
            (item.kind, item.min, item.max) == (Kind::Likert, 0, 10)
        };
        let asked = steps[0].probe().unwrap();
        assert!(is_boxes(asked) && asked.question.words.text == "How sick?");
        assert!(asked.takes(10) && asked.stops(6));
        let Step::Scale { items, .. } = &steps[1] else {
            panic!("{:?}", steps[1]);
        };
        assert_eq!((items[0].item.min, items[0].item.max), (1, 5));
        let asked = steps[2].probe().unwrap();
        assert_eq!(asked.question.item.kind, Kind::Ladder);
        assert_eq!(asked.question.words.anchors, ["no", "yes"]);
        let Step::Aftercare {
            again: Some(again), ..
        } = &steps[3]
        else {
            panic!("{:?}", steps[3]);
        };
        assert!(is_boxes(again));
    }
}
