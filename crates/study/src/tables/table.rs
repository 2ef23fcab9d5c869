//! A table in memory, with errors that name the row.

use super::keys::{differing_in_case, key};
use crate::error::StudyError;
use polars::prelude::*;
use std::{
    borrow::Cow,
    io::Read as _,
    path::{Path, PathBuf},
};

/// A table in memory, with the path it came from for its error messages.
#[derive(Debug, Clone)]
pub struct Table {
    pub(super) path: PathBuf,
    pub(super) frame: DataFrame,
    /// Whether numbers have a comma before their decimals.
    pub(super) decimal_comma: bool,
    /// Which rows of the file its rows were, where these are not all of them in order.
    pub(super) origin: Option<Vec<usize>>,
    /// Which columns of the file were put under each other, if any.
    pub(super) stacked: Option<Stacked>,
}

/// A column that several of the file were put into: row after row of the file, its cells in the order of the columns.
#[derive(Debug, Clone)]
pub(super) struct Stacked {
    /// The column that they became.
    pub(super) value: String,
    /// Their names in the file.
    pub(super) columns: Vec<String>,
}

pub(super) fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("parquet"))
}

pub(super) fn is_tsv(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("tsv"))
}

/// Whether a spreadsheet takes a cell for a formula; a number is none.
pub(super) fn is_formula(cell: &str) -> bool {
    cell.starts_with(['=', '+', '-', '@', '\t', '\r']) && cell.parse::<f64>().is_err()
}

/// The text of a cell behind the `'` that keeps it from being a formula.
fn without_guard(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|rest| is_formula(rest)).unwrap_or(cell)
}

/// The table with names of columns that are keys, as far as these stay different.
fn with_keys(mut frame: DataFrame) -> DataFrame {
    let names: Vec<String> = frame.get_column_names().iter().map(ToString::to_string).collect();
    for name in &names {
        let new = key(name);
        if new != *name && !names.iter().any(|other| *other == new) {
            // A name that is there and another that is not: it cannot fail.
            let _ = frame.rename(name, new.into_owned().into());
        }
    }
    frame
}

