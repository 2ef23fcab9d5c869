//! Cronbach's alpha.

use super::{Ran, StudyError, Table, Test, labels};
use maveric_stats::alpha;

/// Cronbach's alpha of a scale
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row an answer sheet, with a column an item, reversed items turned already; and a column of people where they filled in several.
Examples: maveric stats alpha data.csv --items q1,q2,q3
          maveric stats alpha data.csv --items q1,q2,q3 --subject id")]
pub struct Alpha {
    /// Columns of the items
    #[arg(long, value_delimiter = ',', required = true)]
    items: Vec<String>,
    /// Column that says whose sheet it is, where people answered several: the interval then draws whole people
    #[arg(long)]
    subject: Option<String>,
}

impl Test for Alpha {
    const NAME: &'static str = "alpha";
    const HAS_FIGURE: bool = false;

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let answers = self.items.iter();
        let answers = answers.map(|item| Ok((item.as_str(), table.numbers(item)?)));
        let answers = answers.collect::<Result<Vec<_>, StudyError>>()?;
        let items: Vec<(&str, &[Option<f64>])> =
            answers.iter().map(|(n, c)| (*n, &c[..])).collect();
        let people = self.subject.as_ref().map(|s| labels(table, s)).transpose()?;
        Ok(Ran::plainly(&alpha(&items, people.as_deref())?))
    }
}
