//! A cumulative logit model.

use super::{
    DesignRows, Ran, StudyError, Table, Test, WithinColumns, by_its_columns, labels, pictures,
    printed,
};
use maveric_stats::ordinal;

/// Ordered answers: a cumulative logit model with a random intercept
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: any number of rows a person and condition, with subject, condition and the answer as a whole number.
Example: maveric stats ordinal data.csv --subject id --within condition --value answer")]
pub struct Ordinal {
    #[command(flatten)]
    columns: WithinColumns,
}

impl Test for Ordinal {
    const NAME: &'static str = "ordinal";

    by_its_columns!();

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let c = &self.columns;
        let (people, conditions) = (labels(table, &c.subject)?, labels(table, &c.within)?);
        let result = ordinal(&people, &conditions, &table.numbers(&c.value)?)?;
        let rows = DesignRows::one_factor(table, Some(&c.subject), &c.within, &c.value)?;
        let picture = pictures::ordinal(&rows, &c.value, &result, pictures::first(&result));
        Ok(Ran::new(&result, printed::ordinal(&result)).drawn(picture))
    }
}
