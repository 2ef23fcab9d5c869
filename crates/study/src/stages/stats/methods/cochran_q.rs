//! Cochran's Q.

use super::{Ran, StudyError, Table, Test, WithinColumns, by_its_columns, yes_no};
use maveric_stats::cochran_q;

/// Conditions answered with yes or no by the same people: Cochran's Q, then McNemar of each pair
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a cell, with subject, condition and an answer (yes or no, true or false, 1 or 0); or a column a condition, by --wide.
Example: maveric stats cochran-q data.csv --subject id --within condition --value noticed")]
pub struct CochranQ {
    #[command(flatten)]
    columns: WithinColumns,
}

impl Test for CochranQ {
    const NAME: &'static str = "cochran-q";
    const HAS_FIGURE: bool = false;

    by_its_columns!();

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        Ok(Ran::plainly(&cochran_q(&yes_no(table, &self.columns)?)?))
    }
}
