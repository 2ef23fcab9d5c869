//! The table that is scored: which answers are in it.

use super::sheets::Row;
use crate::{error::StudyError, gate::Gate, tables::surveys::write_answers_with};
use maveric_analysis::{Why, exclusions::unknown_ride};
use maveric_domain::{Answer, ConditionId, Design, Moment, ParticipantId, Scale};
use std::{collections::BTreeMap, path::Path};

/// Takes out the answers about conditions that the design does not have.
pub(super) fn unknown_moments(rows: &mut Vec<Row>, design: &Design) -> Vec<Row> {
    let is_unknown = |row: &Row| row.moment.condition().is_some_and(|id| !design.knows(id));
    let (unknown, known) = std::mem::take(rows).into_iter().partition(is_unknown);
    *rows = known;
    unknown
}

/// How many answers there are about each condition that the design does not have, and where the first stands.
pub(super) fn told_unknown(unknown: &[Row], design: &Design) -> Vec<String> {
    let mut moments: BTreeMap<Moment, (usize, &str)> = BTreeMap::new();
    for row in unknown {
        moments.entry(row.moment).or_insert((0, row.place.as_str())).0 += 1;
    }
    let known = ConditionId::listed(&design.labels());
    let warning = |(moment, (n, place)): (Moment, (usize, &str))| {
        format!(
            "{n} answers left out: condition `{moment}` (first in {place}) is none of the design's: {known}"
        )
    };
    moments.into_iter().map(warning).collect()
}

/// Whose answers, and when → why each is left out.
pub(super) type LeftOutAnswers = BTreeMap<(ParticipantId, Moment), Vec<Why>>;

/// Takes out the answers of whoever the design leaves out by name, or who is nobody of its people; with them those about conditions that the
/// design does not have, which were taken out before.
pub(super) fn let_in(
    rows: &mut Vec<Row>,
    unknown: &[Row],
    design: &Design,
    gate: Option<&Gate>,
) -> LeftOutAnswers {
    let mut left_out = LeftOutAnswers::new();
    let mut keeps = |row: &Row| {
        let by_gate = gate.and_then(|gate| gate.answer(&row.participant, row.moment));
        let of_unknown = || unknown_condition(design, row.moment);
        let Some(why) = by_gate.or_else(of_unknown) else {
            return true;
        };
        let sheet = (row.participant.clone(), row.moment);
        left_out.entry(sheet).or_default().push(why);
        false
    };
    rows.retain(&mut keeps);
    for row in unknown {
        keeps(row);
    }
    left_out
}

/// Why an answer about a condition that the design does not have is left out; none of any other.
fn unknown_condition(design: &Design, moment: Moment) -> Option<Why> {
    let ride = moment.ride().filter(|ride| !design.knows(ride.condition))?;
    unknown_ride(design, ride)
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
            let help = if row.moment == Moment::Pre {
                "keep one; where one was answered after a drive, say so: by a column `condition` beside it, or by `{condition}` in the map of columns, where the condition stands in `column`"
            } else {
                "keep one; a condition can be rated once"
            };
            return Err(StudyError::file(file, problem).with_help(help));
        }
    }
    Ok(())
}

/// Writes the answers, with `seconds` and `text` where rows have them.
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
        (answer, (r.seconds.map(|seconds| ("seconds", seconds)), words))
    });
    write_answers_with(path, &answers.collect::<Vec<_>>(), &[])
}
