//! An export as rows and columns of words, whatever file it comes in.

use super::{encoding::text_of, workbook};
use crate::{
    error::StudyError,
    once::names,
    tables::{
        Table,
        keys::{composed, key},
    },
};
use std::path::{Path, PathBuf};

#[derive(Debug, Clone)]
pub(super) struct Grid {
    path: PathBuf,
    /// Names of the columns; of two of one name the second has its number behind it: `q1 (column 7)`.
    pub(super) columns: Vec<String>,
    /// The cells of each column; an empty one is the empty text.
    cells: Vec<Vec<String>>,
    rows: usize,
    /// Rows, from 0, that end before the last column does, each with its number of cells.
    short: Vec<(usize, usize)>,
    /// What a reader of the export has to know of how it was read.
    pub(super) warnings: Vec<String>,
}

/// What a map says of the file itself.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct HowToRead<'a> {
    /// The sheet of a workbook.
    pub(super) sheet: Option<&'a str>,
    /// The encoding of a text.
    pub(super) encoding: Option<&'a str>,
}

impl Grid {
    /// Reads a workbook (`.xlsx`), a text with commas, semicolons or tabs between its cells, or Parquet.
    ///
    /// # Errors
    /// [`StudyError::BadFile`] for a sheet that is not there, an encoding that cannot be known, or what is no table.
    pub(super) fn read(path: &Path, how: HowToRead<'_>) -> Result<Self, StudyError> {
        let bytes = std::fs::read(path).map_err(StudyError::read(path))?;
        if workbook::is_workbook(&bytes) {
            let rows = workbook::rows(path, bytes, how.sheet)?;
            return Self::of_rows(path, rows);
        }
        if let Some(sheet) = how.sheet {
            let problem = format!("has no sheet `{sheet}`: it is no workbook (.xlsx)");
            return Err(StudyError::file(path, problem));
        }
        if maveric_ingest::is_parquet(&bytes) {
            return Self::of_table(&Table::read(path)?);
        }
        let (text, warning) = text_of(path, bytes, how.encoding)?;
        if text.trim_ascii().is_empty() {
            let problem = "is empty, expected a table with a header line";
            return Err(StudyError::file(path, problem));
        }
        let tabs = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("tsv"));
        let bad = |problem| StudyError::BadTable { path: path.to_owned(), format: "CSV", problem };
        let separator = tabs.then_some(b'\t');
        let frame = maveric_ingest::read_csv(&text, separator).map_err(bad)?.frame;
        let mut short = maveric_ingest::short_rows(&text, separator).map_err(bad)?;
        let mut cells: Vec<Vec<String>> = Vec::new();
        for column in frame.columns() {
            let column = column.str().map_err(|e| bad(e.to_string()))?;
            let text = |cell: Option<&str>| key(cell.unwrap_or_default()).into_owned();
            cells.push(column.iter().map(text).collect());
        }
        // LimeSurvey ends its text with an empty line.
        let is_filled = |row: &usize| cells.iter().any(|column| !column[*row].trim().is_empty());
        let rows = (0..frame.height()).rev().find(is_filled).map_or(0, |last| last + 1);
        for column in &mut cells {
            column.truncate(rows);
        }
        short.retain(|(row, _)| *row < rows);
        Ok(Self {
            path: path.to_owned(),
            columns: frame
                .get_column_names()
                .iter()
                .map(|name| composed(name).into_owned())
                .collect(),
            cells,
            rows,
            short,
            warnings: warning.into_iter().collect(),
        })
    }

    fn of_table(table: &Table) -> Result<Self, StudyError> {
        let mut cells = Vec::new();
        for name in table.columns() {
            let column = table.text(&name)?.into_iter();
            cells.push(column.map(Option::unwrap_or_default).collect());
        }
        Ok(Self {
            path: table.path().to_owned(),
            columns: table.columns(),
            cells,
            rows: table.rows(),
            short: Vec::new(),
            warnings: Vec::new(),
        })
    }

    /// A table of rows, the names of the columns the first of them.
    fn of_rows(path: &Path, rows: Vec<Vec<String>>) -> Result<Self, StudyError> {
        let mut rows = rows.into_iter().skip_while(|row| row.iter().all(|c| c.trim().is_empty()));
        let Some(head) = rows.next() else {
            let problem = "holds an empty sheet, expected a table with a header line";
            return Err(StudyError::file(path, problem));
        };
        let mut columns: Vec<String> = Vec::new();
        for (place, name) in head.into_iter().enumerate() {
            let numbered = name.trim().is_empty() || columns.contains(&name);
            let name = composed(&name).into_owned();
            let number = format!("{name} (column {})", place + 1);
            columns.push(if numbered { number } else { name });
        }
        let mut cells = vec![Vec::new(); columns.len()];
        let mut height = 0;
        for row in rows.filter(|row| row.iter().any(|c| !c.trim().is_empty())) {
            height += 1;
            let mut row = row.into_iter();
            for column in &mut cells {
                column.push(key(&row.next().unwrap_or_default()).into_owned());
            }
        }
        Ok(Self {
            path: path.to_owned(),
            columns,
            cells,
            rows: height,
            short: Vec::new(),
            warnings: Vec::new(),
        })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Number of rows below the names.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn without_first(mut self, rows: usize) -> Self {
        for column in &mut self.cells {
            column.drain(..rows);
        }
        self.rows -= rows;
        let below = |(row, cells): (usize, usize)| Some((row.checked_sub(rows)?, cells));
        self.short = self.short.into_iter().filter_map(below).collect();
        self
    }

    /// What a reader has to know of rows that end early; none where every row is whole.
    pub(super) fn ending_early(&self) -> Option<String> {
        let rows = self.short.iter();
        let rows = rows.map(|(row, cells)| format!("row {} after {cells}", row + 1));
        let rows: Vec<String> = rows.collect();
        let (n, they) = match rows.len() {
            0 => return None,
            1 => ("1 row ends".to_owned(), "it lacks"),
            n => (format!("{n} rows end"), "they lack"),
        };
        let (listed, width) = (names(&rows), self.columns.len());
        Some(format!("{n} early ({listed} of {width} cells): what {they} counts as not answered"))
    }

    /// Where a column of this name stands.
    pub(super) fn position(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// A cell without blanks around it.
    pub(super) fn cell(&self, column: usize, row: usize) -> &str {
        self.cells[column][row].trim()
    }

    /// The cells of a column, without blanks around them.
    pub(super) fn column(&self, column: usize) -> impl Iterator<Item = &str> {
        self.cells[column].iter().map(|cell| cell.trim())
    }

    /// The cells of a column that anybody filled in.
    pub(super) fn filled(&self, column: usize) -> impl Iterator<Item = &str> {
        self.column(column).filter(|cell| !cell.is_empty())
    }
}
