//! The one exception: the text of the command.

use pyo3::{create_exception, exceptions::PyException, prelude::*};
use std::error::Error;

create_exception!(
    maveric,
    MavericError,
    PyException,
    "What could not be done, what was found, and what to do."
);

/// An error with everything that caused it, in one text.
pub(crate) fn raised(error: impl Error) -> PyErr {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        text = format!("{text}: {inner}");
        cause = inner.source();
    }
    MavericError::new_err(text)
}

pub(crate) fn maveric_error(text: impl Into<String>) -> PyErr {
    MavericError::new_err(text.into())
}

/// The error of a Ctrl-C, or of any other signal that Python has a handler for.
pub(crate) fn asked_to_stop() -> PyResult<()> {
    #[expect(
        clippy::redundant_closure_for_method_calls,
        reason = "the method itself is not general enough over lifetimes"
    )]
    Python::with_gil(|py| py.check_signals())
}
