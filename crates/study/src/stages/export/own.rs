//! The study's own measures as they were brought, under pseudonyms.

use super::pseudonym::Pseudonyms;
use crate::{
    design::DesignFile,
    error::StudyError,
    tables::{Table, TableName, own_measures::known_conditions, write_rows},
};
use maveric_domain::{ConditionId, ParticipantId, occasion::OCCASION};
use serde_json::Value;
use std::{collections::BTreeSet, path::Path};

pub(super) struct OwnRow {
    pub(super) participant: ParticipantId,
    pub(super) condition: ConditionId,
    /// Session and trial, then the measures.
    cells: Vec<(String, Value)>,
}

pub(super) fn read(path: &Path, study: &DesignFile) -> Result<Vec<OwnRow>, StudyError> {
    let table = Table::read(path)?;
    let people: Vec<ParticipantId> = table.ids("participant")?;
    let conditions = known_conditions(study, &table)?;
    let mut columns: Vec<(String, Vec<Value>)> = Vec::new();
    for name in OCCASION.into_iter().filter(|c| table.has(c)) {
        columns.push((name.to_owned(), numbered(&table.text(name)?)));
    }
    for measure in study.design.measures() {
        let values = table.numbers(&measure.id)?;
        let values = values.into_iter().map(Value::from);
        columns.push((measure.id.clone(), values.collect()));
    }
    let row = |(index, (participant, condition)): (usize, (ParticipantId, ConditionId))| OwnRow {
        participant,
        condition,
        cells: (columns.iter()).map(|(name, cells)| (name.clone(), cells[index].clone())).collect(),
    };
    let whose = people.into_iter().zip(conditions);
    Ok(whose.enumerate().map(row).collect())
}

/// Sessions and trials by number: as they were where they are numbers, else in the order of their words, which may be dates.
fn numbered(cells: &[Option<String>]) -> Vec<Value> {
    let number = |cell: &Option<String>| cell.as_ref().map(|c| c.trim().parse::<u32>());
    let numbers: Vec<_> = cells.iter().map(number).collect();
    if numbers.iter().flatten().all(Result::is_ok) {
        let values = numbers.into_iter().map(|n| n.and_then(Result::ok));
        return values.map(Value::from).collect();
    }
    let words: BTreeSet<&String> = cells.iter().flatten().collect();
    let place = |cell: &String| words.iter().position(|w| *w == cell).map(|index| index + 1);
    let places = cells.iter().map(|cell| cell.as_ref().and_then(place));
    places.map(Value::from).collect()
}

/// Writes `measures.csv`, sorted by pseudonym and condition; each person's rows stay in their order.
pub(super) fn write(out: &Path, rows: &[OwnRow], names: &Pseudonyms) -> Result<(), StudyError> {
    if rows.is_empty() {
        return Ok(());
    }
    let given = rows.iter().map(|row| (names.pseudonym(&row.participant), row));
    let mut given: Vec<(ParticipantId, &OwnRow)> = given.collect();
    given.sort_by(|a, b| (&a.0, a.1.condition).cmp(&(&b.0, b.1.condition)));
    let given = given.into_iter().map(|(name, row)| {
        let condition = row.condition.to_string();
        (("participant", name), ("condition", condition), &row.cells)
    });
    write_rows(TableName::Measures, &out.join("measures.csv"), given)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_sessions_stay_and_days_become_numbers() {
        let cells = |words: [&str; 3]| words.map(|w| Some(w.to_owned())).to_vec();
        assert_eq!(numbered(&cells(["2", "1", "10"])), [2, 1, 10]);
        let days = ["2026-11-03", "2026-11-01", "2026-11-03"];
        assert_eq!(numbered(&cells(days)), [2, 1, 2]);
        assert_eq!(numbered(&[None]), [Value::Null]);
    }
}
