//! Repeated-measures ANOVA.

use crate::{
    error::StudyError,
    stages::stats::{
        columns::WithinColumns, input::Long, pictures, printed, ran::Ran, statistical_test::Test,
    },
    tables::Table,
};
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

    fn long(&self) -> Option<Long<'_>> {
        Some(self.columns.long())
    }

    fn value(&mut self) -> Option<&mut String> {
        Some(&mut self.columns.value)
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let data = self.columns.read(table)?;
        let found = rm_anova(&data);
        let (said, no_pairs) = (pictures::first(&found), std::iter::empty());
        let picture = pictures::conditions(&data, &self.columns.value, said, &found.desc, no_pairs);
        Ok(Ran::of(&found, printed::rm_anova(&found)).drawn(picture))
    }
}
