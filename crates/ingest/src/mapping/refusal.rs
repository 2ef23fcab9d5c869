//! What a setting of a mapping is refused for.

/// A sentence that says what to add or to leave out.
pub(super) type Checked = Result<(), String>;

/// Refuses a number that is not above 0.
pub(super) fn positive(key: &str, value: Option<f64>) -> Checked {
    match value {
        Some(v) if !(v.is_finite() && v > 0.0) => {
            Err(format!("`{key}` is {v}, expected a finite number above 0"))
        }
        _ => Ok(()),
    }
}

/// Refuses what is wrong, and says why.
pub(super) fn refuse(wrong: bool, why: &str) -> Checked {
    if wrong { Err(why.to_owned()) } else { Ok(()) }
}
