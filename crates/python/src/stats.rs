//! `maveric stats`: the words of the command over a table in memory.

use crate::{
    arrow::{Given, table_of},
    error::maveric_error,
};
use pyo3::prelude::*;

/// JSON of the result, the lines that the command prints, and its warnings.
type Found = (String, Vec<String>, Vec<String>);

/// Runs one call of `maveric stats` on a table.
#[pyfunction]
pub fn stats(py: Python<'_>, words: Vec<String>, data: Given) -> PyResult<Found> {
    let table = table_of(data);
    let outcome =
        py.allow_threads(|| maveric_cli::stats_of_table(&words, table)).map_err(maveric_error)?;
    Ok((outcome.value.to_string(), outcome.summary, outcome.warnings))
}
