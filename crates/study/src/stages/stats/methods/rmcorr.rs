//! Correlation within subjects.

use super::{Ran, Role, Roles, StudyError, Table, Test, labels, pictures, printed};
use maveric_stats::rm_correlation;

/// Repeated-measures correlation: several rows a subject
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: several rows a person, with the column of subjects and two of numbers.
Example: maveric stats rmcorr data.csv --subject id --x age --y speed")]
pub struct Rmcorr {
    /// Column that says whose row it is
    #[arg(long)]
    subject: String,
    /// First column
    #[arg(long)]
    x: String,
    /// Second column
    #[arg(long)]
    y: String,
}

impl Test for Rmcorr {
    const NAME: &'static str = "rmcorr";

    fn roles(&self) -> Roles {
        let roles = Roles::default().and(Role::Subject, [&self.subject]);
        roles.and(Role::Number, [&self.x, &self.y])
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let (x, y) = (&self.x, &self.y);
        let subjects = labels(table, &self.subject)?;
        let (of_x, of_y) = (table.numbers(x)?, table.numbers(y)?);
        let result = rm_correlation(&subjects, &of_x, &of_y)?;
        let (slope, sentence) = (result.rm_corr.slope, pictures::first(&result));
        let picture = pictures::within_people(&subjects, (x, &of_x), (y, &of_y), slope, sentence);
        Ok(Ran::new(&result, printed::rm_correlation(&result, x, y)).drawn(picture))
    }
}
