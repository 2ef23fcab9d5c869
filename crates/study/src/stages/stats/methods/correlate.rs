//! Correlation of two columns.

use super::{
    Ran, Role, Roles, StudyError, Table, Test,
    choices::{CORRELATION, one_of},
    labels, pictures, printed,
};
use maveric_stats::{CorrelationMethod, correlate};

/// Correlation of two columns
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a person (or a measurement), with two columns of numbers.
Example: maveric stats correlate data.csv --x age --y speed --method auto --figure speed.svg")]
pub struct Correlate {
    /// First column
    #[arg(long)]
    x: String,
    /// Second column
    #[arg(long)]
    y: String,
    /// Which coefficient
    #[arg(long, value_parser = one_of(&CORRELATION), default_value = "auto")]
    method: CorrelationMethod,
    /// Column that says whose row it is: warns where one subject has several rows
    #[arg(long)]
    subject: Option<String>,
}

impl Test for Correlate {
    const NAME: &'static str = "correlate";

    fn roles(&self) -> Roles {
        let roles = Roles::default().and(Role::Subject, &self.subject);
        roles.and(Role::Number, [&self.x, &self.y])
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let (x, y) = (&self.x, &self.y);
        let subjects = self.subject.as_ref().map(|s| labels(table, s)).transpose()?;
        let (of_x, of_y) = (table.numbers(x)?, table.numbers(y)?);
        let result = correlate(&of_x, &of_y, self.method, subjects.as_deref())?;
        let picture = pictures::correlation((x, &of_x), (y, &of_y), pictures::first(&result));
        Ok(Ran::new(&result, printed::correlation(&result, x, y)).drawn(picture))
    }
}
