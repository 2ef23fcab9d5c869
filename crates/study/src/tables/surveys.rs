//! Questionnaire answers (long) and their scores.
//!
//! A table of answers has the moment in one column (`pre`, or the id of a condition), or `moment` (`pre`, `after`, `probe`, `post`) beside
//! `condition`.

use super::{Table, TableName, write_rows};
use crate::error::StudyError;
use maveric_domain::{
    Answer, ConditionId, Design, Moment, Occasion, ParticipantId, ProbeAnswer, Score,
    occasion::{self, OCCASION},
};
use maveric_measures::survey::SheetTime;
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    num::NonZeroU32,
    path::Path,
};

/// What a table of answers says of one.
#[derive(Deserialize)]
struct Cells {
    participant: ParticipantId,
    scale: String,
    item: u32,
    answer: Option<i32>,
}

/// A row of a table of answers that has more than those of before: the rest stands in the row's fields of this name.
#[derive(Serialize)]
struct Row<'a> {
    participant: &'a ParticipantId,
    moment: &'static str,
    condition: Option<ConditionId>,
    scale: &'a str,
    item: u32,
    answer: Option<i32>,
    at_s: Option<f64>,
}

/// What a moment is called beside the condition that it is about.
pub fn moment_word(moment: Moment) -> &'static str {
    match moment {
        Moment::Pre => "pre",
        Moment::After(_) => "after",
        Moment::Probe(_) => "probe",
        Moment::Post => "post",
    }
}

/// A moment by its word and its condition; `word` may be a condition's id, as in a table of one column.
fn moment_of(word: &str, condition: Option<ConditionId>) -> Option<Moment> {
    match (word, condition) {
        ("after", Some(condition)) => Some(Moment::after(condition)),
        ("probe", Some(condition)) => Some(Moment::probe(condition)),
        ("pre" | "post", Some(_)) | ("after" | "probe", None) => None,
        (word, condition) => {
            let moment: Moment = word.parse().ok()?;
            (condition.is_none() || moment.condition() == condition).then_some(moment)
        }
    }
}

/// The moment of each row of a table of answers or scores, with its session and trial where the table has them.
///
/// # Errors
/// [`StudyError::NoColumn`]; [`StudyError::BadCell`] for a moment that is none, and a session or trial that is no whole number from 1 or
/// of what is asked once.
pub fn moments(table: &Table) -> Result<Vec<Moment>, StudyError> {
    with_occasions(table, words_as_moments(table)?)
}

/// Moments with the session and the trial of their rows.
fn with_occasions(table: &Table, moments: Vec<Moment>) -> Result<Vec<Moment>, StudyError> {
    let on = |((row, moment), occasion): ((usize, Moment), Occasion)| {
        if moment.ride().is_none() && occasion != Occasion::FIRST {
            let column = OCCASION.into_iter().find(|column| table.has(column));
            let expected =
                "nothing or 1: what is asked before the drives or at the end is asked once";
            let given = occasion.to_string();
            return Err(table.bad_cell(row, column.unwrap_or("moment"), given, expected));
        }
        Ok(match occasion {
            Occasion::FIRST => moment,
            occasion => moment.on(occasion),
        })
    };
    let moments = moments.into_iter().enumerate();
    moments.zip(occasions(table)?).map(on).collect()
}

/// The session and the trial of each row of a table; the first where it does not say.
///
/// # Errors
/// [`StudyError::BadCell`] for what is no whole number from 1.
pub(crate) fn occasions(table: &Table) -> Result<Vec<Occasion>, StudyError> {
    let column = |name: &str| {
        if !table.has(name) {
            return Ok(vec![occasion::first(); table.rows()]);
        }
        let number = |(row, cell): (usize, Option<String>)| match cell.as_deref().map(str::trim) {
            None | Some("" | "NA") => Ok(occasion::first()),
            Some(text) => {
                text.parse().map_err(|_| table.bad_cell(row, name, text, "a whole number from 1"))
            }
        };
        let cells = table.text(name)?.into_iter().enumerate();
        cells.map(number).collect()
    };
    let [sessions, trials]: [Result<Vec<NonZeroU32>, StudyError>; 2] = OCCASION.map(column);
    let both = sessions?.into_iter().zip(trials?);
    Ok(both.map(|(session, trial)| Occasion { session, trial }).collect())
}

