//! What can be wrong with the nouns.

/// A value that this crate refuses to make.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainError {
    /// An identifier with characters that do not belong in a file name.
    #[error(
        "{kind} `{found}` must be 1 to 64 letters, digits, `_` or `-`, not begin with `-`, and be no device of Windows (con, nul, com1, …)"
    )]
    BadId {
        /// Which identifier.
        kind: &'static str,
        /// What was given.
        found: String,
    },
    /// A condition's id with characters that do not belong in a file name.
    #[error(
        "condition `{found}` must be 1 to 32 letters, digits, `_` or `-`, not begin with `-`, and be no device of Windows (con, nul, com1, …)"
    )]
    BadCondition {
        /// What was given.
        found: String,
    },
    /// What counts sessions or trials and is no whole number from 1.
    #[error("{kind} `{found}` must be a whole number from 1")]
    BadNumber {
        /// What is counted.
        kind: &'static str,
        /// What was given.
        found: String,
    },
    /// A moment that is neither `pre` nor a condition's id.
    #[error(
        "`{found}` is not a moment; expected `pre`, or a condition (`after:` may stand before it): 1 to 32 letters, digits, `_` or `-`"
    )]
    UnknownMoment {
        /// What was given.
        found: String,
    },
    /// A word that names none of the known values.
    #[error("`{found}` is not a {kind}; expected one of {expected}")]
    UnknownWord {
        /// What the word should have named.
        kind: &'static str,
        /// What was given.
        found: String,
        /// The words that are known.
        expected: &'static str,
    },
    /// Columns of one table that differ in length.
    #[error("column `{column}` has {found} rows, expected {expected}")]
    LengthMismatch {
        /// Name of the column.
        column: &'static str,
        /// Its rows.
        found: usize,
        /// Rows of the others.
        expected: usize,
    },
    /// A number that is NaN or infinite.
    #[error("column `{column}` row {row} is {found}, expected a finite number")]
    NotFinite {
        /// Name of the column.
        column: &'static str,
        /// Zero-based row.
        row: usize,
        /// What was found.
        found: f64,
    },
    /// A number outside its range.
    #[error("`{name}` is {found}, expected {expected}")]
    OutOfRange {
        /// Name of the quantity.
        name: &'static str,
        /// What was found.
        found: f64,
        /// The range in words.
        expected: &'static str,
    },
    /// Ends of a scale of scores that are none.
    #[error("scores from {low} to {high}, expected two finite numbers, the lower one first")]
    NoRange {
        /// What should be the lowest score.
        low: f64,
        /// What should be the highest score.
        high: f64,
    },
    /// A score that its scale does not have.
    #[error("a score of {found}, expected {low} to {high}")]
    NotOnScale {
        /// The score, in points.
        found: f64,
        /// The lowest of its scale.
        low: f64,
        /// The highest of its scale.
        high: f64,
    },
    /// A recording or drive without enough rows.
    #[error("{what} has {found} rows, expected at least {expected}")]
    TooShort {
        /// What is too short.
        what: &'static str,
        /// Its rows.
        found: usize,
        /// Rows needed.
        expected: usize,
    },
    /// A scale file that is not TOML, or has a key missing, misspelt or of the wrong type.
    #[error("not a scale definition: {problem}")]
    ScaleToml {
        /// Line, key and reason, as the parser gives them.
        problem: String,
    },
    /// A questionnaire definition that contradicts itself.
    #[error("scale `{scale}`: {problem}")]
    BadScale {
        /// The scale's id.
        scale: String,
        /// What contradicts what.
        problem: String,
    },
}

/// Refuses fewer rows than `expected`.
pub(crate) fn at_least(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), DomainError> {
    if found < expected {
        return Err(DomainError::TooShort { what, found, expected });
    }
    Ok(())
}

/// Refuses a column of another length than `expected`.
pub(crate) fn as_long(
    column: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), DomainError> {
    if found != expected {
        return Err(DomainError::LengthMismatch { column, found, expected });
    }
    Ok(())
}

/// Refuses a column with a number that is NaN or infinite.
pub(crate) fn finite(column: &'static str, values: &[f64]) -> Result<(), DomainError> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(row) => Err(DomainError::NotFinite { column, row, found: values[row] }),
        None => Ok(()),
    }
}

/// Refuses what is no finite number above 0.
pub(crate) fn positive(name: &'static str, found: f64) -> Result<(), DomainError> {
    if found.is_finite() && found > 0.0 {
        return Ok(());
    }
    Err(DomainError::OutOfRange { name, found, expected: "a finite number above 0" })
}
