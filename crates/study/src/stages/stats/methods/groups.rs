//! Independent groups.

use super::{
    DesignRows, GroupColumns, Ran, StudyError, Table, Test, by_its_columns, labels, pictures,
    printed,
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

    by_its_columns!();

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let GroupColumns { group, value } = &self.columns;
        let result = groups(&labels(table, group)?, &table.numbers(value)?)?;
        let rows = DesignRows::one_factor(table, None, group, value)?;
        let picture = pictures::groups(&rows, value, &result, None);
        Ok(Ran::new(&result, printed::groups(&result)).drawn(picture))
    }
}