/// The moment of each row by its words alone.
fn words_as_moments(table: &Table) -> Result<Vec<Moment>, StudyError> {
    let words = table.text("moment")?.into_iter().map(Option::unwrap_or_default);
    if !table.has("condition") {
        // A table of before knows no end of the study: `post` can only be a condition.
        let moment = |(row, word): (usize, String)| match word.parse() {
            Ok(Moment::Post) => Ok(Moment::After(word.parse()?)),
            Ok(moment) => Ok(moment),
            Err(error) => {
                let expected = format!("`pre`, or the condition after which it was asked: {error}");
                Err(table.bad_cell(row, "moment", word, expected))
            }
        };
        return words.enumerate().map(moment).collect();
    }
    let moment = |((row, word), condition): ((usize, String), Option<String>)| {
        let id = condition.as_ref().map(|id| id.parse()).transpose();
        let id = id.map_err(|_| {
            let given = condition.as_deref().unwrap_or_default();
            table.bad_cell(row, "condition", given, "the id of a condition, or nothing")
        })?;
        moment_of(&word, id).ok_or_else(|| {
            let expected = "`pre` or `post` without a condition, `after` or `probe` with one";
            table.bad_cell(row, "moment", &word, expected)
        })
    };
    words.enumerate().zip(table.text("condition")?).map(moment).collect()
}

/// The answers of a table, each with its row: those to probes, and all others.
#[derive(Debug, Default)]
pub struct Answered {
    pub answers: Vec<Answer>,
    /// Those to probes, with the time of each.
    pub probes: Vec<ProbeAnswer>,
    /// How long people took, where the table says it.
    pub times: Vec<SheetTime>,
}

/// Reads answers, those to probes apart.
///
/// # Errors
/// As [`Table`] does; [`StudyError::BadCell`] for a moment that is none, an item or answer that is no whole number, a probe without its
/// time, and a time that is no number, or negative.
pub fn read_answered(path: &Path) -> Result<Answered, StudyError> {
    let table = Table::read(path)?;
    let cells: Vec<Cells> = table.records()?;
    let moments = moments(&table)?;
    let at_s = table.numbers_if_there("at_s")?;
    let seconds = table.numbers_if_there("seconds")?;
    let mut answered = Answered::default();
    let mut sheets: BTreeMap<(ParticipantId, Moment, String), (f64, f64)> = BTreeMap::new();
    for (row, (cells, moment)) in cells.into_iter().zip(moments).enumerate() {
        let Cells { participant, scale, item, answer } = cells;
        if let Moment::Probe(ride) = moment {
            let at_s = at_s[row].filter(|s| *s >= 0.0).ok_or_else(|| {
                let expected = "when the probe was asked, in s since the drive began";
                table.bad_cell(row, "at_s", String::new(), expected)
            })?;
            answered.probes.push(ProbeAnswer { participant, ride, scale, at_s, answer });
            continue;
        }
        if let Some(seconds) = seconds[row] {
            if seconds < 0.0 {
                let expected = "a time in s, not negative";
                return Err(table.bad_cell(row, "seconds", seconds.to_string(), expected));
            }
            let sheet = (participant.clone(), moment, scale.clone());
            let (sum, n) = sheets.entry(sheet).or_default();
            (*sum, *n) = (*sum + seconds, *n + 1.0);
        }
        answered.answers.push(Answer { participant, moment, scale, item, answer });
    }
    let mean = |((participant, moment, scale), (sum, n))| SheetTime {
        participant,
        moment,
        scale,
        seconds_an_item: sum / n,
    };
    answered.times = sheets.into_iter().map(mean).collect();
    Ok(answered)
}

/// Reads answers of questionnaires; those to probes are left out.
pub fn read_answers(path: &Path) -> Result<Vec<Answer>, StudyError> {
    Ok(read_answered(path)?.answers)
}

/// Writes rows with their moments as a table has them: without session and trial, which stand beside them.
pub(crate) fn write_moments<T: Clone + Serialize>(
    table: TableName,
    path: &Path,
    rows: &[T],
    moment: fn(&mut T) -> &mut Moment,
) -> Result<(), StudyError> {
    let beside_occasion = |row: &T| {
        let mut row = row.clone();
        let moment = moment(&mut row);
        let occasion = moment.ride().map_or(Occasion::FIRST, |ride| ride.occasion);
        *moment = moment.on(Occasion::FIRST);
        (row, occasion)
    };
    write_rows(table, path, rows.iter().map(beside_occasion))
}

