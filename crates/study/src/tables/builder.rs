//! Tables being made column by column: of columns that others have chosen, and of the rows of our own.

use super::table::{Table, is_formula, is_parquet, is_tsv};
use crate::{atomic_write::atomic_write_bytes, error::StudyError};
use path_slash::PathExt as _;
use polars::prelude::*;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A table being made, column by column.
#[derive(Debug, Default)]
pub struct TableBuilder {
    columns: Vec<Column>,
}

impl TableBuilder {
    /// Adds a column of text, some of it missing.
    #[must_use]
    pub fn cells(mut self, name: &str, cells: impl IntoIterator<Item = Option<String>>) -> Self {
        let cells: Vec<Option<String>> = cells.into_iter().collect();
        self.columns.push(Column::new(name.into(), cells));
        self
    }

    /// Adds a column of numbers, some of them missing.
    #[must_use]
    pub fn numbers(mut self, name: &str, cells: impl IntoIterator<Item = Option<f64>>) -> Self {
        let cells: Vec<Option<f64>> = cells.into_iter().collect();
        self.columns.push(Column::new(name.into(), cells));
        self
    }

    /// Adds a column of whole numbers, some of them missing.
    #[must_use]
    pub fn integers(mut self, name: &str, cells: impl IntoIterator<Item = Option<i64>>) -> Self {
        let cells: Vec<Option<i64>> = cells.into_iter().collect();
        self.columns.push(Column::new(name.into(), cells));
        self
    }

    /// Adds a column of yes and no, some of it missing.
    fn flags(mut self, name: &str, cells: impl IntoIterator<Item = Option<bool>>) -> Self {
        let cells: Vec<Option<bool>> = cells.into_iter().collect();
        self.columns.push(Column::new(name.into(), cells));
        self
    }

    /// Adds a column of what its first cell that is not missing is; without any, of numbers.
    #[must_use]
    pub(super) fn values(self, name: &str, cells: &[Value]) -> Self {
        match cells.iter().find(|cell| !cell.is_null()) {
            Some(Value::String(_)) => {
                let text = |cell: &Value| cell.as_str().map(str::to_owned);
                self.cells(name, cells.iter().map(text))
            }
            Some(Value::Bool(_)) => self.flags(name, cells.iter().map(Value::as_bool)),
            Some(Value::Number(n)) if !n.is_f64() => {
                self.integers(name, cells.iter().map(Value::as_i64))
            }
            _ => self.numbers(name, cells.iter().map(Value::as_f64)),
        }
    }

    /// The table, under a name for messages.
    ///
    /// # Errors
    /// [`StudyError::BadTable`] if the columns differ in length or two have one name.
    pub fn table(self, name: &str) -> Result<Table, StudyError> {
        let path = PathBuf::from(name);
        let height = self.columns.first().map_or(0, Column::len);
        let frame = DataFrame::new(height, self.columns).map_err(|e| StudyError::BadTable {
            path: path.clone(),
            format: "data frame",
            problem: e.to_string(),
        })?;
        Ok(Table { path, frame, decimal_comma: false, origin: None, stacked: None })
    }

    /// Writes CSV, TSV or Parquet by the file's name, whole or not at all. In CSV and TSV a text that a spreadsheet would run as
    /// a formula begins with `'`, which reading takes off again.
    pub fn write(self, path: &Path) -> Result<(), StudyError> {
        let mut frame = self.table(&path.to_slash_lossy())?.frame;
        let bad = |problem: String| StudyError::BadTable {
            path: path.to_owned(),
            format: if is_parquet(path) { "Parquet" } else { "CSV" },
            problem,
        };
        if is_parquet(path) {
            let bytes = maveric_ingest::parquet_bytes(&mut frame, Vec::new()).map_err(bad)?;
            return atomic_write_bytes(path, &bytes);
        }
        for name in frame.get_column_names_owned() {
            let column = frame.column(&name).map_err(|e| bad(e.to_string()))?;
            let Ok(texts) = column.str() else { continue };
            if !texts.iter().flatten().any(is_formula) {
                continue;
            }
            let plain: Vec<Option<String>> = texts
                .iter()
                .map(|cell| {
                    Some(if is_formula(cell?) { format!("'{}", cell?) } else { cell?.to_owned() })
                })
                .collect();
            let plain = Column::new(name, plain);
            frame.with_column(plain).map_err(|e| bad(e.to_string()))?;
        }
        // In memory first: what is wrong with a disk is told by whoever writes to it.
        let mut bytes = Vec::new();
        CsvWriter::new(&mut bytes)
            .with_separator(if is_tsv(path) { b'\t' } else { b',' })
            .finish(&mut frame)
            .map_err(|e| bad(e.to_string()))?;
        atomic_write_bytes(path, &bytes)
    }
}

impl From<DataFrame> for TableBuilder {
    fn from(frame: DataFrame) -> Self {
        Self { columns: frame.into_columns() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_is_no_formula_in_a_spreadsheet_and_comes_back_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let cells = ["=cmd()", "+1+1", "@x", "-a", "-2", "plain", "'quoted"];
        TableBuilder::default()
            .cells("a", cells.map(|cell| Some(cell.to_owned())))
            .write(&path)
            .unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text, "a\n'=cmd()\n'+1+1\n'@x\n'-a\n-2\nplain\n'quoted\n");
        let back = Table::read(&path).unwrap().text("a").unwrap();
        assert_eq!(back.iter().flatten().collect::<Vec<_>>(), cells.iter().collect::<Vec<_>>());
    }
}
