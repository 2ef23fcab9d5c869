//! Opens a table, CSV or Parquet, and gives its columns as numbers and words.

use super::{
    cells::{NUMBER, number, trimmed, word},
    ending_early::ending_early,
    ids::numbered,
    parse::{BYTE_ORDER_MARK, parse, without_mark},
    text::{
        Header, MOST_COLUMNS, SEPARATORS, Style, blanks_to_tabs, header, same_name, short_rows,
    },
};
use crate::{error::IngestError, foreign::foreign_text, parquet, quality::Warning};
use maveric_domain::nearest;
use path_slash::PathExt as _;
use polars::prelude::{Column, DataFrame, DataType, PolarsError};
use std::{
    ops::Range,
    path::{Path, PathBuf},
};

/// Whether the name of a column is one of several that other characters separate in that of another.
fn stands_in(other: &str, name: &str) -> bool {
    let separates = |c: char| u8::try_from(c).is_ok_and(|c| SEPARATORS.contains(&c));
    let name = name.trim_end_matches('?');
    let mut parts = other.split(separates);
    other.contains(separates) && parts.any(|part| same_name(part, name))
}

/// What a column is read as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Number,
    Word,
}

/// A table of which some columns were read.
#[derive(Debug)]
pub(crate) struct Table {
    path: PathBuf,
    /// All names of the header, as the file has them.
    names: Vec<String>,
    frame: DataFrame,
    decimal_comma: bool,
    /// The files that follow, where a recording was split, each with the row at which it begins.
    parts: Vec<(usize, PathBuf)>,
    /// What is to be told of its rows.
    warnings: Vec<Warning>,
}

impl Table {
    /// Reads a table that stands in several files, one below the other, as [`Table::open`] reads one.
    ///
    /// # Errors
    /// As [`Table::open`]; [`IngestError::BadTable`] for a part that lacks a column of the first, or has one that the first lacks.
    pub(crate) fn open_all(
        files: Vec<(PathBuf, Vec<u8>)>,
        style: Style,
        wanted: &[(&str, Kind)],
    ) -> Result<Self, IngestError> {
        let mut tables = Vec::with_capacity(files.len());
        for (path, bytes) in files {
            tables.push(Self::open(&path, bytes, style, wanted)?);
        }
        let mut tables = tables.into_iter();
        let Some(mut first) = tables.next() else {
            return Err(IngestError::bad_table(Path::new(""), "no file was given"));
        };
        for part in tables {
            first.append(&part)?;
        }
        Ok(first)
    }

    /// Puts the rows of another part below those that are there.
    fn append(&mut self, part: &Self) -> Result<(), IngestError> {
        let names = self.frame.get_column_names_owned();
        let has_all = names.iter().all(|name| part.has(name));
        if !has_all || part.frame.width() != names.len() {
            let theirs = part.frame.get_column_names_owned().join(", ");
            return Err(part.bad(format!(
                "of the columns that the mapping names it has {theirs}, but {} has {}: parts of one recording are expected to have \
                 the same",
                self.path.to_slash_lossy(),
                names.join(", ")
            )));
        }
        let mut columns = Vec::with_capacity(names.len());
        for name in &names {
            let unreadable = |e: PolarsError| part.unreadable(name, &e);
            let (mut above, mut below) = (self.column(name)?.clone(), part.column(name)?.clone());
            let kinds = [above.dtype(), below.dtype()];
            if kinds.contains(&&DataType::Float64) && kinds.contains(&&DataType::String) {
                // A cell of one of them is no number as others are: it is named, or read as the table's cells are.
                above = Column::new(name.clone(), self.numbers(name)?);
                below = Column::new(name.clone(), part.numbers(name)?);
            } else if kinds[0] != kinds[1] {
                above = above.cast(&DataType::String).map_err(unreadable)?;
                below = below.cast(&DataType::String).map_err(unreadable)?;
            }
            above.append(&below).map_err(unreadable)?;
            columns.push(above);
        }
        self.parts.push((self.rows(), part.path.clone()));
        self.warnings.extend_from_slice(&part.warnings);
        let rows = self.rows() + part.rows();
        self.frame =
            DataFrame::new(rows, columns).map_err(|e| part.bad(parquet::first_line(&e)))?;
        Ok(())
    }

    /// Whether it stands in several files.
    pub(crate) fn is_split(&self) -> bool {
        !self.parts.is_empty()
    }

    /// The rows of each file, in their order.
    pub(crate) fn parts(&self) -> impl Iterator<Item = (&Path, Range<usize>)> {
        let begins =
            [(0, &self.path)].into_iter().chain(self.parts.iter().map(|(row, path)| (*row, path)));
        let ends = self.parts.iter().map(|p| p.0).chain([self.rows()]);
        begins.zip(ends).map(|((begin, path), end)| (path.as_path(), begin..end))
    }

