//! Equal variances.

use super::{GroupColumns, Ran, StudyError, Table, Test, by_its_columns, labels};
use maveric_stats::levene;

/// Equal variances: Levene, Brown-Forsythe, Bartlett
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a person, with the columns of group and value.
Example: maveric stats levene data.csv --between group --value score")]
pub struct Levene {
    #[command(flatten)]
    columns: GroupColumns,
}

impl Test for Levene {
    const NAME: &'static str = "levene";
    const HAS_FIGURE: bool = false;

    by_its_columns!();

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let GroupColumns { group, value } = &self.columns;
        let groups = labels(table, group)?;
        Ok(Ran::plainly(&levene(&groups, &table.numbers(value)?)?))
    }
}
