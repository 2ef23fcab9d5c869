//! Questionnaire answers (long) and their scores.

use super::{Table, TableBuilder};
use crate::error::StudyError;
use maveric_domain::{Answer, Moment, ParticipantId, Score};
use maveric_measures::survey::SheetTime;
use std::{collections::BTreeMap, path::Path};

/// Writes answers: participant, moment, scale, item, answer.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_answers(path: &Path, answers: &[Answer]) -> Result<(), StudyError> {
    TableBuilder::default()
        .text(
            "participant",
            answers.iter().map(|a| a.participant.as_str()),
        )
        .text("moment", answers.iter().map(|a| a.moment.to_string()))
        .text("scale", answers.iter().map(|a| a.scale.as_str()))
        .integers("item", answers.iter().map(|a| Some(i64::from(a.item))))
        .integers("answer", answers.iter().map(|a| a.answer.map(i64::from)))
        .write(path)
}

/// Reads answers back.
///
/// # Errors
/// As [`Table`] does; [`StudyError::BadCell`] for an item or answer that is no whole number.
pub fn read_answers(path: &Path) -> Result<Vec<Answer>, StudyError> {
    answers_of(&Table::read(path)?)
}

/// Reads answers and, where the table has a column `seconds`, how long people took: the mean over the items of each sheet,
/// ordered by participant, moment and scale.
///
/// # Errors
/// As [`read_answers`]; [`StudyError::BadCell`] for a time that is no number, or negative.
pub fn read_timed_answers(path: &Path) -> Result<(Vec<Answer>, Vec<SheetTime>), StudyError> {
    let table = Table::read(path)?;
    Ok((answers_of(&table)?, times_of(&table)?))
}

fn answers_of(table: &Table) -> Result<Vec<Answer>, StudyError> {
    let participant: Vec<ParticipantId> = table.ids("participant")?;
    let moment: Vec<Moment> = table.parsed("moment")?;
    let scale = table.text("scale")?;
    let item: Vec<u32> = table.parsed("item")?;
    let answer = table.text("answer")?;
    let whole = |row: usize| match answer[row].as_deref().map(str::trim) {
        None | Some("" | "NA") => Ok(None),
        Some(text) => text.parse::<i32>().map(Some).map_err(|_| {
            table.bad_cell(
                row,
                "answer",
                text,
                "a whole number, or empty where it was left out",
            )
        }),
    };
    (0..table.rows())
        .map(|row| {
            Ok(Answer {
                participant: participant[row].clone(),
                moment: moment[row],
                scale: scale[row].clone().unwrap_or_default(),
                item: item[row],
                answer: whole(row)?,
            })
        })
        .collect()
}

fn times_of(table: &Table) -> Result<Vec<SheetTime>, StudyError> {
    if !table.has("seconds") {
        return Ok(Vec::new());
    }
    let participant: Vec<ParticipantId> = table.ids("participant")?;
    let moment: Vec<Moment> = table.parsed("moment")?;
    let scale = table.text("scale")?;
    let mut sheets: BTreeMap<(ParticipantId, Moment, String), (f64, f64)> = BTreeMap::new();
    for (row, seconds) in table.numbers("seconds")?.into_iter().enumerate() {
        let Some(seconds) = seconds else { continue };
        if seconds < 0.0 {
            let expected = "a time in s, not negative";
            return Err(table.bad_cell(row, "seconds", seconds.to_string(), expected));
        }
        let name = scale[row].clone().unwrap_or_default();
        let sheet = sheets
            .entry((participant[row].clone(), moment[row], name))
            .or_default();
        (sheet.0, sheet.1) = (sheet.0 + seconds, sheet.1 + 1.0);
    }
    let mean = |((participant, moment, scale), (sum, n))| SheetTime {
        participant,
        moment,
        scale,
        seconds_an_item: sum / n,
    };
    Ok(sheets.into_iter().map(mean).collect())
}

/// Writes scores: participant, moment, scale, subscale, value, answered, items.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_scores(path: &Path, scores: &[Score]) -> Result<(), StudyError> {
    TableBuilder::default()
        .text("participant", scores.iter().map(|s| s.participant.as_str()))
        .text("moment", scores.iter().map(|s| s.moment.to_string()))
        .text("scale", scores.iter().map(|s| s.scale.as_str()))
        .text("subscale", scores.iter().map(|s| s.subscale.as_str()))
        .numbers("value", scores.iter().map(|s| s.value))
        .integers(
            "answered",
            scores.iter().map(|s| Some(i64::from(s.answered))),
        )
        .integers("items", scores.iter().map(|s| Some(i64::from(s.items))))
        .write(path)
}

/// Reads scores back.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_scores(path: &Path) -> Result<Vec<Score>, StudyError> {
    let table = Table::read(path)?;
    table.each_once(&["participant", "moment", "scale", "subscale"])?;
    let participant: Vec<ParticipantId> = table.ids("participant")?;
    let moment: Vec<Moment> = table.parsed("moment")?;
    let scale = table.text("scale")?;
    let subscale = table.text("subscale")?;
    let value = table.numbers("value")?;
    let answered: Vec<u32> = table.parsed("answered")?;
    let items: Vec<u32> = table.parsed("items")?;
    Ok((0..table.rows())
        .map(|row| Score {
            participant: participant[row].clone(),
            moment: moment[row],
            scale: scale[row].clone().unwrap_or_default(),
            subscale: subscale[row].clone().unwrap_or_default(),
            value: value[row],
            answered: answered[row],
            items: items[row],
        })
        .collect())
}
