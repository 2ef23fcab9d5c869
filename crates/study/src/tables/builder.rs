//! Tables being made, column by column.

use super::{Table, is_formula, is_parquet, is_tsv};
use crate::{atomic_write::atomic_write_bytes, error::StudyError};
use polars::prelude::*;
use std::path::{Path, PathBuf};

/// A table being made, column by column.
#[derive(Debug, Default)]
pub struct TableBuilder {
    columns: Vec<Column>,
}

impl TableBuilder {
    /// Adds a column of text.
    #[must_use]
    pub fn text<S: AsRef<str>>(mut self, name: &str, cells: impl IntoIterator<Item = S>) -> Self {
        let cells: Vec<String> = cells.into_iter().map(|c| c.as_ref().to_owned()).collect();
        self.columns.push(Column::new(name.into(), cells));
        self
    }

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

    /// Adds a column of yes and no.
    #[must_use]
    pub fn flags(mut self, name: &str, cells: impl IntoIterator<Item = bool>) -> Self {
        let cells: Vec<bool> = cells.into_iter().collect();
        self.columns.push(Column::new(name.into(), cells));
        self
    }

    /// Adds the columns of another table behind these.
    #[must_use]
    pub fn beside(mut self, other: Self) -> Self {
        self.columns.extend(other.columns);
        self
    }

    /// Puts the columns of another table before the one at `at`, in place of those here that have their names.
    #[must_use]
    pub(crate) fn with(mut self, at: usize, other: Self) -> Self {
        let replaced = |column: &Column| other.columns.iter().any(|o| o.name() == column.name());
        self.columns.retain(|column| !replaced(column));
        self.columns.splice(at..at, other.columns);
        self
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
        Ok(Table {
            path,
            frame,
            decimal_comma: false,
            origin: None,
        })
    }

    /// Writes CSV, TSV or Parquet by the file's name, whole or not at all. In CSV and TSV a text that a spreadsheet would run as
    /// a formula begins with `'`, which reading takes off again.
    ///
    /// # Errors
    /// [`StudyError::Io`], [`StudyError::BadTable`].
    pub fn write(self, path: &Path) -> Result<(), StudyError> {
        self.write_with(path, Vec::new())
    }

    /// As [`TableBuilder::write`], with named texts in the file's own metadata (Parquet only).
    pub(crate) fn write_with(
        self,
        path: &Path,
        metadata: Vec<(String, String)>,
    ) -> Result<(), StudyError> {
        let bad = |problem: String| StudyError::BadTable {
            path: path.to_owned(),
            format: if is_parquet(path) { "Parquet" } else { "CSV" },
            problem,
        };
        let height = self.columns.first().map_or(0, Column::len);
        let frame = DataFrame::new(height, self.columns);
        let mut frame = frame.map_err(|e| bad(e.to_string()))?;
        if is_parquet(path) {
            let bytes = maveric_ingest::parquet_bytes(&mut frame, metadata).map_err(bad)?;
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
                    Some(if is_formula(cell?) {
                        format!("'{}", cell?)
                    } else {
                        cell?.to_owned()
                    })
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
