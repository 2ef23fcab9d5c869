//! Independent groups.

use crate::{
    error::StudyError,
    stages::stats::{
        columns::labels, input::Long, pictures, printed, ran::Ran, rows::DesignRows,
        statistical_test::Test,
    },
    tables::Table,
};
use maveric_stats::groups;

/// Independent groups: each pair, and all of them at once
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a person, with the group and the value.
Example: maveric stats groups data.csv --group vehicle --value score")]
pub struct Groups {
    /// Column that groups the rows
    #[arg(long)]
    group: String,
    /// Column with the value
    #[arg(long)]
    value: String,
}

impl Test for Groups {
    const NAME: &'static str = "groups";

    fn long(&self) -> Option<Long<'_>> {
        Some(Long::groups(&self.group, &self.value))
    }

    fn value(&mut self) -> Option<&mut String> {
        Some(&mut self.value)
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let found = groups(&labels(table, &self.group)?, &table.numbers(&self.value)?)?;
        let rows = DesignRows::one_factor(table, None, &self.group, &self.value)?;
        let picture = pictures::groups(&rows, &self.value, &found, None);
        Ok(Ran::of(&found, printed::groups(&found)).drawn(picture))
    }
}
