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

impl Exclusion {
    /// What something repaired or doubtful that is kept is left out of.
    pub const NOTHING: &str = "nothing";

    /// Whether it is repaired or doubtful, and kept.
    pub fn is_kept(&self) -> bool {
        self.what == Self::NOTHING
    }
}

/// Builds the table `exclusions`.
pub fn exclusions(rows: &[Exclusion]) -> Table {
    let kept = rows.iter().filter(|row| row.is_kept()).count();
    let doubted = match kept {
        0 => String::new(),
        1 => " One row more is repaired or doubtful, and kept.".to_owned(),
        n => format!(" {n} rows more are repaired or doubtful, and kept."),
    };
    let left_out = match rows.len() - kept {
        0 => "Nothing was left out.".to_owned(),
        1 => "One exclusion.".to_owned(),
        n => format!("{n} exclusions."),
    };
    Table::of("exclusions", "Exclusions", rows)
        .text("Who", |row| &row.who)
        .text("Left out of", |row| &row.what)
        .text("Why", |row| &row.why)
        .noted(left_out + &doubted)
        .keyed(&["who", "left_out_of", "why"])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_doubtful_and_kept_is_listed_and_not_counted_as_left_out() {
        let row = |what: &str| Exclusion {
            who: "P1".to_owned(),
            what: what.to_owned(),
            why: "all 6 items with 4".to_owned(),
        };
        let noted = |rows: &[Exclusion]| exclusions(rows).to_markdown();
        let (out, kept) = (row("questionnaires"), row(Exclusion::NOTHING));
        let both = noted(&[out.clone(), out, kept.clone()]);
        assert!(
            both.contains("2 exclusions. One row more is repaired or doubtful, and kept."),
            "{both}"
        );
        let kept = noted(&[kept]);
        assert!(kept.contains("Nothing was left out. One row more"), "{kept}");
        assert!(!noted(&[]).contains("doubtful"));
    }
}
