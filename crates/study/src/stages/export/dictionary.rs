//! What the columns of the tables mean that are given away: a table itself.

use super::place::files;
use crate::{
    error::StudyError,
    tables::{Table, TableName, dictionary::entry_at, write_rows},
};
use maveric_analysis::Observed;
use maveric_measures::objective;
use std::path::Path;

const DICTIONARY: &str = "dictionary.csv";

/// Writes it beside the files of the folder; what the columns of outcomes hold, `observed` says.
pub(super) fn write(folder: &Path, observed: &[Observed]) -> Result<(), StudyError> {
    let given = files(folder)?;
    let mut rows = Vec::new();
    for file in &given {
        let Some(entry) = entry_at(file).filter(|entry| entry.name.is_some()) else {
            continue;
        };
        for column in Table::read(&folder.join(file))?.columns() {
            let known = entry.column(&column);
            let outcome = file
                .starts_with("outcomes_")
                .then(|| outcome(&column, observed));
            rows.extend(known.map(|known| {
                let made_in = known.made_in.as_ref().or(entry.made_in.as_ref());
                let outcome = outcome.flatten();
                let unit = outcome
                    .as_ref()
                    .map_or(known.unit.clone(), |(unit, _)| unit.clone());
                let means = outcome.map_or(known.means.clone(), |(_, means)| means);
                let place = (("file", file), ("column", column));
                (
                    place,
                    ("unit", unit),
                    ("means", means),
                    ("made_in", made_in),
                )
            }));
        }
    }
    write_rows(TableName::Dictionary, &folder.join(DICTIONARY), rows)
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