    /// Reads `wanted` columns; the first of them marks the line of the header.
    ///
    /// A name that ends in `?` may be missing. Numbers are parsed by polars; only if a cell is no number
    /// are the columns read as text, so that the error can name the row.
    ///
    /// # Errors
    /// [`IngestError::BadTable`], [`IngestError::UnknownColumn`].
    pub(crate) fn open(
        path: &Path,
        bytes: Vec<u8>,
        style: Style,
        wanted: &[(&str, Kind)],
    ) -> Result<Self, IngestError> {
        let mut named = wanted.iter().map(|(name, _)| name.trim_end_matches('?'));
        let anchor = named.find(|name| !name.is_empty());
        let mut table = Self {
            path: path.to_owned(),
            names: Vec::new(),
            frame: DataFrame::default(),
            decimal_comma: style.decimal_comma,
            parts: Vec::new(),
            warnings: Vec::new(),
        };
        if parquet::is_parquet(&bytes) {
            table.read_parquet(bytes, wanted)?;
        } else {
            let mut bytes = without_mark(bytes);
            let mut style = style;
            if style.is_blank() {
                bytes = blanks_to_tabs(&bytes);
                style.separator = Some(b'\t');
            }
            if memchr::memchr(b'\n', &bytes).is_none()
                && let Some((found, advice)) = foreign_text(&bytes)
            {
                return Err(table.bad(format!("{found}: {advice}")));
            }
            let header = header(&bytes, style, anchor);
            if header.names.len() > MOST_COLUMNS {
                return Err(table.bad(format!("it has more than {MOST_COLUMNS} columns")));
            }
            table.names.clone_from(&header.names);
            table.read_text(&bytes, &header, wanted, style)?;
        }
        if table.frame.height() == 0 {
            let what =
                if style.headless { "it has no rows" } else { "it has a header and no rows" };
            return Err(table.bad(what));
        }
        Ok(table)
    }

    /// Names of the columns below the header with `anchor`.
    ///
    /// # Errors
    /// [`IngestError::BadTable`].
    pub(crate) fn names(
        path: &Path,
        bytes: &[u8],
        style: Style,
        anchor: &str,
    ) -> Result<Vec<String>, IngestError> {
        if parquet::is_parquet(bytes) {
            let columns = Self::parquet_columns(path, bytes)?.into_iter();
            return Ok(columns.map(|(name, _)| name).collect());
        }
        let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
        Ok(header(text, style, Some(anchor)).names)
    }

    /// The columns of Parquet, and the type of each that cannot be read.
    ///
    /// # Errors
    /// [`IngestError::BadTable`].
    pub(crate) fn parquet_columns(
        path: &Path,
        bytes: &[u8],
    ) -> Result<Vec<(String, Option<String>)>, IngestError> {
        parquet::parquet_columns(bytes).map_err(|why| IngestError::bad_table(path, why))
    }

    fn read_text(
        &mut self,
        bytes: &[u8],
        header: &Header,
        wanted: &[(&str, Kind)],
        style: Style,
    ) -> Result<(), IngestError> {
        let columns = self.wanted(wanted)?;
        let doubled = columns.iter().find_map(|(name, _)| {
            let mut same = (1..).zip(&self.names).filter(|(_, n)| *n == name);
            Some((name, same.next()?.0, same.next()?.0))
        });
        if let (Some((name, first, second)), false) = (doubled, style.doubled_names) {
            return Err(self.bad(format!(
                "its header has the column `{name}` twice: columns {first} and {second}"
            )));
        }
        let short = short_rows(bytes, header)
            .map_err(|flaw| self.bad(flaw.sentence(header.names.len())))?;
        let names: Vec<&str> = columns.iter().map(|c| c.0.as_str()).collect();
        let read = |numbers: bool| {
            let kind = |name: &str| match columns.iter().find(|(c, _)| c == name) {
                Some((_, Kind::Number)) if numbers => DataType::Float64,
                _ => DataType::String,
            };
            parse(bytes, header, kind, Some(&names), self.decimal_comma)
        };
        // A point beside decimal commas would be read as one of them: then cells are read one by one.
        let points = self.decimal_comma && {
            let rows = bytes.split_inclusive(|&b| b == b'\n');
            let head: usize = rows.take(header.preamble + 1).map(<[u8]>::len).sum();
            memchr::memchr(b'.', &bytes[head..]).is_some()
        };
        let numbers = if points { None } else { read(true).ok() };
        self.frame = match numbers {
            Some(frame) => frame,
            None => read(false).map_err(|e| {
                self.bad(match foreign_text(bytes) {
                    Some((found, advice)) => format!("{found}: {advice}"),
                    None => parquet::first_line(&e),
                })
            })?,
        };
        let places =
            columns.iter().filter_map(|(name, _)| header.names.iter().position(|n| n == name));
        let (rows, needed) = (self.rows(), places.max().map_or(0, |last| last + 1));
        let (warnings, is_cut) = ending_early(&self.path, &short, rows, header.names.len(), needed);
        self.warnings = warnings;
        if is_cut {
            self.frame = self.frame.head(Some(rows - 1));
        }
        Ok(())
    }

