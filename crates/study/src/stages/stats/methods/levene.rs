//! Equal variances.

use crate::{
    error::StudyError,
    stages::stats::{columns::labels, input::Long, ran::Ran, statistical_test::Test},
    tables::Table,
};
use maveric_stats::levene;

/// Equal variances: Levene, Brown-Forsythe, Bartlett
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a person, with the columns of group and value.
Example: maveric stats levene data.csv --group group --value score")]
pub struct Levene {
    /// Column that groups the rows
    #[arg(long)]
    group: String,
    /// Column with the value
    #[arg(long)]
    value: String,
}

impl Test for Levene {
    const NAME: &'static str = "levene";

    fn long(&self) -> Option<Long<'_>> {
        Some(Long::groups(&self.group, &self.value))
    }

    fn value(&mut self) -> Option<&mut String> {
        Some(&mut self.value)
    }

    fn has_figure(&self) -> bool {
        false
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let groups = labels(table, &self.group)?;
        Ok(Ran::plainly(&levene(
            &groups,
            &table.numbers(&self.value)?,
        )?))
    }
}
