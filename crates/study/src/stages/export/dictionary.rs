//! What the columns of the tables mean that are given away: a table itself.

use super::place::files;
use crate::{
    error::StudyError,
    tables::{
        Table, TableName,
        dictionary::{ColumnEntry, FileEntry, entry_at},
        write_rows,
    },
};
use maveric_analysis::Observed;
use maveric_domain::Design;
use maveric_measures::objective;
use serde::Serialize;
use std::path::Path;

const DICTIONARY: &str = "dictionary.csv";

/// A column of a table: a row of the dictionary.
#[derive(Serialize)]
struct Row {
    file: String,
    column: String,
    unit: Option<String>,
    means: String,
    made_in: Option<String>,
}

/// Writes it beside the files of the folder; what the columns of outcomes hold, `observed` says, what those of own measures, the design.
pub(super) fn write(
    folder: &Path,
    observed: &[Observed],
    design: &Design,
) -> Result<(), StudyError> {
    let given = files(folder)?;
    let mut rows = Vec::new();
    for file in &given {
        let Some(entry) = entry_at(file).filter(|entry| entry.name.is_some()) else {
            continue;
        };
        for column in Table::read(&folder.join(file))?.columns() {
            let of_study = match entry.name {
                Some(TableName::OutcomesLong | TableName::OutcomesWide) => {
                    outcome(&column, observed)
                }
                Some(TableName::Measures) => own_measure(&column, design),
                _ => None,
            };
            let known = entry.column(&column);
            rows.extend(known.map(|known| row(file, column, (entry, known), of_study)));
        }
    }
    // It is written when everything else is there.
    let list = TableName::Files.entry();
    for known in &list.columns {
        let column = known.name.clone();
        rows.extend(list.files.iter().map(|file| row(file, column.clone(), (list, known), None)));
    }
    write_rows(TableName::Dictionary, &folder.join(DICTIONARY), rows)
}

/// What is said of a column of a table; unit and meaning are the study's own where it has some.
fn row(
    file: &str,
    column: String,
    (entry, known): (&FileEntry, &ColumnEntry),
    of_study: Option<(Option<String>, String)>,
) -> Row {
    let general = || (known.unit.clone(), known.means.clone());
    let (unit, means) = of_study.unwrap_or_else(general);
    let made_in = known.made_in.as_ref().or(entry.made_in.as_ref());
    Row { file: file.to_owned(), column, unit, means, made_in: made_in.cloned() }
}

/// Unit, if it has one, and title of a measure of the study's own.
fn own_measure(column: &str, design: &Design) -> Option<(Option<String>, String)> {
    let measure = design.measure(column)?;
    let unit = Some(measure.shown_unit().to_owned()).filter(|unit| !unit.is_empty());
    Some((unit, measure.title.clone()))
}

/// Unit, if it has one, and meaning of a column `OUTCOME` or `OUTCOME.CONDITION`.
fn outcome(column: &str, observed: &[Observed]) -> Option<(Option<String>, String)> {
    observed.iter().find_map(|seen| {
        let rest = column.strip_prefix(seen.outcome.as_str())?;
        let mut conditions = seen.conditions.iter().map(|(id, _)| id.to_string());
        let condition = rest.strip_prefix('.');
        let known = rest.is_empty() || condition.is_some_and(|c| conditions.any(|id| id == c));
        let measure = objective::find(&seen.outcome);
        let unit = measure.map_or(seen.unit.as_str(), |m| m.unit).to_owned();
        let unit = Some(unit).filter(|unit| !unit.is_empty() && unit != "1");
        let within = condition.map_or_else(String::new, |c| format!(", in `{c}`"));
        known.then(|| (unit, format!("{}{within}", seen.title)))
    })
}