    /// What is to be told of its rows: those that end early.
    pub(crate) fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    fn read_parquet(&mut self, bytes: Vec<u8>, wanted: &[(&str, Kind)]) -> Result<(), IngestError> {
        let file_columns = Self::parquet_columns(&self.path, &bytes)?;
        self.names = file_columns.iter().map(|(name, _)| name.clone()).collect();
        let columns: Vec<String> = self.wanted(wanted)?.into_iter().map(|c| c.0).collect();
        let mut unreadable = file_columns.iter().filter(|(name, _)| columns.contains(name));
        if let Some((name, Some(kind))) = unreadable.find(|(_, kind)| kind.is_some()) {
            return Err(self.bad(format!(
                "column `{name}` is of type {kind}: expected numbers, words or times"
            )));
        }
        let file = parquet::read_parquet(bytes, Some(&columns));
        self.frame = file.map_err(|why| self.bad(why))?.frame;
        Ok(())
    }

    /// The columns that there are of those that are wanted, by the file's names and once each.
    fn wanted(&self, wanted: &[(&str, Kind)]) -> Result<Vec<(String, Kind)>, IngestError> {
        let mut columns: Vec<(String, Kind)> = Vec::new();
        for &(name, kind) in wanted {
            match self.find(name) {
                Some(actual) => {
                    if columns.iter().all(|(f, _)| f != actual) {
                        columns.push((actual.to_owned(), kind));
                    }
                }
                None if name.ends_with('?') => {}
                None => return Err(self.unknown(name)),
            }
        }
        Ok(columns)
    }

    /// The file's name of a column: the same, else the same but for capitals and blanks.
    fn find(&self, name: &str) -> Option<&str> {
        let name = name.trim_end_matches('?');
        let exact = self.names.iter().find(|n| *n == name);
        let similar = || self.names.iter().find(|n| same_name(n, name));
        exact.or_else(similar).map(String::as_str)
    }

    fn unknown(&self, name: &str) -> IngestError {
        let shown: Vec<&str> = self.names.iter().take(40).map(String::as_str).collect();
        let more = match self.names.len() - shown.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        IngestError::UnknownColumn {
            path: self.path.clone(),
            column: name.to_owned(),
            nearest: nearest(name, self.names.iter().map(String::as_str)).map(str::to_owned),
            found: shown.join(", ") + &more,
            unseparated: self.names.iter().any(|other| stands_in(other, name)),
        }
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.frame.height()
    }

