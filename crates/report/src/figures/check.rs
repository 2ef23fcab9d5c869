//! What a figure asks of its numbers before it draws them.

use crate::error::ReportError;

/// Above this a square is not finite any more.
const MOST: f64 = 1e150;

/// The checks of one figure.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Check<'a>(pub(crate) &'a str);

impl Check<'_> {
    /// All values are finite, and so are their squares.
    pub(crate) fn finite(
        self,
        field: &str,
        values: impl IntoIterator<Item = f64>,
    ) -> Result<(), ReportError> {
        let usable = |value: &f64| value.is_finite() && value.abs() <= MOST;
        match values.into_iter().find(|value| !usable(value)) {
            None => Ok(()),
            Some(value) if value.is_finite() => self.that(false, field, value, "at most 1e150"),
            Some(value) => Err(ReportError::NotFinite {
                figure: self.0.to_owned(),
                field: field.to_owned(),
                value,
            }),
        }
    }

    /// The name of the figure, or of whatever is checked, can be that of a file and an anchor.
    pub(crate) fn name(self) -> Result<(), ReportError> {
        let usable = |sign: char| sign.is_ascii_lowercase() || sign.is_ascii_digit() || sign == '-';
        if !self.0.is_empty() && self.0.chars().all(usable) {
            return Ok(());
        }
        Err(ReportError::BadName { name: self.0.to_owned() })
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

    /// There are at most so many of them.
    pub(crate) fn at_most(self, most: usize, what: &str, count: usize) -> Result<(), ReportError> {
        self.that(count <= most, what, count as f64, &format!("at most {most}"))
    }

    /// Each value is above the one before it.
    pub(crate) fn rising(
        self,
        field: &str,
        values: impl IntoIterator<Item = f64>,
        expected: &str,
    ) -> Result<(), ReportError> {
        let mut before = None;
        for value in values {
            let rises = before.is_none_or(|before| before < value);
            self.that(rises, field, value, expected)?;
            before = Some(value);
        }
        Ok(())
    }

    /// Each value lies between two ends, which belong to it.
    pub(crate) fn within(
        self,
        (low, high): (f64, f64),
        field: &str,
        values: impl IntoIterator<Item = f64>,
        expected: &str,
    ) -> Result<(), ReportError> {
        let mut values = values.into_iter();
        values
            .try_for_each(|value| self.that((low..=high).contains(&value), field, value, expected))
    }
}
