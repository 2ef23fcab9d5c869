//! The files of signals: the rows of each that count, in the order of time.

use super::super::{
    TableLog,
    open::{Kind, Table},
    parts::stamps,
    take,
    text::Style,
    time::Clock,
};
use crate::{
    error::IngestError,
    mapping::Only,
    quality::{Warning, WarningKind, report},
    source::Source,
};
use std::path::{Path, PathBuf};

/// Where the signals of a log are, and how they are written.
pub(super) struct Files<'a> {
    /// The folder, or the one table.
    pub(super) log: &'a Path,
    pub(super) clock: Clock<'a>,
    style: Style,
    /// The files of the one table, with their bytes.
    table: Vec<(PathBuf, Vec<u8>)>,
    sources: &'a mut Vec<Source>,
    /// What is to be told of the files that were opened, once each.
    pub(super) warnings: Vec<Warning>,
}

impl<'a> Files<'a> {
    /// The signals of a log; `table` holds the files of the one table, if they stand in one.
    pub(super) fn new(
        log: &TableLog<'a>,
        table: Vec<(PathBuf, Vec<u8>)>,
        sources: &'a mut Vec<Source>,
    ) -> Self {
        Self {
            log: log.path,
            clock: log.clock(),
            style: log.mapping.into(),
            table,
            sources,
            warnings: Vec::new(),
        }
    }

    /// The path of a signal's file; without a name it is the log itself.
    pub(super) fn path(&self, file: &str) -> PathBuf {
        if file.is_empty() {
            self.log.to_owned()
        } else {
            self.log.join(file)
        }
    }

    /// Opens the file of a signal.
    ///
    /// # Errors
    /// As [`Table::open_all`], and where there is no such file.
    pub(super) fn open(
        &mut self,
        file: &str,
        wanted: &[(&str, Kind)],
    ) -> Result<Table, IngestError> {
        let table = if file.is_empty() {
            Table::open_all(self.table.clone(), self.style, wanted)?
        } else {
            let path = self.path(file);
            let mut read = Vec::new();
            let bytes = take(&path, &mut read)?;
            read.retain(|source| !self.sources.contains(source));
            self.sources.append(&mut read);
            Table::open(&path, bytes, self.style, wanted)?
        };
        for warning in table.warnings() {
            if !self.warnings.contains(warning) {
                self.warnings.push(warning.clone());
            }
        }
        Ok(table)
    }

    /// Opens the file of a signal and finds its rows.
    ///
    /// # Errors
    /// As [`Files::open`]; [`IngestError::BadCell`] for a time before that of a row above, unless the row is one of those, written again.
    pub(super) fn rows(
        &mut self,
        file: &str,
        time: &str,
        columns: &[(&str, Kind)],
        only: Option<&Only>,
    ) -> Result<SignalRows, IngestError> {
        let mut wanted = vec![(time, self.clock.kind())];
        wanted.extend(columns.iter().copied());
        wanted.extend(only.map(|o| (o.column.as_str(), Kind::Word)));
        let table = self.open(file, &wanted)?;
        let mut last = i64::MIN;
        let counts = match only {
            None => vec![true; table.rows()],
            Some(only) => {
                let words = table.words(&only.column)?.into_iter();
                let is = |word: Option<String>| word.is_some_and(|w| only.is.contains(&w));
                words.map(is).collect()
            }
        };
        let (mut stamp_ns, mut rows) = (Vec::new(), Vec::new());
        let (mut without_time, mut repeated) = (0, 0);
        let mut earlier: Vec<(i64, usize)> = Vec::new();
        // Those of the columns as they are written, where they are asked for.
        let mut cells: Option<Vec<Vec<Option<String>>>> = None;
        for (row, stamp) in stamps(&table, time, self.clock)?.into_iter().enumerate() {
            let Some(stamp) = stamp else {
                without_time += 1;
                continue;
            };
            if stamp < last {
                let cells = if let Some(cells) = &mut cells {
                    cells
                } else {
                    let words = wanted.iter().map(|(name, _)| table.words(name));
                    cells.insert(words.collect::<Result<_, _>>()?)
                };
                let same = |above: usize| cells.iter().all(|column| column[above] == column[row]);
                let from = earlier.partition_point(|s| s.0 < stamp);
                let mut alike = earlier[from..].iter().take_while(|s| s.0 == stamp);
                if alike.any(|s| same(s.1)) {
                    repeated += 1;
                    continue;
                }
                let cell = (stamp as f64 / 1e9).to_string();
                let expected =
                    "a time not before those of the rows above: signals are joined by time";
                return Err(table.bad_cell_of(row, time, cell, expected));
            }
            last = stamp;
            earlier.push((stamp, row));
            if counts[row] {
                stamp_ns.push(stamp);
                rows.push(row);
            }
        }
        Ok(SignalRows {
            path: self.path(file),
            table,
            stamp_ns,
            rows,
            without_time,
            repeated,
        })
    }
}

/// The rows of a signal that count, in the order of time.
pub(super) struct SignalRows {
    pub(super) path: PathBuf,
    pub(super) table: Table,
    /// Shape `(rows,)`, as all columns.
    pub(super) stamp_ns: Vec<i64>,
    /// Their numbers in the table, from 0.
    pub(super) rows: Vec<usize>,
    /// Rows that have no time and are left out.
    without_time: usize,
    /// Rows that are written again further down, and are left out there.
    repeated: usize,
}

impl SignalRows {
    /// Tells of rows that are left out.
    pub(super) fn report(&self, warnings: &mut Vec<Warning>) {
        let (missing, twice) = (WarningKind::MissingValue, WarningKind::DuplicateTime);
        let what = "rows without a time are left out";
        report(warnings, &self.path, missing, self.without_time, what);
        let what = "rows that repeat one above are left out";
        report(warnings, &self.path, twice, self.repeated, what);
    }

    /// A column as numbers times a unit; none where a cell is empty or stands for nothing.
    pub(super) fn numbers(
        &self,
        name: &str,
        missing: &[f64],
        unit: f64,
    ) -> Result<Vec<Option<f64>>, IngestError> {
        let values = self.table.numbers(name)?;
        let stands_for_none = |v: f64| missing.iter().any(|m| (m - v).abs() < SAME);
        let value_at = |&row: &usize| {
            let value = values[row];
            (value.is_finite() && !stands_for_none(value)).then_some(value * unit)
        };
        Ok(self.rows.iter().map(value_at).collect())
    }

    /// A fault in a cell of the n-th of these rows.
    pub(super) fn bad_cell(
        &self,
        nth: usize,
        name: &str,
        found: impl Into<String>,
        expected: &str,
    ) -> IngestError {
        self.table
            .bad_cell_of(self.rows[nth], name, found, expected)
    }
}

/// Numbers that differ by less are one.
const SAME: f64 = 1e-9;
