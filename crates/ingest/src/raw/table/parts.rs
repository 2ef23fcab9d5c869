//! A table that was split over several files: how their times follow one another.

use super::{
    open::Table,
    time::{Clock, as_written},
};
use crate::{
    error::IngestError,
    folder::file_name,
    mapping::TableMapping,
    quality::{Warning, WarningKind},
};
use std::{
    ops::Range,
    path::{Path, PathBuf},
};

/// A part that begins within this share of the one above it, counted from that one's beginning, has a clock that begins anew.
const ANEW: f64 = 0.1;

/// One file of a table.
struct Part<'a> {
    path: &'a Path,
    rows: Range<usize>,
    /// First and last time as its clock says them, in ns.
    first_ns: i64,
    last_ns: i64,
    /// How far its times are put off so that it follows the parts above, in ns.
    put_off_ns: i64,
    /// Whether its clock begins anew.
    anew: bool,
}

/// The files of a table and how they follow one another, `hole_ns` before each whose clock begins anew; those without a time are passed over.
///
/// # Errors
/// [`IngestError::BadTable`] for a part that begins before the one above it ends, and not with it.
fn parts<'a>(
    table: &'a Table,
    stamps: &[Option<i64>],
    hole_ns: i64,
) -> Result<Vec<Part<'a>>, IngestError> {
    let mut parts: Vec<Part> = Vec::new();
    for (path, rows) in table.parts() {
        let times = || stamps[rows.clone()].iter().flatten().copied();
        let (Some(first_ns), Some(last_ns)) = (times().min(), times().max()) else {
            continue;
        };
        let (mut put_off_ns, mut anew) = (0, false);
        if let Some(above) = parts.last() {
            let length_ns = above.last_ns.saturating_sub(above.first_ns) as f64;
            let into_ns = first_ns.saturating_sub(above.first_ns) as f64;
            anew = first_ns <= above.last_ns;
            if anew && into_ns > ANEW * length_ns {
                let (begins, ends) = (first_ns as f64 / 1e9, above.last_ns as f64 / 1e9);
                return Err(IngestError::bad_table(
                    path,
                    format!(
                        "it begins at {begins:.3} s, but {} above it ends at {ends:.3} s: parts of one recording are expected to \
                         follow one another. Is `parts` of the mapping's `[names]` right?",
                        file_name(above.path)
                    ),
                ));
            }
            let end_ns = above.last_ns.saturating_add(above.put_off_ns);
            put_off_ns = if anew {
                end_ns.saturating_add(hole_ns).saturating_sub(first_ns)
            } else {
                above.put_off_ns
            };
        }
        parts.push(Part { path, rows, first_ns, last_ns, put_off_ns, anew });
    }
    Ok(parts)
}

/// A column as nanoseconds, shape `(rows,)`; an empty cell is none. A part whose clock begins anew follows the others after a hole.
pub(super) fn stamps(
    table: &Table,
    name: &str,
    clock: Clock<'_>,
) -> Result<Vec<Option<i64>>, IngestError> {
    let mut stamps = as_written(table, name, clock)?;
    if table.is_split() {
        for Part { rows, put_off_ns, .. } in parts(table, &stamps, clock.hole_ns)? {
            for stamp_ns in stamps[rows].iter_mut().flatten() {
                *stamp_ns = stamp_ns.saturating_add(put_off_ns);
            }
        }
    }
    Ok(stamps)
}

/// The number by which the name of a part differs from that of the part before it; its name where there is none.
fn number_in(below: &str, above: &str) -> String {
    let pairs = below.bytes().zip(above.bytes());
    let alike = pairs.take_while(|(a, b)| a == b).count();
    // `_10` and `_11` differ in their last digit alone.
    let before = below.as_bytes()[..alike].iter().rev();
    let from = alike - before.take_while(|b| b.is_ascii_digit()).count();
    let differs = below.bytes().skip(from);
    let digits = differs.skip_while(|b| !b.is_ascii_digit()).take_while(u8::is_ascii_digit);
    let number: String = digits.map(char::from).collect();
    if number.is_empty() {
        return format!("`{below}`");
    }
    number
}

/// Says which files were joined, and how long the hole between each two is.
pub(super) fn joined(
    log: &Path,
    files: Vec<(PathBuf, Vec<u8>)>,
    mapping: &TableMapping,
    clock: Clock<'_>,
) -> Result<Vec<Warning>, IngestError> {
    let time = mapping.layout.column(&["time"]).unwrap_or_default();
    let table = Table::open_all(files, mapping.into(), &[(&time, clock.kind())])?;
    let parts = parts(&table, &as_written(&table, &time, clock)?, clock.hole_ns)?;
    let start_ns = parts.first().map_or(0, |p| p.first_ns);
    let since_s = |ns: i64, part: &Part<'_>| {
        (ns.saturating_add(part.put_off_ns).saturating_sub(start_ns)) as f64 / 1e9
    };
    let join = |pair: &[Part<'_>]| {
        let (above, below) = (&pair[0], &pair[1]);
        let (from_s, to_s) = (since_s(above.last_ns, above), since_s(below.first_ns, below));
        // By its number, so that what is true of many logs is said once.
        let part = number_in(&file_name(below.path), &file_name(above.path));
        let goes_on = format!("goes on in its part {part}");
        let warning = if below.anew {
            let what = format!(
                "{goes_on}, whose times begin anew: how long the hole between them was is not known, and a segment begins"
            );
            Warning::new(log, WarningKind::ClockRestart, 1, what)
        } else {
            let what = format!("{goes_on}, {:.3} s later", to_s - from_s);
            Warning::new(log, WarningKind::Noted, 1, what)
        };
        warning.with_spans([(from_s, to_s)])
    };
    Ok(parts.windows(2).map(join).collect())
}

#[cfg(test)]
mod tests {
    use super::number_in;

    #[test]
    fn a_part_is_called_by_the_number_in_its_name() {
        for (below, above, number) in [
            ("P01_calm_2.csv", "P01_calm.csv", "2"),
            ("P01_calm_3.csv", "P01_calm_1.csv", "3"),
            ("P01_11.csv", "P01_10.csv", "11"),
            ("part2_P01.csv", "part1_P01.csv", "2"),
            ("late.csv", "early.csv", "`late.csv`"),
        ] {
            assert_eq!(number_in(below, above), number);
        }
    }
}
