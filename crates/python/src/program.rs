//! The command line.

use maveric_cli::Invocation;
use pyo3::prelude::*;

/// Runs the command with these words and gives its exit status; stages are started as `program *leading WORDS`.
#[pyfunction]
pub fn run(py: Python<'_>, words: Vec<String>, program: String, leading: Vec<String>) -> u8 {
    let invocation = Invocation { words, program: program.into(), leading };
    py.allow_threads(|| maveric_cli::run(invocation))
}

/// That of `Cargo.toml`, such as `0.1.0`.
#[pyfunction]
pub fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}
