//! Questionnaire answers (long) and their scores.

use super::{Table, read_rows};
use crate::error::StudyError;
use maveric_domain::{Answer, Design, Moment, ParticipantId, Score};
use maveric_measures::survey::SheetTime;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Reads answers.
///
/// # Errors
/// As [`Table`] does; [`StudyError::BadCell`] for an item or answer that is no whole number.
pub fn read_answers(path: &Path) -> Result<Vec<Answer>, StudyError> {
    read_rows(path)
}

/// Reads answers and, where the table has a column `seconds`, how long people took: the mean over the items of each sheet,
/// ordered by participant, moment and scale.
///
/// # Errors
/// As [`read_answers`]; [`StudyError::BadCell`] for a time that is no number, or negative.
pub fn read_timed_answers(path: &Path) -> Result<(Vec<Answer>, Vec<SheetTime>), StudyError> {
    let table = Table::read(path)?;
    Ok((table.records()?, times_of(&table)?))
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
    let ids = || design.conditions().iter().map(|c| c.id);
    let Some(shared) = ids().find(|id| Moment::is_shared_word(*id)) else {
        return Ok(());
    };
    let mut sheets: BTreeMap<(&ParticipantId, &str), BTreeSet<Moment>> = BTreeMap::new();
    for answer in answers {
        let sheet = (&answer.participant, answer.scale.as_str());
        sheets.entry(sheet).or_default().insert(answer.moment);
    }
    let clear = Moment::After(shared);
    if sheets.values().any(|moments| moments.contains(&clear)) {
        return Ok(());
    }
    let others: Vec<Moment> = ids()
        .filter(|id| *id != shared)
        .map(Moment::After)
        .collect();
    let unclear = |moments: &BTreeSet<Moment>| {
        moments.contains(&Moment::Pre) && others.iter().all(|other| moments.contains(other))
    };
    let Some((who, scale)) = sheets.iter().find(|(_, m)| unclear(m)).map(|(s, _)| *s) else {
        return Ok(());
    };
    Err(StudyError::BadFile {
        path: path.to_owned(),
        problem: format!(
            "column `moment`: {who} answered `{scale}` at `{}`, which marks the time before the drives, and after every condition but `{shared}`",
            Moment::Pre
        ),
        help: Some(format!(
            "write `{clear}` for what was asked after the condition `{shared}`"
        )),
    })
}

fn times_of(table: &Table) -> Result<Vec<SheetTime>, StudyError> {
    if !table.has("seconds") {
        return Ok(Vec::new());
    }
    let answers: Vec<Answer> = table.records()?;
    let mut sheets: BTreeMap<(ParticipantId, Moment, String), (f64, f64)> = BTreeMap::new();
    for (row, (answer, seconds)) in answers
        .into_iter()
        .zip(table.numbers("seconds")?)
        .enumerate()
    {
        let Some(seconds) = seconds else { continue };
        if seconds < 0.0 {
            let expected = "a time in s, not negative";
            return Err(table.bad_cell(row, "seconds", seconds.to_string(), expected));
        }
        let sheet = (answer.participant, answer.moment, answer.scale);
        let (sum, n) = sheets.entry(sheet).or_default();
        (*sum, *n) = (*sum + seconds, *n + 1.0);
    }
    let mean = |((participant, moment, scale), (sum, n))| SheetTime {
        participant,
        moment,
        scale,
        seconds_an_item: sum / n,
    };
    Ok(sheets.into_iter().map(mean).collect())
}

/// Reads scores.
///
/// # Errors
/// As [`Table`] does, naming row and column.
pub fn read_scores(path: &Path) -> Result<Vec<Score>, StudyError> {
    let table = Table::read(path)?;
    table.each_once(&["participant", "moment", "scale", "subscale"])?;
    table.records()
}
