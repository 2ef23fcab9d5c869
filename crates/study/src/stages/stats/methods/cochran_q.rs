//! Cochran's Q.

use crate::{
    error::StudyError,
    stages::stats::{
        columns::{WithinColumns, yes_no},
        ran::Ran,
        statistical_test::{Test, by_its_columns},
    },
    tables::Table,
};
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

    by_its_columns!();

    fn has_figure(&self) -> bool {
        false
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        Ok(Ran::plainly(&cochran_q(&yes_no(table, &self.columns)?)?))
    }
}
