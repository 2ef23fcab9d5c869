//! One number against its range.

use crate::error::SimulatorError;

/// What a setting may be.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Range {
    /// Finite and above 0.
    Positive,
    /// Finite and 0 or above.
    NotNegative,
    /// Any finite number.
    Finite,
    /// Between two numbers, both included; in words.
    Within(f64, f64, &'static str),
}

/// Refuses `found` outside `range`, naming it `section.key`.
pub(crate) fn check(
    section: &str,
    key: &str,
    found: f64,
    range: Range,
) -> Result<(), SimulatorError> {
    let (fits, expected) = match range {
        Range::Positive => (found > 0.0, "a finite number above 0"),
        Range::NotNegative => (found >= 0.0, "a finite number, 0 or above"),
        Range::Finite => (true, "a finite number"),
        Range::Within(low, high, words) => ((low..=high).contains(&found), words),
    };
    if fits && found.is_finite() {
        return Ok(());
    }
    let name = if section.is_empty() {
        key.to_owned()
    } else {
        format!("{section}.{key}")
    };
    Err(SimulatorError::Setting {
        name,
        found,
        expected,
    })
}
