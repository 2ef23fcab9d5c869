//! The table that is scored: which answers are in it.

use super::sheets::Row;
use crate::{
    error::StudyError,
    gate::Gate,
    tables::{TableName, write_rows},
};
use maveric_analysis::Why;
use maveric_domain::{Answer, Design, Moment, ParticipantId, Scale};
use std::{collections::BTreeMap, path::Path};

/// Takes out the answers about conditions that the design does not have: how many of each, and where the first stands.
pub(super) fn unknown_moments(
    rows: &mut Vec<Row>,
    design: &Design,
) -> BTreeMap<Moment, (usize, String)> {
    let mut unknown: BTreeMap<Moment, (usize, String)> = BTreeMap::new();
    let labels = design.labels();
    rows.retain(|row| match row.moment {
        Moment::After(ride) | Moment::Probe(ride) if !labels.contains(&ride.condition) => {
            let first = || (0, row.place.clone());
            unknown.entry(row.moment).or_insert_with(first).0 += 1;
            false
        }
        _ => true,
    });
    unknown
}

/// Whose answers, and when → why each is left out.
pub(super) type LeftOutAnswers = BTreeMap<(ParticipantId, Moment), Vec<Why>>;

/// Takes out the answers of whoever the design leaves out by name, or who is nobody of its people.
pub(super) fn let_in(rows: &mut Vec<Row>, gate: Option<&Gate>) -> LeftOutAnswers {
    let mut left_out = LeftOutAnswers::new();
    let Some(gate) = gate else {
        return left_out;
    };
    rows.retain(|row| match gate.answer(&row.participant, row.moment) {
        None => true,
        Some(why) => {
            let sheet = (row.participant.clone(), row.moment);
            left_out.entry(sheet).or_default().push(why);
            false
        }
    });
    left_out
}

/// Refuses a sheet that is there twice: one row of a person too many, or a condition rated twice.
pub(super) fn refuse_twice(file: &Path, rows: &[Row], scales: &[Scale]) -> Result<(), StudyError> {
    let mut seen: BTreeMap<(&ParticipantId, Moment, usize, u32), &Row> = BTreeMap::new();
    for row in rows {
        let key = (&row.participant, row.moment, row.scale, row.item);
        if let Some(before) = seen.insert(key, row) {
            let scale = &scales[row.scale].id;
            let problem = format!(
                "participant {} ({}), scale `{scale}`, item {}: answered twice, in {} and in {}",
                row.participant, row.moment, row.item, before.place, row.place
            );
            let help = "keep one; a condition can be rated once";
            return Err(StudyError::file(file, problem).with_help(help));
        }
    }
    Ok(())
}

pub(super) fn write(path: &Path, rows: &[Row], scales: &[Scale]) -> Result<(), StudyError> {
    let answers = rows.iter().map(|r| {
        let answer = Answer {
            participant: r.participant.clone(),
            moment: r.moment,
            scale: scales[r.scale].id.clone(),
            item: r.item,
            answer: r.answer,
        };
        let words = r.words.as_ref().map(|words| ("text", words));
        (answer, r.seconds.map(|seconds| ("seconds", seconds)), words)
    });
    write_rows(TableName::Answers, path, answers)
}
