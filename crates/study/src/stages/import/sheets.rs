//! Answers as every reader finds them in an export, and what becomes of them: a row an answer.

use super::{
    columns::{Columns, Slot, When},
    workbook::{FORMULA, in_place_of_value},
};
use crate::error::StudyError;
use maveric_domain::{ConditionId, Moment, ParticipantId, survey::Kind};
use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// One answer with the time it took.
pub(super) struct Row {
    pub(super) participant: ParticipantId,
    pub(super) moment: Moment,
    pub(super) scale: usize,
    pub(super) item: u32,
    pub(super) answer: Option<i32>,
    /// What was written, of an item that asks for words.
    pub(super) words: Option<String>,
    pub(super) seconds: Option<f64>,
    /// Where in the file it stands, for messages.
    pub(super) place: String,
}

impl Row {
    /// Whether the item was not left out.
    pub(super) fn is_answered(&self) -> bool {
        self.answer.is_some() || self.words.is_some()
    }
}

/// What somebody filled in at one time: a page of oTree, a trial of jsPsych, a row of other tables.
pub(super) struct Page<'e> {
    /// Where it is in the file.
    pub(super) place: String,
    pub(super) participant: Cow<'e, str>,
    /// The field that says when, and its word.
    pub(super) moment: Option<(&'e str, Cow<'e, str>)>,
    /// Each answer with the name of its field.
    pub(super) fields: Vec<(Slot, &'e str, Cow<'e, str>)>,
    /// Whether it was shown even where nothing is filled in.
    pub(super) shown: bool,
    /// Whether answers are positions of boxes, the first of which is 0.
    pub(super) from_zero: bool,
    /// How long each answer took.
    pub(super) seconds: Option<f64>,
}

/// What a reader makes of a file.
#[derive(Default)]
pub(super) struct Contents {
    pub(super) rows: Vec<Row>,
    /// Names that belong to no scale.
    pub(super) unused: BTreeSet<String>,
    pub(super) warnings: Vec<String>,
}

/// The conditions of each person in the order of the rides, where the table of people says it.
pub(super) type Orders = BTreeMap<ParticipantId, Vec<ConditionId>>;

/// What the answers of a file are read by.
pub(super) struct Reading<'a> {
    pub(super) path: &'a Path,
    pub(super) columns: &'a Columns<'a>,
    pub(super) orders: &'a Orders,
    /// The software's words for no answer.
    pub(super) missing: &'a [&'a str],
}

impl Reading<'_> {
    /// The answers of a page; none where the person never reached it.
    ///
    /// # Errors
    /// [`StudyError::BadFile`] naming place, field and what was expected: an id, a moment or an answer that is none.
    pub(super) fn rows_of(&self, page: &Page<'_>) -> Result<Vec<Row>, StudyError> {
        let bad = |problem: String| StudyError::file(self.path, problem);
        let sheet = |slot: &Slot| (slot.scale, slot.when);
        let filled = page.fields.iter().filter(|(_, _, text)| !text.trim().is_empty());
        let reached: BTreeSet<_> = filled.map(|(slot, ..)| sheet(slot)).collect();
        let is_there = |slot: &Slot| page.shown || reached.contains(&sheet(slot));
        let mut rows = Vec::new();
        for (slot, name, text) in page.fields.iter().filter(|(slot, ..)| is_there(slot)) {
            let place = format!("{}, `{name}`", page.place);
            let participant = ParticipantId::new(page.participant.trim())
                .map_err(|e| bad(format!("{}: {e}", page.place)))?;
            let moment = self.moment(page, slot.when, &participant)?;
            if let Moment::Probe(ride) = moment {
                let problem = format!(
                    "{place} (participant {participant}): `{moment}` is a probe, and an export does not say when in the ride it was asked"
                );
                let help = format!(
                    "write `{}` for what was asked after the ride; probes are read from the table that is scored (software = \"table\"), with their `at_s`",
                    ride.condition
                );
                return Err(StudyError::file(self.path, problem).with_help(help));
            }
            let scale = &self.columns.scales[slot.scale];
            let wrong = |problem: String| {
                let (id, item) = (&scale.id, slot.item);
                bad(format!(
                    "participant {participant} ({moment}), scale `{id}`, item {item} ({place}): {problem}"
                ))
            };
            let Some(item) = scale.item(slot.item) else {
                return Err(wrong(format!("the scale has {} items", scale.count())));
            };
            let add = if page.from_zero { item.min } else { 0 };
            let is_given =
                |words: &String| !words.is_empty() && !self.columns.is_missing(words, self.missing);
            let words = (item.kind == Kind::Text).then(|| text.trim().to_owned());
            let answer = match &words {
                Some(formula) if formula == FORMULA => {
                    return Err(wrong(in_place_of_value(formula)));
                }
                Some(_) => None,
                None => {
                    self.columns.answer_of(slot, item, text, add, self.missing).map_err(wrong)?
                }
            };
            rows.push(Row {
                participant,
                moment,
                scale: slot.scale,
                item: slot.item,
                answer,
                words: words.filter(is_given),
                seconds: page.seconds,
                place,
            });
        }
        Ok(rows)
    }

    fn moment(
        &self,
        page: &Page<'_>,
        when: When,
        id: &ParticipantId,
    ) -> Result<Moment, StudyError> {
        let wrong = |problem: String| {
            let problem = format!("{} (participant {id}){problem}", page.place);
            StudyError::file(self.path, problem)
        };
        match (when, &page.moment) {
            (When::Known(moment), _) => Ok(moment),
            (When::Trial(trial), _) => {
                let order = self.orders.get(id).map(Vec::as_slice).unwrap_or_default();
                let condition = trial.checked_sub(1).and_then(|at| order.get(at));
                condition.map(|id| Moment::after(*id)).ok_or_else(|| {
                    wrong(format!(
                        ": answers about ride {trial}, and the table of people has an `order` of {} conditions for them; write it there, or put the condition's name in place of the number",
                        order.len()
                    ))
                })
            }
            (When::Unsaid, None) => Ok(Moment::Pre),
            (When::Unsaid, Some((field, word))) => {
                self.columns.moment_of(word).map_err(|e| wrong(format!(", `{field}`: {e}")))
            }
        }
    }
}