    /// Whether the table has a column of this name, which may end in `?`.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.find(name).is_some()
    }

    fn column(&self, name: &str) -> Result<&Column, IngestError> {
        let actual = self.find(name).ok_or_else(|| self.unknown(name))?;
        self.frame.column(actual).map_err(|_| self.unknown(name))
    }

    /// A fault in a cell that should hold a number.
    pub(crate) fn bad_cell(&self, row: usize, name: &str, found: impl Into<String>) -> IngestError {
        self.bad_cell_of(row, name, found, NUMBER)
    }

    /// A fault in a cell; `row` counts from 0 here and from 1 in the message.
    pub(crate) fn bad_cell_of(
        &self,
        row: usize,
        name: &str,
        found: impl Into<String>,
        expected: &str,
    ) -> IngestError {
        let part = self.parts.iter().rfind(|(begin, _)| *begin <= row);
        let (begin, path) = part.map_or((0, &self.path), |(begin, path)| (*begin, path));
        IngestError::BadCell {
            path: path.clone(),
            row: row - begin + 1,
            column: name.trim_end_matches('?').to_owned(),
            // A cell may hold anything, and its message goes to a terminal.
            found: found.into().escape_debug().take(60).collect(),
            expected: expected.to_owned(),
        }
    }

    fn unreadable(&self, name: &str, error: &PolarsError) -> IngestError {
        self.bad(format!("column `{name}` is neither numbers nor text: {error}"))
    }

    fn bad(&self, reason: impl Into<String>) -> IngestError {
        IngestError::bad_table(&self.path, reason)
    }

    /// A column as numbers, shape `(rows,)`; NaN stands for an empty cell and never leaves this module's callers.
    ///
    /// # Errors
    /// [`IngestError::BadCell`] for what is neither a finite number nor empty.
    pub(crate) fn numbers(&self, name: &str) -> Result<Vec<f64>, IngestError> {
        self.numbers_of(name, NUMBER)
    }

    /// The same of numbers that are `expected` to be something.
    pub(crate) fn numbers_of(&self, name: &str, expected: &str) -> Result<Vec<f64>, IngestError> {
        let mut column = self.column(name)?;
        let words;
        if column.dtype().is_categorical() {
            words = column.cast(&DataType::String);
            column = words.as_ref().map_err(|e| self.unreadable(name, e))?;
        }
        if let Ok(texts) = column.str() {
            let number = |(row, cell): (usize, Option<&str>)| {
                let cell = trimmed(cell);
                number(cell, self.decimal_comma)
                    .map_err(|why| self.bad_cell_of(row, name, cell, why.unwrap_or(expected)))
            };
            return texts.iter().enumerate().map(number).collect();
        }
        let kind = column.dtype();
        if !kind.is_primitive_numeric() && !kind.is_decimal() {
            return Err(self.bad(format!(
                "column `{name}` holds {}: expected {expected}{}",
                match kind {
                    DataType::Boolean => "yes and no (bool)".to_owned(),
                    kind => format!("times ({kind})"),
                },
                match kind {
                    DataType::Datetime(..) =>
                        "; as the time it is read with `time = \"iso8601\"` in `[table.units]`",
                    _ => "",
                }
            )));
        }
        let numbers = column.cast(&DataType::Float64).map_err(|e| self.unreadable(name, &e))?;
        let numbers = numbers.f64().map_err(|e| self.unreadable(name, &e))?;
        let mut out = Vec::with_capacity(numbers.len());
        if numbers.null_count() == 0 {
            for piece in numbers.downcast_iter() {
                out.extend_from_slice(piece.values());
            }
        } else {
            out.extend(numbers.iter().map(|cell| cell.unwrap_or(f64::NAN)));
        }
        match out.iter().position(|v| v.is_infinite()) {
            Some(row) => Err(self.bad_cell_of(row, name, out[row].to_string(), expected)),
            None => Ok(out),
        }
    }

    /// A column that a mapping may name as numbers times a unit, shape `(rows,)`; none where the table has no such column.
    pub(crate) fn scaled(
        &self,
        name: Option<&String>,
        unit: f64,
    ) -> Result<Option<Vec<f64>>, IngestError> {
        let there = name.filter(|name| self.has(name));
        there.map(|name| self.times(name, unit)).transpose()
    }

    /// A column as numbers times a unit, shape `(rows,)`.
    pub(crate) fn times(&self, name: &str, unit: f64) -> Result<Vec<f64>, IngestError> {
        let numbers = self.numbers(name)?.into_iter();
        Ok(numbers.map(|v| v * unit).collect())
    }

    /// A column as words, shape `(rows,)`.
    ///
    /// # Errors
    /// [`IngestError::BadTable`] for a column that has no words.
    pub(crate) fn words(&self, name: &str) -> Result<Vec<Option<String>>, IngestError> {
        let column = self.column(name)?;
        let unreadable = |e: PolarsError| self.unreadable(name, &e);
        let texts = match column.dtype() {
            // An instant, whatever zone it is shown in: told in UTC, as which times without a zone are read.
            DataType::Datetime(unit, Some(_)) => column
                .cast(&DataType::Datetime(*unit, None))
                .and_then(|utc| utc.cast(&DataType::String)),
            _ => column.cast(&DataType::String),
        };
        let texts = texts.map_err(unreadable)?;
        let texts = texts.str().map_err(unreadable)?;
        Ok(texts.iter().map(|cell| word(trimmed(cell))).collect())
    }

    /// A column of names as numbers of a sorted list of names; an empty cell is none.
    pub(crate) fn codes(&self, name: &str) -> Result<(Vec<Option<u32>>, Vec<String>), IngestError> {
        let words = self.words(name)?;
        let codes = numbered(words.iter().flatten().map(String::as_str));
        let code_of = |w: &Option<String>| w.as_deref().map(|w| codes[w]);
        let list = codes.keys().map(|w| (*w).to_owned()).collect();
        Ok((words.iter().map(code_of).collect(), list))
    }
}

#[cfg(test)]
mod tests;
