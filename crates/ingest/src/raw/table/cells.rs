//! What a cell of text holds.

/// What a cell of numbers should hold.
pub(super) const NUMBER: &str = "a finite number";
/// The same in a table of decimal commas, where a point may stand between thousands or be meant as a comma.
const NUMBER_WITH_COMMA: &str = "a number with a decimal comma and no point: a table of decimal commas does not say whether a \
                                 point stands between thousands";
/// Words that stand for an empty cell.
const EMPTY: [&str; 6] = ["", "nan", "na", "null", "none", "-"];

/// A cell without the blanks around it.
pub(super) fn trimmed(cell: Option<&str>) -> &str {
    cell.map(str::trim).unwrap_or_default()
}

fn is_empty(cell: &str) -> bool {
    EMPTY.iter().any(|e| cell.eq_ignore_ascii_case(e))
}

/// A cell as a number; NaN for an empty one.
///
/// # Errors
/// What was expected, where that is more than a number of the column's.
pub(super) fn number(cell: &str, decimal_comma: bool) -> Result<f64, Option<&'static str>> {
    if is_empty(cell) {
        return Ok(f64::NAN);
    }
    parse_number(cell, decimal_comma)
        .map_err(|expected| (expected == NUMBER_WITH_COMMA).then_some(expected))
}

/// A cell of any table as a finite number; the error is what was expected.
///
/// In a table of decimal commas a point is refused.
///
/// # Errors
/// The accepted form in words.
pub fn parse_number(cell: &str, decimal_comma: bool) -> Result<f64, &'static str> {
    if decimal_comma && cell.contains('.') {
        return Err(NUMBER_WITH_COMMA);
    }
    let parsed = if decimal_comma { cell.replace(',', ".").parse() } else { cell.parse() };
    parsed.ok().filter(|v: &f64| v.is_finite()).ok_or(NUMBER)
}

/// A cell as a word; none for an empty one.
pub(super) fn word(cell: &str) -> Option<String> {
    // A whole number that went through a table of floats is still the same number.
    let whole = cell.strip_suffix(".0");
    let whole = whole.filter(|n| n.bytes().all(|b| b.is_ascii_digit() || b == b'-'));
    (!is_empty(cell)).then(|| whole.unwrap_or(cell).to_owned())
}
