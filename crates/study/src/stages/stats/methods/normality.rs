//! Shapiro-Wilk and moments.

use super::{Long, Ran, StudyError, Table, Test, grouped, plain};
use maveric_stats::{apa::Statements as _, normality};
use serde_json::{Map, json};

/// Shapiro-Wilk and the moments of a column
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a value, with a column of numbers, and of groups if there are any.
Example: maveric stats normality data.csv --value score --within condition")]
pub struct Normality {
    /// Column with the value
    #[arg(long)]
    value: String,
    /// Column that groups the rows: people or conditions
    #[arg(long, visible_aliases = ["between", "within"])]
    group: Option<String>,
}

impl Test for Normality {
    const NAME: &'static str = "normality";
    const HAS_FIGURE: bool = false;

    fn long(&self) -> Option<Long<'_>> {
        let of_group = |group| Long::groups(group, &self.value);
        self.group.as_deref().map(of_group)
    }

    fn value(&mut self) -> Option<&mut String> {
        Some(&mut self.value)
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let Some(group) = &self.group else {
            return Ok(Ran::plainly(&normality(&table.numbers(&self.value)?)?));
        };
        let (mut groups, mut statements) = (Map::new(), Vec::new());
        for (name, values) in grouped(table, group, &self.value)? {
            let result = normality(&values)?;
            let sentences = result.statements().into_iter();
            statements.extend(sentences.map(|(_, s)| (name.clone(), s)));
            groups.insert(name, plain(&result));
        }
        Ok(Ran { statements, ..Ran::numbers(json!({ "group": groups })) })
    }
}
