//! Columns between Python and Rust. `_arrow.py` reads and makes the structs of Arrow's C data interface around them.

use maveric_study::tables::TableBuilder;
use pyo3::{prelude::*, types::PyBytes};

/// A column as Python gives it; a missing cell is None.
#[derive(FromPyObject)]
pub(crate) enum Cells {
    /// Whole numbers.
    #[pyo3(transparent)]
    Whole(Vec<Option<i64>>),
    #[pyo3(transparent)]
    Numbers(Vec<Option<f64>>),
    #[pyo3(transparent)]
    Text(Vec<Option<String>>),
}

/// Names and cells of a table's columns.
pub(crate) type Given = Vec<(String, Cells)>;

pub(crate) fn table_of(columns: Given) -> TableBuilder {
    let mut table = TableBuilder::default();
    for (name, cells) in columns {
        table = match cells {
            Cells::Whole(cells) => table.integers(&name, cells),
            Cells::Numbers(cells) => table.numbers(&name, cells),
            // A missing cell is an empty one, as in CSV.
            Cells::Text(cells) => {
                table.cells(&name, cells.into_iter().map(|c| c.or(Some(String::new()))))
            }
        };
    }
    table
}

/// A column on its way to Python: name, Arrow's letter for its type, number of rows, and its buffers (the first is the bitmap of cells
/// that are there, empty where all are).
type Column = (String, &'static str, usize, Vec<Py<PyBytes>>);

/// Named columns on their way to Python.
pub(crate) struct Columns<'py> {
    py: Python<'py>,
    columns: Vec<Column>,
}

impl<'py> Columns<'py> {
    pub(crate) fn new(py: Python<'py>) -> Self {
        Self { py, columns: Vec::new() }
    }

    pub(crate) fn numbers(self, name: &str, values: impl IntoIterator<Item = Option<f64>>) -> Self {
        self.fixed(name, "g", values, f64::to_le_bytes)
    }

    pub(crate) fn integers(
        self,
        name: &str,
        values: impl IntoIterator<Item = Option<i64>>,
    ) -> Self {
        self.fixed(name, "l", values, i64::to_le_bytes)
    }

    pub(crate) fn flags(self, name: &str, values: &[bool]) -> Self {
        self.push(name, "b", values.len(), [Vec::new(), packed(values)])
    }

    pub(crate) fn texts(self, name: &str, values: impl IntoIterator<Item = String>) -> Self {
        let (mut ends, mut text) = (0_u64.to_le_bytes().to_vec(), Vec::new());
        let mut rows = 0;
        for value in values {
            text.extend_from_slice(value.as_bytes());
            ends.extend((text.len() as u64).to_le_bytes());
            rows += 1;
        }
        self.push(name, "U", rows, [Vec::new(), ends, text])
    }

    pub(crate) fn finish(self) -> Vec<Column> {
        self.columns
    }

    fn fixed<T: Default>(
        self,
        name: &str,
        kind: &'static str,
        values: impl IntoIterator<Item = Option<T>>,
        bytes: fn(T) -> [u8; 8],
    ) -> Self {
        let (mut there, mut cells) = (Vec::new(), Vec::new());
        for value in values {
            there.push(value.is_some());
            cells.extend(bytes(value.unwrap_or_default()));
        }
        let rows = there.len();
        let bitmap = if there.contains(&false) { packed(&there) } else { Vec::new() };
        self.push(name, kind, rows, [bitmap, cells])
    }

    fn push<const N: usize>(
        mut self,
        name: &str,
        kind: &'static str,
        rows: usize,
        buffers: [Vec<u8>; N],
    ) -> Self {
        let buffers = buffers.map(|bytes| PyBytes::new(self.py, &bytes).unbind());
        let column = (name.to_owned(), kind, rows, buffers.into());
        self.columns.push(column);
        self
    }
}

/// Eight flags a byte, the first in the lowest bit.
fn packed(flags: &[bool]) -> Vec<u8> {
    let byte = |eight: &[bool]| {
        let bits = eight.iter().enumerate();
        bits.fold(0, |byte, (i, &flag)| byte | u8::from(flag) << i)
    };
    flags.chunks(8).map(byte).collect()
}

/// What a function that makes a table gives.
pub(crate) type Made = Vec<Column>;
