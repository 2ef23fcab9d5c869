//! Answers and people as tables that `maveric run` reads; what others wrote into them stays.

use crate::{
    error::SeatError,
    listed::{KeptSheet, Listed},
    person::Person,
    sheet::Sheet,
    steps::Step,
};
use maveric_domain::{Design, Moment, Occasion, occasion::OCCASION};
use maveric_study::tables::{
    Table, TableBuilder, TableName,
    surveys::{moment_word, moments},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// A person and what they answered.
pub(crate) type Given = (Person, Vec<KeptSheet>);

/// What stands in the study's tables once they were written.
#[derive(Debug, Default)]
pub(crate) struct Standing {
    people: BTreeMap<String, Listed>,
    sheets: BTreeMap<(String, usize), Listed>,
}

impl Standing {
    pub(crate) fn person(&self, person: &Person) -> Listed {
        let now = self.people.get(&person.participant);
        now.copied().unwrap_or(person.listed)
    }

    pub(crate) fn sheet(&self, person: &Person, sheet: &KeptSheet) -> Listed {
        let now = self.sheets.get(&(person.participant.clone(), sheet.step));
        now.copied().unwrap_or(sheet.listed)
    }
}

/// What becomes of a row that was `before`, in a table in which it stands or not; whether it is to be written.
fn listed(before: Listed, stands: bool, table: bool) -> (Listed, bool) {
    match before {
        _ if stands => (Listed::Written, false),
        Listed::NotYet => (Listed::Written, true),
        // A table that is not there at all is made anew.
        Listed::Written if !table => (Listed::Written, true),
        Listed::Written | Listed::TakenOut => (Listed::TakenOut, false),
    }
}

/// Participant, moment and scale of a sheet.
type SheetPlace = (String, String, String);

/// Cells of a row, by column.
type Row = BTreeMap<String, String>;

/// The people who stand in a table, if there is one.
pub(crate) fn people_in(path: &Path) -> Result<BTreeSet<String>, SeatError> {
    if !path.is_file() {
        return Ok(BTreeSet::new());
    }
    let ids = Table::read(path)?.text("participant")?;
    Ok(ids.into_iter().flatten().collect())
}

/// Adds to the table of answers each sheet that is not in it yet; what stands there stays as it is, and what was taken out stays out.
pub(crate) fn write_answers(
    path: &Path,
    given: &[Given],
    standing: &mut Standing,
) -> Result<(), SeatError> {
    let there = sheets_in(path)?;
    let mut rows = Vec::new();
    for (person, sheets) in given {
        if standing.person(person) == Listed::TakenOut {
            continue;
        }
        for kept in sheets {
            let questionnaire = person.steps.get(kept.step).and_then(scale_and_moment);
            let Some(((scale, moment), sheet)) = questionnaire.zip(kept.sheet()) else {
                continue;
            };
            let who = &person.participant;
            let place = (who.clone(), moment.to_string(), scale.to_owned());
            let stands = there.as_ref().is_some_and(|t| t.contains(&place));
            let (now, written) = listed(kept.listed, stands, there.is_some());
            standing.sheets.insert((who.clone(), kept.step), now);
            if written {
                rows.extend(rows_of((who, moment, scale), &sheet));
            }
        }
    }
    // Beside its condition a moment stands where a word alone would not do.
    let steps = given.iter().flat_map(|(person, _)| &person.steps);
    let moments: Vec<Moment> =
        steps.filter_map(scale_and_moment).map(|(_, moment)| moment).collect();
    let beside = moments.iter().any(|moment| matches!(moment, Moment::Probe(_) | Moment::Post));
    let beside = beside || path.is_file() && Table::read(path)?.has(CONDITION);
    let repeats = moments
        .iter()
        .filter_map(|moment| moment.ride())
        .any(|ride| ride.occasion != Occasion::FIRST);
    let once = |column: &&str| repeats || !OCCASION.contains(column);
    let alone = |column: &&str| once(column) && (beside || ![CONDITION, AT_S].contains(column));
    let columns = TableName::Answers.entry().columns.iter();
    let written = rows.iter().any(|row: &Row| row.contains_key("text"));
    let columns = columns.map(|column| column.name.as_str()).filter(alone);
    let columns: Vec<&str> = columns.filter(|c| written || *c != "text").collect();
    for row in &mut rows {
        row.retain(|column, _| columns.contains(&column.as_str()));
        if beside && let Some(moment) = row.get_mut("moment") {
            *moment = moment.parse().map_or(moment.clone(), |m| moment_word(m).to_owned());
        }
    }
    merge(path, &columns, (&rows, &[]))
}

/// Columns that tables of before have not.
const CONDITION: &str = "condition";
const AT_S: &str = "at_s";

/// What a step asks, and when: a questionnaire, or the probe of a ride.
fn scale_and_moment(step: &Step) -> Option<(&str, Moment)> {
    match step {
        Step::Scale { scale, moment, .. } => Some((scale, *moment)),
        Step::Ride { probe: Some(probe), .. } => {
            let (ride, _) = step.drives()?;
            Some((&probe.scale, Moment::probe(ride)))
        }
        _ => None,
    }
}

/// Participant, moment and scale of every sheet in a table of answers; none where there is no table.
fn sheets_in(path: &Path) -> Result<Option<BTreeSet<SheetPlace>>, SeatError> {
    if !path.is_file() {
        return Ok(None);
    }
    let table = Table::read(path)?;
    let column = |name| table.text(name);
    let (who, scale) = (column("participant")?, column("scale")?);
    let moments = moments(&table)?;
    let rows = who.into_iter().zip(moments).zip(scale);
    let place = |((who, moment), scale): ((Option<String>, Moment), Option<String>)| {
        (who.unwrap_or_default(), moment.to_string(), scale.unwrap_or_default())
    };
    Ok(Some(rows.map(place).collect()))
}

fn rows_of((who, moment, scale): (&str, Moment, &str), sheet: &Sheet) -> Vec<Row> {
    let occasion = moment.ride().map_or(Occasion::FIRST, |ride| ride.occasion);
    let row = |item: usize, answer: Option<i32>, more: (&str, String)| {
        let cells = [
            ("participant", who.to_owned()),
            ("moment", moment.on(Occasion::FIRST).to_string()),
            ("session", occasion.session.to_string()),
            ("trial", occasion.trial.to_string()),
            (CONDITION, moment.condition().map_or_else(String::new, |c| c.to_string())),
            ("scale", scale.to_owned()),
            ("item", item.to_string()),
            ("answer", answer.map_or_else(String::new, |a| a.to_string())),
            more,
        ];
        let words = sheet.texts.get(&item).map(|words| ("text", words.clone()));
        let cells = cells.into_iter().chain(words);
        cells.map(|(column, cell)| (column.to_owned(), cell)).collect()
    };
    if let Moment::Probe(_) = moment {
        let probes = sheet.probes.iter();
        return probes.map(|(at_s, answer)| row(1, *answer, (AT_S, at_s.to_string()))).collect();
    }
    let each_s = sheet.seconds / sheet.answers.len().max(1) as f64;
    let answers = (1..).zip(&sheet.answers);
    answers.map(|(item, answer)| row(item, *answer, ("seconds", format!("{each_s:.3}")))).collect()
}

/// Adds to the table of people who is not in it yet, and takes out whoever is `without`; who was taken out by hand stays out.
pub(crate) fn write_people(
    path: &Path,
    design: &Design,
    (given, without, made): (&[Given], &[String], bool),
    standing: &mut Standing,
) -> Result<(), SeatError> {
    let known = people_in(path)?;
    let mut columns = vec!["participant"];
    columns.extend(design.people().columns());
    columns.push("order");
    columns.extend(design.tested_columns());
    let table = path.is_file() && !made;
    let mut rows: Vec<Row> = Vec::new();
    for (person, _) in given {
        let stands = known.contains(&person.participant);
        let (now, written) = listed(person.listed, stands, table);
        standing.people.insert(person.participant.clone(), now);
        if written {
            rows.push(row(design, person));
        }
    }
    merge(path, &columns, (&rows, without))
}

fn row(design: &Design, person: &Person) -> Row {
    let rides = person.rides();
    let people = design.people();
    let wanted = if rides.is_empty() { &people.learn } else { &people.test };
    let mut row: Row = wanted.clone().unwrap_or_default();
    row.insert("participant".to_owned(), person.participant.clone());
    row.insert("order".to_owned(), rides.join(" "));
    row
}

/// Writes a table: what stands there of all but those `without`, with every column that it has and those that are wanted, each once; then
/// `added`.
fn merge(
    path: &Path,
    wanted: &[&str],
    (added, without): (&[Row], &[String]),
) -> Result<(), SeatError> {
    let standing = path.is_file().then(|| Table::read(path)).transpose()?;
    let mut columns = standing.as_ref().map_or_else(Vec::new, Table::columns);
    for column in wanted {
        if !columns.iter().any(|c| c == column) {
            columns.push((*column).to_owned());
        }
    }
    let people = match &standing {
        Some(table) => table.text("participant")?,
        None => Vec::new(),
    };
    let goes = |who: &String| without.contains(who);
    let stays: Vec<bool> = people.iter().map(|who| !who.as_ref().is_some_and(goes)).collect();
    let mut table = TableBuilder::default();
    for column in &columns {
        let before = match &standing {
            Some(there) if there.has(column) => there.text(column)?,
            _ => vec![None; stays.len()],
        };
        let before = before.into_iter().zip(&stays);
        let before = before.filter(|(_, stays)| **stays).map(|(cell, _)| cell);
        let new = added.iter().map(|row| row.get(column).filter(|c| !c.is_empty()).cloned());
        table = table.cells(column, before.chain(new));
    }
    Ok(table.write(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_written_once_and_one_that_was_taken_out_stays_out() {
        use Listed::{NotYet, TakenOut, Written};
        for (before, stands, table, expected) in [
            (NotYet, false, true, (Written, true)),
            (NotYet, true, true, (Written, false)),
            (Written, true, true, (Written, false)),
            (Written, false, true, (TakenOut, false)),
            (Written, false, false, (Written, true)),
            (TakenOut, false, true, (TakenOut, false)),
            (TakenOut, false, false, (TakenOut, false)),
            // Written back by hand.
            (TakenOut, true, true, (Written, false)),
        ] {
            assert_eq!(listed(before, stands, table), expected, "{before:?} {stands} {table}");
        }
    }

    #[test]
    fn what_was_written_stands_in_a_column_of_its_own_beside_the_item_that_asks_for_it() {
        let body = r#"{"answers":[4,null],"texts":{"2":"cars, or trust"},"seconds":6}"#;
        let sheet: Sheet = serde_json::from_str(body).unwrap();
        let rows = rows_of(("P001", Moment::Pre, "purpose"), &sheet);
        let cell = |row: usize, column: &str| rows[row].get(column).map(String::as_str);
        assert_eq!((cell(0, "answer"), cell(0, "text")), (Some("4"), None));
        let second = (cell(1, "answer"), cell(1, "text"));
        assert_eq!(second, (Some(""), Some("cars, or trust")));
    }

    #[test]
    fn rows_of_others_and_their_columns_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("people.csv");
        let text = "participant,age,note\nX1,31,\"a, b\"\nP002,50,z\n";
        std::fs::write(&path, text).unwrap();
        let new = Row::from([
            ("participant".to_owned(), "P003".to_owned()),
            ("order".to_owned(), "calm sporty".to_owned()),
        ]);
        let wanted = ["participant", "order"];
        merge(&path, &wanted, (&[new], &[])).unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "participant,age,note,order\nX1,31,\"a, b\",\nP002,50,z,\nP003,,,calm sporty\n"
        );
        assert_eq!(people_in(&path).unwrap().len(), 3);
        merge(&path, &wanted, (&[], &["P002".to_owned()])).unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "participant,age,note,order\nX1,31,\"a, b\",\nP003,,,calm sporty\n"
        );
    }
}