/// Writes a row for each person, moment and subscale.
pub(crate) fn write_scores(path: &Path, scores: &[Score]) -> Result<(), StudyError> {
    write_moments(TableName::Scores, path, scores, |s| &mut s.moment)
}

/// Writes answers, with `condition` and `at_s` where somebody was asked during a drive or at the end.
pub fn write_answers(
    path: &Path,
    answers: &[Answer],
    probes: &[ProbeAnswer],
) -> Result<(), StudyError> {
    let alone: Vec<(Answer, ())> = answers.iter().cloned().map(|a| (a, ())).collect();
    write_answers_with(path, &alone, probes)
}

/// As [`write_answers`]; each answer with more cells of its row.
pub(crate) fn write_answers_with<C: Clone + Serialize>(
    path: &Path,
    answers: &[(Answer, C)],
    probes: &[ProbeAnswer],
) -> Result<(), StudyError> {
    if probes.is_empty() && answers.iter().all(|(a, _)| a.moment != Moment::Post) {
        return write_moments(TableName::Answers, path, answers, |(a, _)| &mut a.moment);
    }
    let sheets = answers.iter().map(|(a, more)| {
        let ride = a.moment.ride();
        let row = Row {
            participant: &a.participant,
            moment: moment_word(a.moment),
            condition: a.moment.condition(),
            scale: &a.scale,
            item: a.item,
            answer: a.answer,
            at_s: None,
        };
        let occasion = ride.map_or(Occasion::FIRST, |ride| ride.occasion);
        (row, occasion, Some(more))
    });
    let probes = probes.iter().map(|p| {
        let row = Row {
            participant: &p.participant,
            moment: moment_word(Moment::Probe(p.ride)),
            condition: Some(p.ride.condition),
            scale: &p.scale,
            item: 1,
            answer: p.answer,
            at_s: Some(p.at_s),
        };
        (row, p.ride.occasion, None)
    });
    write_rows(TableName::Answers, path, sheets.chain(probes))
}

/// Refuses answers that say `pre` for a condition that is called so.
///
/// They show in somebody who answered a scale after every other condition and at `pre`, where nobody says `after:pre`.
///
/// # Errors
/// [`StudyError::BadFile`] naming person and scale, and what to write.
pub(crate) fn refuse_unclear(
    path: &Path,
    answers: &[Answer],
    design: &Design,
) -> Result<(), StudyError> {
    let ids = || design.condition_ids();
    let Some(shared) = ids().find(|id| Moment::is_shared_word(*id)) else {
        return Ok(());
    };
    let mut sheets: BTreeMap<(&ParticipantId, &str), BTreeSet<Moment>> = BTreeMap::new();
    for answer in answers {
        let sheet = (&answer.participant, answer.scale.as_str());
        sheets.entry(sheet).or_default().insert(answer.moment);
    }
    let clear = Moment::after(shared);
    if sheets.values().any(|moments| moments.contains(&clear)) {
        return Ok(());
    }
    let others: Vec<Moment> = ids().filter(|id| *id != shared).map(Moment::after).collect();
    let unclear = |moments: &BTreeSet<Moment>| {
        moments.contains(&Moment::Pre) && others.iter().all(|other| moments.contains(other))
    };
    let Some((who, scale)) = sheets.iter().find(|(_, m)| unclear(m)).map(|(s, _)| *s) else {
        return Ok(());
    };
    let problem = format!(
        "column `moment`: {who} answered `{scale}` at `{}`, which marks the time before the drives, and after every condition but `{shared}`",
        Moment::Pre
    );
    let help = format!("write `{clear}` for what was asked after the condition `{shared}`");
    Err(StudyError::file(path, problem).with_help(help))
}

/// Reads scores back; refuses two scores of one subscale at one moment of a person.
pub(crate) fn read_scores(path: &Path) -> Result<Vec<Score>, StudyError> {
    let table = Table::read(path)?;
    let mut key = vec!["participant", "moment", "scale", "subscale"];
    key.extend(OCCASION.into_iter().filter(|column| table.has(column)));
    table.each_once(&key)?;
    let mut scores: Vec<Score> = table.records()?;
    let moments = scores.iter().map(|score| score.moment).collect();
    for (score, moment) in scores.iter_mut().zip(with_occasions(&table, moments)?) {
        score.moment = moment;
    }
    Ok(scores)
}

#[cfg(test)]
mod tests;
