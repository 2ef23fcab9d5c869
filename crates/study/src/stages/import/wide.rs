//! Tables with a row a participant: oTree, Qualtrics, `LimeSurvey`, `SoSci` Survey, and any other.

use super::{
    columns::Columns,
    formats::Format,
    grid::Grid,
    heads::pages,
    map_file::MapFile,
    sheets::{Contents, Orders, Page, Reading},
};
use crate::{
    error::StudyError,
    once::{count, names},
};
use std::collections::BTreeMap;

/// Reads a table of words.
///
/// # Errors
/// [`StudyError`] naming file, row and column: items without a column, conditions that no column has, what says the same twice, an id, a
/// moment or an answer that is none.
pub(super) fn read(
    grid: &Grid,
    format: &Format,
    columns: &Columns<'_>,
    orders: &Orders,
) -> Result<Contents, StudyError> {
    let mut contents = Contents::default();
    contents.warnings.clone_from(&grid.warnings);
    contents.warnings.extend(grid.ending_early());
    let pages = pages(grid, format, columns, &mut contents)?;
    let people = people_column(grid, format, &columns.map)?;
    let reading = Reading { path: grid.path(), columns, orders, missing: format.missing };
    let [trials, doubtful] = [format.trials, format.doubtful].map(|marked| {
        let (name, words, _) = marked?;
        Some((grid.position(name)?, words))
    });
    let is_marked = |marked: Option<(usize, &[&str])>, row: usize| {
        marked.is_some_and(|(column, words)| words.contains(&grid.cell(column, row)))
    };
    let mut trial_rows = 0;
    let mut doubtful_rows = Vec::new();
    let mut unknown_marks: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for row in 0..grid.rows() {
        if is_marked(trials, row) {
            trial_rows += 1;
            continue;
        }
        if is_marked(doubtful, row) {
            doubtful_rows.push(format!("row {}", row + 1));
        }
        let place = format!("row {}", row + 1);
        let participant = people.map_or("", |column| grid.cell(column, row));
        let before = contents.rows.len();
        for page in pages.values() {
            let name = |column: usize| grid.columns[column].as_str();
            let moment = page.moment.map(|column| (name(column), grid.cell(column, row).into()));
            let fields = page.items.iter();
            let fields = fields.map(|h| (h.slot, name(h.column), grid.cell(h.column, row).into()));
            let page = Page {
                place: place.clone(),
                participant: participant.into(),
                moment,
                fields: fields.collect(),
                shown: false,
                from_zero: false,
                seconds: None,
            };
            let mut words = page.fields.iter().map(|(_, _, text)| text);
            if participant.is_empty() && words.any(|text| !text.is_empty()) {
                return Err(of_nobody(grid, format, people, &place));
            }
            contents.rows.extend(reading.rows_of(&page)?);
        }
        let mark = trials.filter(|_| contents.rows.len() > before);
        if let Some((column, _)) = mark {
            let word = grid.cell(column, row);
            if !format.real.contains(&word) && !is_marked(doubtful, row) {
                unknown_marks.entry(word).or_default().push(place.clone());
            }
        }
        if contents.rows.len() == before && !pages.is_empty() {
            contents
                .warnings
                .push(format!("{place} (participant `{participant}`) has no answers: left out"));
        }
    }
    if let Some((name, _, what)) = format.trials.filter(|_| !unknown_marks.is_empty()) {
        let mark = |(word, rows): (&str, &Vec<String>)| {
            let word = if word.is_empty() { "empty".to_owned() } else { format!("`{word}`") };
            format!("{word} ({})", names(rows))
        };
        let marks: Vec<String> =
            unknown_marks.iter().map(|(word, rows)| mark((word, rows))).collect();
        contents.warnings.push(format!(
            "unknown `{name}`: {}; read like the others: take the rows of {what} out of the export, or save it in English",
            marks.join(", ")
        ));
    }
    if let Some((name, _, what)) = format.doubtful.filter(|_| !doubtful_rows.is_empty()) {
        let rows = count(doubtful_rows.len(), "row", "rows");
        contents.warnings.push(format!(
            "{rows} of {what} by `{name}` ({}): read like the others",
            names(&doubtful_rows)
        ));
    }
    if let Some((_, _, what)) = format.trials.filter(|_| trial_rows > 0) {
        let rows = count(trial_rows, "row", "rows");
        contents.warnings.push(format!("{rows} of {what}: left out"));
    }
    Ok(contents)
}

/// Answers in a row that nothing says whose it is.
fn of_nobody(grid: &Grid, format: &Format, people: Option<usize>, place: &str) -> StudyError {
    let problem = match people {
        Some(column) => format!(
            "{place}: column `{}`, which says whose row it is, is empty",
            grid.columns[column]
        ),
        None => format!(
            "{place}: no column that says whose row it is has anything in it: {}",
            format.participant.join(", ")
        ),
    };
    let help = "write the person's id there, or take the row out; `participant` in the map of columns names another column";
    StudyError::file(grid.path(), problem).with_help(help)
}

/// The column that says whose each row is: the map's, else the first of the software's that anybody filled in.
///
/// # Errors
/// [`StudyError::NoColumn`] where the map's, or every one of them, is missing.
pub(super) fn people_column(
    grid: &Grid,
    format: &Format,
    map: &MapFile,
) -> Result<Option<usize>, StudyError> {
    let missing = |wanted: &str| StudyError::no_column(grid.path(), wanted, grid.columns.clone());
    if let Some(named) = &map.participant {
        let column = format.position(grid, named);
        return column.map(Some).ok_or_else(|| missing(named));
    }
    let there = || format.participant.iter().filter_map(|name| format.position(grid, name));
    let filled = there().find(|column| grid.filled(*column).next().is_some());
    match (filled, format.participant) {
        (None, [first, ..]) if there().next().is_none() => Err(missing(first)),
        (column, _) => Ok(column),
    }
}
