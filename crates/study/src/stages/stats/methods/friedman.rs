//! Friedman's test.

use super::{Ran, StudyError, Table, Test, WithinColumns, by_its_columns, pictures, printed};
use maveric_stats::friedman;

/// Friedman's test: chi-squared, Iman-Davenport F, exact
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats friedman data.csv --subject id --within condition --value score")]
pub struct Friedman {
    #[command(flatten)]
    columns: WithinColumns,
}

impl Test for Friedman {
    const NAME: &'static str = "friedman";

    by_its_columns!();

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let data = self.columns.read(table)?;
        let result = friedman(&data);
        let (sentence, no_pairs) = (pictures::first(&result), std::iter::empty());
        let picture =
            pictures::conditions(&data, &self.columns.value, sentence, &result.desc, no_pairs);
        Ok(Ran::new(&result, printed::friedman(&result)).drawn(picture))
    }
}
