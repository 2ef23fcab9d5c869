//! A person's rows of a table of words, taken out; every other byte of the file stays as it is.

use crate::{atomic_write::atomic_write_bytes, error::StudyError, tables::Table};
use maveric_domain::ParticipantId;
use std::path::Path;

/// Takes out the rows whose cell in `column` is this person's by `theirs`; how many they were. Nothing is written where there are none.
///
/// # Errors
/// As [`Table`] does; [`StudyError::BadFile`] for a table whose rows cannot be told apart.
pub(super) fn take_out(
    path: &Path,
    column: &str,
    id: &ParticipantId,
    theirs: impl Fn(&str, &str) -> bool,
) -> Result<usize, StudyError> {
    let table = Table::read(path)?;
    let theirs: Vec<bool> = table
        .text(column)?
        .into_iter()
        .map(|cell| cell.is_some_and(|cell| theirs(cell.trim(), id.as_str())))
        .collect();
    let count = theirs.iter().filter(|is| **is).count();
    if count == 0 {
        return Ok(0);
    }
    let bytes = std::fs::read(path).map_err(StudyError::read(path))?;
    let lines = records(&bytes);
    let blank = |line: &[u8]| line.trim_ascii().is_empty();
    let first = lines.iter().position(|line| !blank(line)).unwrap_or(0);
    let (above, rows) = lines.split_at((first + 1).min(lines.len()));
    // A blank line is a row without a cell, or, as at the end of a file, none.
    let blank_counts = rows.len() == theirs.len();
    let is_row = |line: &[u8]| blank_counts || !blank(line);
    if rows.iter().filter(|line| is_row(line)).count() != theirs.len() {
        let problem = format!("rows of {id} that cannot be told from the others");
        return Err(StudyError::file(path, problem).with_help("take them out by hand"));
    }
    let mut kept = above.concat();
    let mut is_theirs = theirs.iter();
    for line in rows {
        if !is_row(line) || !is_theirs.next().is_some_and(|is| *is) {
            kept.extend_from_slice(line);
        }
    }
    atomic_write_bytes(path, &kept)?;
    Ok(count)
}

/// The lines of a table with their ends; a cell in quotes may go on in the next line.
fn records(bytes: &[u8]) -> Vec<&[u8]> {
    let mut quoted = false;
    let ends = |b: &u8| {
        quoted ^= *b == b'"';
        *b == b'\n' && !quoted
    };
    bytes.split_inclusive(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rows_of_a_person_go_and_every_other_byte_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("people.csv");
        let text =
            "\n\"participant\";note\r\nP07;\"a\nb\"\r\n\nP070;P07\r\n P07 ;x\nP1;\"q\"\"\n\"";
        std::fs::write(&path, text).unwrap();
        let id = ParticipantId::new("P07").unwrap();
        assert_eq!(take_out(&path, "participant", &id, |cell, id| cell == id).unwrap(), 2);
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "\n\"participant\";note\r\n\nP070;P07\r\nP1;\"q\"\"\n\""
        );
        assert_eq!(take_out(&path, "participant", &id, |cell, id| cell == id).unwrap(), 0);
        std::fs::write(&path, "participant\nP07\nP1\n\n\n").unwrap();
        assert_eq!(take_out(&path, "participant", &id, |cell, id| cell == id).unwrap(), 1);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "participant\nP1\n\n\n");
    }
}
