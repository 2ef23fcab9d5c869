//! What a figure asks of its numbers before it draws them.

use crate::error::ReportError;

/// The checks of one figure.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Check<'a>(pub(crate) &'a str);

impl Check<'_> {
    /// All values are finite.
    pub(crate) fn finite(
        self,
        field: &str,
        values: impl IntoIterator<Item = f64>,
    ) -> Result<(), ReportError> {
        match values.into_iter().find(|value| !value.is_finite()) {
            None => Ok(()),
            Some(value) => Err(ReportError::NotFinite {
                figure: self.0.to_owned(),
                field: field.to_owned(),
                value,
            }),
        }
    }

    /// There are at least `expected` of them.
    pub(crate) fn at_least(
        self,
        expected: usize,
        what: &str,
        found: usize,
    ) -> Result<(), ReportError> {
        if found >= expected {
            return Ok(());
        }
        Err(ReportError::TooFew {
            figure: self.0.to_owned(),
            what: what.to_owned(),
            found,
            expected,
        })
    }

    /// A list is as long as it should be.
    pub(crate) fn length(
        self,
        what: &str,
        found: usize,
        expected: usize,
    ) -> Result<(), ReportError> {
        if found == expected {
            return Ok(());
        }
        Err(ReportError::LengthMismatch {
            figure: self.0.to_owned(),
            what: what.to_owned(),
            found,
            expected,
        })
    }

    /// A value is what it can be.
    pub(crate) fn that(
        self,
        holds: bool,
        field: &str,
        value: f64,
        expected: &str,
    ) -> Result<(), ReportError> {
        if holds {
            return Ok(());
        }
        Err(ReportError::OutOfRange {
            figure: self.0.to_owned(),
            field: field.to_owned(),
            value,
            expected: expected.to_owned(),
        })
    }
}
