//! The one shape of a table.

use crate::apa;
use crate::error::ReportError;
use crate::markup;
use serde::{Deserialize, Serialize};

/// A table, ready to be written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Stem of its files and its anchor: lower-case letters, digits, hyphens.
    pub name: String,
    /// One line, with marks (see [`crate::markup`]).
    pub title: String,
    /// From left to right.
    pub columns: Vec<Column>,
    /// The rows, each with a cell a column.
    pub rows: Vec<Vec<Cell>>,
    /// What stands below: n, tests, abbreviations. With marks.
    pub notes: Vec<String>,
    /// The same for machines; none where the columns that are shown are it.
    pub data: Option<Data>,
}

/// A table for machines: a number a cell, columns and rows under names that do not change with labels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Data {
    /// Heads of the columns: small letters, digits and `_`.
    pub heads: Vec<String>,
    /// What each row is of, from ids.
    pub ids: Vec<String>,
    /// The rows, each with a cell a head.
    pub rows: Vec<Vec<Cell>>,
    /// The unit of each cell, empty where it has none; no rows where none is known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub units: Vec<Vec<String>>,
}

/// The head of a column.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// What it holds, with the unit; with marks.
    pub header: String,
    /// On which side its cells stand.
    pub align: Align,
}

/// On which side cells stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// What a cell holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cell {
    /// Any text, taken as it is: names, ids, reasons.
    Text(String),
    /// A text of ours with marks.
    Marked(String),
    /// A number, rounded for display; whole in the CSV.
    Number {
        /// Before it is rounded.
        value: f64,
        /// Decimals shown.
        decimals: usize,
    },
    /// A number bounded by 1, shown without the zero before the point.
    Bounded {
        /// Before it is rounded.
        value: f64,
        /// Decimals shown.
        decimals: usize,
    },
    /// A p: `< .001` below that, else three decimals; whole in the CSV.
    P(f64),
    /// Not there: an empty field in the CSV, a dash elsewhere.
    Missing,
}

impl Table {
    /// The table, with these heads for machines in the place of those that are shown.
    #[must_use]
    pub fn keyed(self, heads: &[&str]) -> Self {
        let data = Data {
            heads: heads.iter().map(|&head| head.to_owned()).collect(),
            ids: (1..=self.rows.len()).map(|row| row.to_string()).collect(),
            rows: self.rows.clone(),
            units: Vec::new(),
        };
        Self { data: Some(data), ..self }
    }
}

impl Cell {
    /// Any text, taken as it is.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// Whether, in a word, or missing.
    pub fn word(whether: Option<bool>, yes: &str, no: &str) -> Self {
        whether.map_or(Self::Missing, |is| Self::text(if is { yes } else { no }))
    }

    /// A whole number, without decimals.
    pub fn count(count: usize) -> Self {
        Self::Number { value: count as f64, decimals: 0 }
    }

    /// A number, or missing.
    pub fn number(value: Option<f64>, decimals: usize) -> Self {
        value.map_or(Self::Missing, |value| Self::Number { value, decimals })
    }

    /// A number bounded by 1, or missing.
    pub fn bounded(value: Option<f64>, decimals: usize) -> Self {
        value.map_or(Self::Missing, |value| Self::Bounded { value, decimals })
    }

    /// A p, or missing.
    pub fn p(p: Option<f64>) -> Self {
        p.map_or(Self::Missing, Self::P)
    }

    /// As shown, with marks.
    pub fn marked(&self) -> String {
        match self {
            Self::Text(text) => markup::literal(text),
            Self::Marked(text) => text.clone(),
            Self::Number { value, decimals } => apa::number(*value, *decimals),
            Self::Bounded { value, decimals } => apa::bounded(*value, *decimals),
            Self::P(p) => apa::p_cell(*p),
            Self::Missing => "–".to_owned(),
        }
    }
}

impl Column {
    /// A column of words.
    pub fn left(header: impl Into<String>) -> Self {
        Self { header: header.into(), align: Align::Left }
    }

    /// A column of numbers.
    pub fn right(header: impl Into<String>) -> Self {
        Self { header: header.into(), align: Align::Right }
    }
}

impl Table {
    /// The rows as shown, with marks.
    pub fn shown(&self) -> Vec<Vec<String>> {
        let rows = self.rows.iter();
        rows.map(|row| row.iter().map(Cell::marked).collect()).collect()
    }

    /// Checks that every row fits the columns and every number is finite.
    ///
    /// # Errors
    /// [`ReportError::TableShape`] or [`ReportError::TableNumber`], naming the row.
    pub fn check(&self) -> Result<(), ReportError> {
        self.check_rows(&self.rows, self.columns.len())?;
        let data = self.data.as_ref();
        data.map_or(Ok(()), |data| self.check_rows(&data.rows, data.heads.len()))
    }

    fn check_rows(&self, rows: &[Vec<Cell>], expected: usize) -> Result<(), ReportError> {
        for (row, cells) in rows.iter().enumerate() {
            if cells.len() != expected {
                return Err(ReportError::TableShape {
                    table: self.name.clone(),
                    row,
                    found: cells.len(),
                    expected,
                });
            }
            for (column, cell) in cells.iter().enumerate() {
                if let Cell::Number { value, .. } | Cell::Bounded { value, .. } | Cell::P(value) =
                    cell
                    && !value.is_finite()
                {
                    let table = self.name.clone();
                    return Err(ReportError::TableNumber { table, row, column, value: *value });
                }
            }
        }
        Ok(())
    }
}
