//! Workbooks (`.xlsx`): the rows of one sheet as words.

use crate::error::StudyError;
use calamine::{Data, DataRef, Reader as _, Xlsx, XlsxError};
use std::{collections::BTreeMap, io::Cursor, path::Path};

/// Most cells of a sheet, from its first corner to its last: a stray cell at the far end of a sheet is not filled up to.
const MOST_CELLS: usize = 20_000_000;

/// What stands for a formula of which the workbook has no value: programs that write workbooks work out none, spreadsheets do.
pub(super) const FORMULA: &str = "=formula";

/// What is said of a formula where an answer is looked for.
pub(super) fn in_place_of_value(formula: &str) -> String {
    format!(
        "found a formula (`{formula}`) in the place of its value; open the table in a spreadsheet and save it, which works the value out"
    )
}

type Book = Xlsx<Cursor<Vec<u8>>>;
type Rows = Vec<Vec<String>>;

/// Whether a file begins as a workbook does, which is a ZIP archive.
pub(super) fn is_workbook(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

/// The rows of the sheet of this name, or of the only one that is not empty.
///
/// # Errors
/// [`StudyError::BadFile`] for an archive that is no workbook, a sheet that is not there, or several where none is named.
pub(super) fn rows(path: &Path, bytes: Vec<u8>, named: Option<&str>) -> Result<Rows, StudyError> {
    let wrong = |problem: String, help: String| StudyError::file(path, problem).with_help(help);
    let no_workbook = |problem: String| {
        let help = "save the sheet again as .xlsx, or as CSV in UTF-8";
        wrong(format!("is no workbook (.xlsx) that can be read: {problem}"), help.to_owned())
    };
    let mut book: Book = Xlsx::new(Cursor::new(bytes)).map_err(|e| no_workbook(e.to_string()))?;
    let names = book.sheet_names();
    let there = format!("its sheets are {}", names.join(", "));
    let name_it = || format!("name one, by `sheet` in the map of columns or by --sheet: {there}");
    if let Some(missing) = named.filter(|named| !names.iter().any(|name| name == named)) {
        return Err(wrong(format!("has no sheet `{missing}`; {there}"), name_it()));
    }
    let mut filled = Vec::new();
    for name in names.iter().filter(|name| named.is_none_or(|named| *name == named)) {
        let rows = sheet(&mut book, name).map_err(&no_workbook)?;
        if !rows.is_empty() || named.is_some() {
            filled.push(rows);
        }
    }
    match filled.len() {
        0 | 1 => Ok(filled.pop().unwrap_or_default()),
        n => Err(wrong(
            format!(
                "has {n} sheets with something in them, and nothing says which holds the answers"
            ),
            name_it(),
        )),
    }
}

/// The rows of a sheet, of which those without a cell are left out.
fn sheet(book: &mut Book, name: &str) -> Result<Rows, String> {
    let text = |e: XlsxError| e.to_string();
    let mut rows: BTreeMap<u32, Vec<(usize, String)>> = BTreeMap::new();
    let mut width = 0;
    let mut cells = book.worksheet_cells_reader(name).map_err(text)?;
    while let Some(cell) = cells.next_cell_with_formula_metadata().map_err(text)? {
        let (row, column) = cell.pos;
        let word = match (cell.value, cell.formula) {
            (DataRef::Empty, Some(_)) => FORMULA.to_owned(),
            (value, _) => Data::from(value).to_string(),
        };
        if !word.trim().is_empty() {
            width = width.max(column as usize + 1);
            rows.entry(row).or_default().push((column as usize, word));
        }
    }
    if rows.len().saturating_mul(width) > MOST_CELLS {
        return Err(format!(
            "sheet `{name}` goes on to column {width} in {} rows, more than {MOST_CELLS} cells",
            rows.len()
        ));
    }
    let filled_up = |cells: Vec<(usize, String)>| {
        let mut row = vec![String::new(); width];
        for (column, word) in cells {
            row[column] = word;
        }
        row
    };
    Ok(rows.into_values().map(filled_up).collect())
}
