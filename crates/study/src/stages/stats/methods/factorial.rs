//! Factors within and between subjects.

use super::{
    DesignRows, FactorColumns, Ran, Roles, StudyError, Table, Test, by_its_columns,
    choices::{FACTORIAL, FactorialMethod, one_of},
    pictures, printed,
};
use maveric_stats::{aligned_ranks, factorial};
use serde_json::json;

/// Up to two factors within subjects and two between: F, corrected; means, contrasts, simple effects; or aligned ranks
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a cell, with subject, the factors and the value; without --within a row a person.
Examples: maveric stats factorial data.csv --subject id --within style,load --between vehicle --value score
          maveric stats factorial data.csv --between vehicle,age --value score --method art")]
pub struct Factorial {
    #[command(flatten)]
    columns: FactorColumns,
    /// Analysis of variance; or aligned ranks, for comparing with other programs: on skewed values they find too much (a warning says how much)
    #[arg(long, value_parser = one_of(&FACTORIAL), default_value = "anova")]
    method: FactorialMethod,
}

impl Test for Factorial {
    const NAME: &'static str = "factorial";

    by_its_columns!();

    fn lacks(&self) -> Option<&'static str> {
        self.columns.lacks()
    }

    fn roles(&self) -> Roles {
        self.columns.roles()
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let rows = DesignRows::read(table, &self.columns)?;
        let design = rows.design()?;
        let value = &self.columns.value;
        Ok(match self.method {
            FactorialMethod::Anova => {
                let result = factorial(&design);
                let picture = pictures::factorial(&rows, value, &result);
                Ran::new(&result, printed::factorial(&result)).drawn(picture)
            }
            FactorialMethod::Art => {
                let result = aligned_ranks(&design);
                let picture = pictures::aligned(&rows, value, &result);
                let mut ran = Ran::new(&result, printed::aligned(&result)).drawn(picture);
                // Kept in the JSON, and told on stderr.
                ran.value["reasons"] = json!([ALIGNED]);
                ran.value["warnings"] = json!([ALIGNED]);
                ran
            }
        })
    }
}

/// What aligned ranks are not for: the rates of the table in the README of the statistics.
const ALIGNED: &str = "aligned ranks are for comparing with other programs: of effects that are nil they find .09 to .14 where values are skewed and up to .36 \
                       where people differ in an effect besides, and .05 are promised; `maveric stats compare` chooses tests that keep it";
