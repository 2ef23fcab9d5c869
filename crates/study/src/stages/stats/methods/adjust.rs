//! Adjusted p values.

use super::{Ran, StudyError, Table, Test, plain};
use maveric_stats::adjust;

/// Adjust p values for their number
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a test, with a column of p values.
Example: maveric stats adjust data.csv --p p")]
pub struct Adjust {
    /// Column of p values
    #[arg(long)]
    p: String,
}

impl Test for Adjust {
    const NAME: &'static str = "adjust";
    const HAS_FIGURE: bool = false;
    const HAS_SENTENCE: bool = false;

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        Ok(Ran::numbers(plain(&adjust(&table.all_numbers(&self.p)?)?)))
    }
}