impl Table {
    /// Reads CSV, TSV or Parquet; `-` is standard input, as CSV.
    ///
    /// # Errors
    /// [`StudyError::Io`], [`StudyError::BadFile`] for a folder or an empty file, [`StudyError::BadTable`].
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        if path.is_dir() {
            let problem = "is a folder, expected a CSV or Parquet file";
            return Err(StudyError::file(path, problem));
        }
        let mut bytes = Vec::new();
        if path == Path::new("-") {
            std::io::stdin().lock().read_to_end(&mut bytes).map_err(StudyError::read(path))?;
        } else {
            bytes = std::fs::read(path).map_err(StudyError::read(path))?;
        }
        Self::parse(path, bytes)
    }

    pub(super) fn parse(path: &Path, bytes: Vec<u8>) -> Result<Self, StudyError> {
        if bytes.iter().all(u8::is_ascii_whitespace) {
            let problem = "is empty, expected a table with a header line";
            return Err(StudyError::file(path, problem));
        }
        let bad = |format, problem| StudyError::BadTable { path: path.to_owned(), format, problem };
        let (frame, decimal_comma) = if maveric_ingest::is_parquet(&bytes) {
            let file = maveric_ingest::read_parquet(bytes, None);
            (file.map_err(|e| bad("Parquet", e))?.frame, false)
        } else if is_parquet(path) {
            return Err(StudyError::file(path, "does not start like Parquet (PAR1)"));
        } else {
            let separator = is_tsv(path).then_some(b'\t');
            let csv = maveric_ingest::read_csv(&bytes, separator).map_err(|e| bad("CSV", e))?;
            (csv.frame, csv.decimal_comma)
        };
        let frame = with_keys(frame);
        Ok(Self { path: path.to_owned(), frame, decimal_comma, origin: None, stacked: None })
    }

    pub fn rows(&self) -> usize {
        self.frame.height()
    }

    /// Names of the columns, in order.
    pub fn columns(&self) -> Vec<String> {
        self.frame.get_column_names().iter().map(ToString::to_string).collect()
    }

    /// Whether there is a column of this name.
    pub fn has(&self, column: &str) -> bool {
        self.frame.column(&key(column)).is_ok()
    }

    /// The row of the file, from 0, that a row of this table was.
    pub(super) fn origin(&self, row: usize) -> usize {
        self.origin.as_ref().and_then(|rows| rows.get(row)).copied().unwrap_or(row)
    }

    /// Where the table came from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Refuses cells of a column that differ only in capitals.
    ///
    /// # Errors
    /// [`StudyError::BadCell`] naming both.
    pub(crate) fn one_case(&self, column: &str) -> Result<(), StudyError> {
        let cells = self.text(column)?;
        let Some((first, second)) = differing_in_case(cells.iter().flatten().map(String::as_str))
        else {
            return Ok(());
        };
        let row = cells.iter().position(|cell| cell.as_deref() == Some(second)).unwrap_or(0);
        let expected =
            format!("one spelling of each: `{first}` and `{second}` differ only in capitals");
        Err(self.bad_cell(row, column, second, expected))
    }

    /// A column; of two of one name nobody knows which is meant.
    pub(super) fn column(&self, wanted: &str) -> Result<&Column, StudyError> {
        let wanted = &*key(wanted);
        let again = format!("{wanted} (column ");
        let columns = self.columns();
        if let Some(second) = columns.iter().find_map(|c| c.strip_prefix(&again)) {
            let first = columns.iter().position(|c| c == wanted).unwrap_or_default() + 1;
            let problem = format!(
                "has the column `{wanted}` twice: columns {first} and {}",
                second.trim_end_matches(')')
            );
            let help = "take one of them out, or give it another name";
            return Err(StudyError::file(&self.path, problem).with_help(help));
        }
        let column = self.frame.column(wanted);
        column.map_err(|_| StudyError::no_column(&self.path, wanted, columns))
    }

    /// A column as text, each cell a key (trimmed and composed); a missing cell is `None`.
    pub fn text(&self, column: &str) -> Result<Vec<Option<String>>, StudyError> {
        let series = self.column(column)?;
        let text = series.cast(&DataType::String).map_err(|e| self.bad_column(column, &e))?;
        let text = text.str().map_err(|e| self.bad_column(column, &e))?;
        Ok(text
            .iter()
            .map(|cell| cell.map(|text| key(without_guard(text))).filter(|text| !text.is_empty()))
            .map(|cell| cell.map(Cow::into_owned))
            .collect())
    }

    pub(super) fn bad_column(&self, column: &str, error: &PolarsError) -> StudyError {
        let problem = format!("column `{column}` cannot be read: {error}");
        StudyError::file(&self.path, problem)
    }

    /// A fault in a cell, by the row and the column of the file; `row` counts from 0 here and from 1 in the message.
    pub(crate) fn bad_cell(
        &self,
        row: usize,
        column: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> StudyError {
        let stacked = self.stacked.as_ref().filter(|s| s.value == column);
        let of_file = stacked.and_then(|s| s.columns.get(row % s.columns.len()));
        StudyError::BadCell {
            path: self.path.clone(),
            row: self.origin(row) + 1,
            column: of_file.map_or(column, String::as_str).to_owned(),
            found: found.into(),
            expected: expected.into(),
        }
    }

    /// A cell as a finite number; the error is what was expected.
    pub(super) fn number(&self, text: &str) -> Result<f64, &'static str> {
        maveric_ingest::parse_number(text.trim(), self.decimal_comma)
    }

    /// Whether a cell is a number, or refused as one since it has a point beside decimal commas.
    pub(crate) fn is_number(&self, text: &str) -> bool {
        self.number(text).is_ok() || maveric_ingest::parse_number(text.trim(), false).is_ok()
    }

    /// A column as finite numbers; a missing cell (empty, `NA`, `null`) is `None`.
    ///
    /// # Errors
    /// [`StudyError::NoColumn`]; [`StudyError::BadCell`] for text, NaN or an infinite value.
    pub fn numbers(&self, column: &str) -> Result<Vec<Option<f64>>, StudyError> {
        let series = self.column(column)?;
        if !series.dtype().is_primitive_numeric() {
            let cells = self.text(column)?;
            let number = |(row, cell): (usize, Option<String>)| match cell.as_deref().map(str::trim)
            {
                None | Some("" | "NA" | "null") => Ok(None),
                Some(text) => match self.number(text) {
                    Ok(value) => Ok(Some(value)),
                    Err(expected) => Err(self.bad_cell(row, column, text, expected)),
                },
            };
            return cells.into_iter().enumerate().map(number).collect();
        }
        let floats = series.cast(&DataType::Float64).map_err(|e| self.bad_column(column, &e))?;
        let floats = floats.f64().map_err(|e| self.bad_column(column, &e))?;
        let number = |(row, cell): (usize, Option<f64>)| match cell {
            Some(value) if !value.is_finite() => {
                Err(self.bad_cell(row, column, value.to_string(), "a finite number"))
            }
            other => Ok(other),
        };
        floats.iter().enumerate().map(number).collect()
    }

    /// As [`Table::numbers`]; where there is no such column, every cell is missing.
    pub(crate) fn numbers_if_there(&self, column: &str) -> Result<Vec<Option<f64>>, StudyError> {
        if self.has(column) { self.numbers(column) } else { Ok(vec![None; self.rows()]) }
    }

    /// A column in which every cell is a finite number.
    ///
    /// # Errors
    /// As [`Table::numbers`], and [`StudyError::BadCell`] for a missing cell.
    pub(crate) fn all_numbers(&self, column: &str) -> Result<Vec<f64>, StudyError> {
        let cells = self.numbers(column)?;
        let filled = |(row, cell): (usize, Option<f64>)| {
            cell.ok_or_else(|| self.bad_cell(row, column, "", "a number"))
        };
        cells.into_iter().enumerate().map(filled).collect()
    }

    /// A column in which every cell makes a `T`, such as a participant id.
    ///
    /// # Errors
    /// [`StudyError::NoColumn`]; [`StudyError::BadCell`] with what `T` says of the cell.
    pub fn ids<T: TryFrom<String>>(&self, column: &str) -> Result<Vec<T>, StudyError>
    where
        T::Error: std::fmt::Display,
    {
        let cells = self.text(column)?;
        let make = |(row, cell): (usize, Option<String>)| {
            let text = cell.unwrap_or_default();
            T::try_from(text.clone()).map_err(|e| self.bad_cell(row, column, &text, e.to_string()))
        };
        cells.into_iter().enumerate().map(make).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<Table, StudyError> {
        Table::parse(Path::new("t.csv"), text.as_bytes().to_vec())
    }

    fn table_of(text: &str) -> Table {
        table(text).unwrap()
    }

    #[test]
    fn a_bad_cell_is_named_by_row_and_column() {
        let error = table("a,b\n1,2\n3,x\n").unwrap().numbers("b").unwrap_err().to_string();
        assert_eq!(error, "t.csv: row 2, column `b`: found `x`, expected a finite number");
    }

    #[test]
    fn commas_semicolons_and_tabs_separate_cells_and_beside_semicolons_a_comma_is_decimal() {
        for text in [
            "a,b\n1.5,x\n2,y\n",
            "\u{feff}a;b\r\n1,5;x\r\n2;y\r\n",
            "a\tb\n1.5\tx\n2\ty\n",
            "\n\na;b\n1.5;x\n2;y\n",
            "\"a\",\"b\"\n\"1.5\",\"x\"\n2,y,\n",
        ] {
            let table = table(text).unwrap();
            assert_eq!(table.columns(), ["a", "b"], "{text}");
            assert_eq!(table.all_numbers("a").unwrap(), [1.5, 2.0], "{text}");
        }
        // A file's name says it, whatever the header has.
        let tsv = Table::parse(Path::new("t.tsv"), b"a, b\tc\n1\t2\n".to_vec()).unwrap();
        assert_eq!(tsv.columns(), ["a, b", "c"]);
        // A semicolon within a name, beside more commas, and a comma that separates nothing.
        assert_eq!(table_of("a;c,b,d\n1,2,3\n").columns(), ["a;c", "b", "d"]);
        let error = table_of("a,b\n\"1,5\",2\n").numbers("a").unwrap_err();
        assert!(error.to_string().contains("found `1,5`"), "{error}");
    }

    #[test]
    fn a_row_of_too_many_cells_and_an_open_quote_are_named_and_a_second_name_is_kept_apart() {
        let error = table("a,b\n1,2\n1,2,3\n").unwrap_err().to_string();
        assert!(error.contains("row 2 has 3 cells, expected 2"), "{error}");
        let error = table("a,b\n1,\"2\n3,4\n").unwrap_err().to_string();
        assert!(error.contains("row 1 opens a quote"), "{error}");
        let twice = table_of("a,b,a\n1,2,3\n");
        assert_eq!(twice.columns(), ["a", "b", "a (column 3)"]);
        assert_eq!(twice.all_numbers("b").unwrap(), [2.0]);
        let error = twice.all_numbers("a").unwrap_err().to_string();
        assert!(error.contains("`a` twice: columns 1 and 3"), "{error}");
    }

    #[test]
    fn what_is_no_text_in_utf_8_says_what_it_is_and_what_to_do() {
        for (bytes, what) in [
            (&b"a,b\n1,K\xf6ln\n"[..], "line 2 holds the byte f6"),
            (b"\xff\xfea\0,\0b\0", "UTF-16"),
            (b"a,b\r1,2\r", "carriage return alone"),
            (b"PK\x03\x04\x14\0", "spreadsheet"),
        ] {
            let error = Table::parse(Path::new("t.csv"), bytes.to_vec()).unwrap_err();
            let error = error.to_string();
            assert!(error.contains(what) && error.contains("CSV"), "{error}");
        }
    }

    #[test]
    fn infinities_are_refused_and_missing_cells_are_not() {
        assert!(table("a\ninf\n").unwrap().numbers("a").is_err());
        assert_eq!(
            table("a,b\n,1\nNA,2\n3,4\n").unwrap().numbers("a").unwrap(),
            [None, None, Some(3.0)]
        );
    }

    #[test]
    fn an_unknown_column_gets_the_nearest_name() {
        let error = table("subject,value\n1,2\n").unwrap().numbers("vlaue").unwrap_err();
        assert_eq!(error.suggestion().unwrap(), "did you mean `value`?");
    }

    #[test]
    fn an_empty_file_and_a_binary_one_say_so() {
        assert!(table(" \n").unwrap_err().to_string().contains("is empty"));
        let binary = table("a\u{0}b").unwrap_err().to_string();
        assert!(binary.contains("zero byte"), "{binary}");
    }
}
