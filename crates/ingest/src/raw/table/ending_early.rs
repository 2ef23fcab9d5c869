//! Rows of a text that end before its header does: which lack a cell that is wanted, and whether the last one is cut.

use super::text::ShortRow;
use crate::quality::{Warning, WarningKind};
use std::path::Path;

/// Says of a table of so many `rows` and of `width` columns, of which the `needed`th is the last that is wanted, that rows end early; and
/// whether the last one is cut and is none.
pub(super) fn ending_early(
    path: &Path,
    short: &[ShortRow],
    rows: usize,
    width: usize,
    needed: usize,
) -> (Vec<Warning>, bool) {
    let cut = short.last().filter(|s| s.is_cut && s.row + 1 == rows);
    let mut warnings = Vec::new();
    let mut early = short.iter().filter(|s| s.cells < needed && Some(*s) != cut);
    if let Some(first) = early.next() {
        let what = format!(
            "rows end early, the first of them row {} after {} of {width} cells: what they lack is empty",
            first.row + 1,
            first.cells
        );
        let (kind, count) = (WarningKind::MissingValue, 1 + early.count());
        warnings.push(Warning::new(path, kind, count, what));
    }
    if let Some(cut) = cut {
        let what = format!(
            "the last row, {rows}, ends after {} of {width} cells and without a line's end: its last cell may be cut, and the row is left out",
            cut.cells
        );
        warnings.push(Warning::new(path, WarningKind::MissingValue, 1, what));
    }
    (warnings, cut.is_some())
}
