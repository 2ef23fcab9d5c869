//! Who and what was left out, and why.

use super::{Cell, Column, Table};
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
    let cells = |row: &Exclusion| [&row.who, &row.what, &row.why].map(Cell::text).to_vec();
    Table {
        name: "exclusions".to_owned(),
        title: "Exclusions".to_owned(),
        columns: ["Who", "Left out of", "Why"].map(Column::left).to_vec(),
        rows: rows.iter().map(cells).collect(),
        notes: vec![match rows.len() {
            0 => "Nothing was left out.".to_owned(),
            1 => "One exclusion.".to_owned(),
            n => format!("{n} exclusions."),
        }],
    }
}
