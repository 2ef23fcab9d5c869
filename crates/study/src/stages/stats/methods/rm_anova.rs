//! Repeated-measures ANOVA.

use super::{Ran, StudyError, Table, Test, WithinColumns, by_its_columns, pictures, printed};
use maveric_stats::rm_anova;

/// Repeated-measures ANOVA with Mauchly's test and corrected degrees of freedom
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats rm-anova data.csv --subject id --within condition --value score --latex")]
pub struct RmAnova {
    #[command(flatten)]
    columns: WithinColumns,
}

impl Test for RmAnova {
    const NAME: &'static str = "rm-anova";

    by_its_columns!();

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let data = self.columns.read(table)?;
        let result = rm_anova(&data);
        let (sentence, no_pairs) = (pictures::first(&result), std::iter::empty());
        let picture =
            pictures::conditions(&data, &self.columns.value, sentence, &result.desc, no_pairs);
        Ok(Ran::new(&result, printed::rm_anova(&result)).drawn(picture))
    }
}
