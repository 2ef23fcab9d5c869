//! What the columns of the tables mean that are given away: a table itself.

use crate::{
    error::StudyError,
    tables::{Table, TableName, dictionary::entry_at, write_rows},
};
use std::path::Path;

/// Its name.
const DICTIONARY: &str = "dictionary.csv";

/// Writes it beside these files of the folder.
///
/// # Errors
/// As [`Table::read`] and [`write_rows`].
pub(super) fn write(folder: &Path, files: &[String]) -> Result<(), StudyError> {
    let mut rows = Vec::new();
    for file in files {
        let Some(entry) = entry_at(file).filter(|entry| entry.name.is_some()) else {
            continue;
        };
        for column in Table::read(&folder.join(file))?.columns() {
            let known = entry.column(&column);
            rows.extend(known.map(|known| {
                let made_in = known.made_in.as_ref().or(entry.made_in.as_ref());
                let place = (("file", file), ("column", column));
                let (unit, means) = (("unit", &known.unit), ("means", &known.means));
                (place, unit, means, ("made_in", made_in))
            }));
        }
    }
    write_rows(TableName::Dictionary, &folder.join(DICTIONARY), rows)
}
