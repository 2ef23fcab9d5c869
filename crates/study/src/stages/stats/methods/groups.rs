//! Independent groups.

use crate::{
    error::StudyError,
    stages::stats::{
        columns::{GroupColumns, labels},
        input::Long,
        pictures, printed,
        ran::Ran,
        rows::DesignRows,
        statistical_test::Test,
    },
    tables::Table,
};
use maveric_stats::groups;

/// Independent groups: each pair, and all of them at once
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a person, with the group and the value.
Example: maveric stats groups data.csv --between vehicle --value score")]
pub struct Groups {
    #[command(flatten)]
    columns: GroupColumns,
}

impl Test for Groups {
    const NAME: &'static str = "groups";

    fn long(&self) -> Option<Long<'_>> {
        Some(self.columns.long())
    }

    fn value(&mut self) -> Option<&mut String> {
        Some(&mut self.columns.value)
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let GroupColumns { group, value } = &self.columns;
        let result = groups(&labels(table, group)?, &table.numbers(value)?)?;
        let rows = DesignRows::one_factor(table, None, group, value)?;
        let picture = pictures::groups(&rows, value, &result, None);
        Ok(Ran::new(&result, printed::groups(&result)).drawn(picture))
    }
}
