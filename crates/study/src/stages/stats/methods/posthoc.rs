//! Every pair of conditions.

use super::{
    ALPHA, Ran, StudyError, Table, Test, WithinColumns, by_its_columns,
    choices::{ADJUST, POSTHOC, one_of},
    pictures, printed,
};
use maveric_stats::{Adjustment, PosthocTest, posthoc, rm_anova};

/// Every pair of conditions, adjusted
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats posthoc data.csv --subject id --within condition --value score --test wilcoxon --adjust holm")]
pub struct Posthoc {
    #[command(flatten)]
    columns: WithinColumns,
    /// Test of a pair
    #[arg(long, value_parser = one_of(&POSTHOC), default_value = "t")]
    test: PosthocTest,
    /// Adjustment for the number of pairs
    #[arg(long, value_parser = one_of(&ADJUST), default_value = "holm")]
    adjust: Adjustment,
}

impl Test for Posthoc {
    const NAME: &'static str = "posthoc";

    by_its_columns!();

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let data = self.columns.read(table)?;
        let result = posthoc(&data, self.test, self.adjust, ALPHA)?;
        let desc = rm_anova(&data).desc;
        let picture = pictures::pairs(&data, &self.columns.value, &desc, &result);
        Ok(Ran::new(&result, printed::posthoc(&result)).drawn(picture))
    }
}
