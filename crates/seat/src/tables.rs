//! Answers and people as tables that `maveric run` reads; what others wrote into them stays.

use crate::{error::SeatError, person::Person, sheet::Sheet, steps::Step};
use maveric_domain::Design;
use maveric_study::tables::{Table, TableBuilder};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// A person and what they answered: step and body of each sheet.
pub(crate) type Given = (Person, Vec<(usize, String)>);

/// Cells of a row, by column.
type Row = BTreeMap<String, String>;

/// What a table of answers has.
const ANSWERS: [&str; 6] = [
    "participant",
    "moment",
    "scale",
    "item",
    "answer",
    "seconds",
];

/// The people who stand in a table, if there is one.
pub(crate) fn people_in(path: &Path) -> Result<BTreeSet<String>, SeatError> {
    if !path.is_file() {
        return Ok(BTreeSet::new());
    }
    let ids = Table::read(path)?.text("participant")?;
    Ok(ids.into_iter().flatten().collect())
}

/// Writes the answers of everybody who wants them kept in place of what stood there of them.
pub(crate) fn write_answers(path: &Path, given: &[Given]) -> Result<(), SeatError> {
    let ours: BTreeSet<&str> = given.iter().map(|(p, _)| p.participant.as_str()).collect();
    let mut rows = Vec::new();
    for (person, answers) in given.iter().filter(|(p, _)| p.kept()) {
        for (step, body) in answers {
            let Some(Step::Scale { scale, moment, .. }) = person.steps.get(*step) else {
                continue;
            };
            // Only what was checked was kept.
            let Ok(sheet) = serde_json::from_str::<Sheet>(body) else {
                continue;
            };
            let each_s = sheet.seconds / sheet.answers.len().max(1) as f64;
            for (item, answer) in (1..).zip(&sheet.answers) {
                let cells = [
                    person.participant.clone(),
                    moment.clone(),
                    scale.clone(),
                    i32::to_string(&item),
                    answer.map_or_else(String::new, |a| a.to_string()),
                    format!("{each_s:.3}"),
                ];
                rows.push(ANSWERS.map(str::to_owned).into_iter().zip(cells).collect());
            }
        }
    }
    merge(path, &ANSWERS, |id| !ours.contains(id), &rows)
}

/// Adds to the table of people who is not in it yet, and takes out who wants nothing kept.
pub(crate) fn write_people(path: &Path, design: &Design, given: &[Given]) -> Result<(), SeatError> {
    let known = people_in(path)?;
    let gone: BTreeSet<&str> = given
        .iter()
        .filter(|(p, _)| !p.kept())
        .map(|(p, _)| p.participant.as_str())
        .collect();
    let mut columns = vec!["participant"];
    for column in design
        .people()
        .columns()
        .into_iter()
        .chain(["order"])
        .chain(design.tested_columns())
    {
        if !columns.contains(&column) {
            columns.push(column);
        }
    }
    let new = given
        .iter()
        .filter(|(p, _)| p.kept() && !known.contains(&p.participant));
    let rows: Vec<Row> = new.map(|(person, _)| row(design, person)).collect();
    merge(path, &columns, |id| !gone.contains(id), &rows)
}

fn row(design: &Design, person: &Person) -> Row {
    let rides = person.rides();
    let people = design.people();
    let wanted = if rides.is_empty() {
        &people.learn
    } else {
        &people.test
    };
    let mut row: Row = wanted.clone().unwrap_or_default();
    row.insert("participant".to_owned(), person.participant.clone());
    row.insert("order".to_owned(), rides.join(" "));
    row
}

/// Writes a table: of what stands there the rows whose participant `keep` keeps, with every column they have, then `added`.
fn merge(
    path: &Path,
    wanted: &[&str],
    keep: impl Fn(&str) -> bool,
    added: &[Row],
) -> Result<(), SeatError> {
    let standing = path.is_file().then(|| Table::read(path)).transpose()?;
    let mut columns = standing.as_ref().map_or_else(Vec::new, Table::columns);
    for column in wanted {
        if !columns.iter().any(|c| c == column) {
            columns.push((*column).to_owned());
        }
    }
    let kept: Vec<bool> = match &standing {
        Some(table) => {
            let ids = table.text("participant")?;
            ids.iter()
                .map(|id| keep(id.as_deref().unwrap_or_default()))
                .collect()
        }
        None => Vec::new(),
    };
    let mut table = TableBuilder::default();
    for column in &columns {
        let before = match &standing {
            Some(there) if there.has(column) => there.text(column)?,
            _ => vec![None; kept.len()],
        };
        let before = before.into_iter().zip(&kept).filter(|(_, keep)| **keep);
        let new = added
            .iter()
            .map(|row| row.get(column).filter(|c| !c.is_empty()).cloned());
        table = table.cells(column, before.map(|(cell, _)| cell).chain(new));
    }
    Ok(table.write(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_others_and_their_columns_stay_and_those_of_who_left_go() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("people.csv");
        let text = "participant,age,note\nX1,31,\"a, b\"\nP001,40,\nP002,50,z\n";
        std::fs::write(&path, text).unwrap();
        let new = Row::from([
            ("participant".to_owned(), "P003".to_owned()),
            ("order".to_owned(), "calm sporty".to_owned()),
        ]);
        let keep = |id: &str| id != "P001";
        merge(&path, &["participant", "order"], keep, &[new]).unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "participant,age,note,order\nX1,31,\"a, b\",\nP002,50,z,\nP003,,,calm sporty\n"
        );
        assert_eq!(people_in(&path).unwrap().len(), 3);
    }
}
