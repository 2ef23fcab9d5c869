//! McNemar's test.

use super::{Ran, StudyError, Table, Test, WithinColumns, by_its_columns, yes_no};
use maveric_stats::mcnemar;

/// Two conditions answered with yes or no by the same people: McNemar, exact and mid-p
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a cell, with subject, condition and an answer (yes or no, true or false, 1 or 0); or a column a condition, by --wide.
Example: maveric stats mcnemar data.csv --subject id --within condition --value noticed")]
pub struct Mcnemar {
    #[command(flatten)]
    columns: WithinColumns,
}

impl Test for Mcnemar {
    const NAME: &'static str = "mcnemar";
    const HAS_FIGURE: bool = false;

    by_its_columns!();

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        Ok(Ran::plainly(&mcnemar(&yes_no(table, &self.columns)?)?))
    }
}
