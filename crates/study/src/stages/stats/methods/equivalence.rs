//! Whether a difference is smaller than bounds.

use super::{Conditions, Long, Ran, StudyError, Table, Test, pictures, printed};
use maveric_stats::{Bounds, equivalence, equivalence_one};

/// Is the difference of conditions, or of a mean from a value, smaller than bounds? Two one-sided tests
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide; for one sample a column with the value.
Examples: maveric stats equivalence data.csv --subject id --within condition --value score --bounds=-0.5,0.5
          maveric stats equivalence data.csv --value score --mu=3 --bounds=-0.3,0.3 --standardized")]
pub struct Equivalence {
    #[command(flatten)]
    conditions: Conditions,
    /// What the mean of one sample is compared with
    #[arg(
        long,
        conflicts_with_all = ["subject", "within", "wide"],
        required_unless_present_any = ["subject", "within", "wide"],
        allow_hyphen_values = true
    )]
    mu: Option<f64>,
    /// Differences that count as none: LOW,HIGH
    #[arg(long, value_name = "LOW,HIGH", value_parser = two_numbers, allow_hyphen_values = true)]
    bounds: (f64, f64),
    /// The bounds are in standard deviations of the differences
    #[arg(long)]
    standardized: bool,
}

impl Test for Equivalence {
    const NAME: &'static str = "equivalence";

    fn lacks(&self) -> Option<&'static str> {
        if let Some(lacking) = self.conditions.lacks() {
            return Some(lacking);
        }
        let value = self.conditions.value.is_some();
        let complete = value && (self.long().is_some() || self.mu.is_some());
        (!complete).then_some("--value with --subject and --within, or with --mu")
    }

    fn long(&self) -> Option<Long<'_>> {
        self.conditions.long()
    }

    fn value(&mut self) -> Option<&mut String> {
        self.conditions.value.as_mut()
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let (low, high) = self.bounds;
        let bounds = if self.standardized {
            Bounds::Standardized { low, high }
        } else {
            Bounds::Raw { low, high }
        };
        let result = if let Some(columns) = self.long() {
            equivalence(&columns.read(table)?, bounds)?
        } else {
            let mu = self.mu.unwrap_or_default();
            equivalence_one(&self.conditions.sample(table)?, mu, bounds)?
        };
        let value = self.conditions.value.as_deref().unwrap_or_default();
        let picture = pictures::equivalence(value, &result);
        Ok(Ran::new(&result, printed::equivalence(&result)).drawn(picture))
    }
}

fn two_numbers(text: &str) -> Result<(f64, f64), String> {
    let numbers = text.split_once(',').map(|(low, high)| {
        let number = |part: &str| part.trim().parse::<f64>().ok();
        number(low).zip(number(high))
    });
    numbers.flatten().ok_or_else(|| "expected two numbers, as in -0.5,0.5".to_owned())
}
