//! Who and what was left out, and why.

use super::Table;
use serde::{Deserialize, Serialize};

/// One thing that was left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Exclusion {
    /// Participant, drive or answer.
    pub who: String,
    /// From what it was left out, such as `time headway merge back`.
    pub what: String,
    /// The reason.
    pub why: String,
}

/// Builds the table `exclusions`.
pub fn exclusions(rows: &[Exclusion]) -> Table {
    Table::of("exclusions", "Exclusions", rows)
        .text("Who", |row| &row.who)
        .text("Left out of", |row| &row.what)
        .text("Why", |row| &row.why)
        .noted(match rows.len() {
            0 => "Nothing was left out.".to_owned(),
            1 => "One exclusion.".to_owned(),
            n => format!("{n} exclusions."),
        })
        .keyed(&["who", "left_out_of", "why"])
}
