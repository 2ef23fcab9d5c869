//! The Python package's Rust half: thin functions over the crates, plain values in, JSON and Arrow out. What Python users see
//! (names, signatures, docstrings) stands in `python/maveric`.

// The macros of PyO3 make functions that Python finds by their names, and hand out references as Python wants them.
#![allow(
    unreachable_pub,
    clippy::needless_pass_by_value,
    reason = "what is exported is documented where Python users read it"
)]

mod arrow;
mod car;
mod drive;
mod error;
mod figures;
mod model;
mod program;
mod stats;

use pyo3::prelude::*;

/// The native half of `maveric`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::{
        car::{Planner, drive_in, simulate},
        drive::{Drive, read_log, score},
        error::MavericError,
        figures::{Figure, draw, figure_names},
        model::{Model, Style},
        program::{run, version},
        stats::stats,
    };
}
