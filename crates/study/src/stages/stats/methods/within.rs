//! The whole analysis of a within-subject design.

use super::{Ran, StudyError, Table, Test, WithinColumns, by_its_columns, pictures, printed};
use maveric_stats::within;

/// The whole analysis of a within-subject design
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats within data.csv --subject id --within condition --value score")]
pub struct Within {
    #[command(flatten)]
    columns: WithinColumns,
}

impl Test for Within {
    const NAME: &'static str = "within";

    by_its_columns!();

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let data = self.columns.read(table)?;
        let result = within(&data);
        let p = result.paired.values().map(|pair| pair.p_holm);
        let sentence = pictures::first(&result);
        let picture = pictures::conditions(&data, &self.columns.value, sentence, &result.desc, p);
        Ok(Ran::new(&result, printed::whole(&result)).drawn(picture))
    }
}
