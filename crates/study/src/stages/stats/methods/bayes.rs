//! Bayes factors.

use super::{
    Conditions, DesignRows, Long, Ran, StudyError, Table, Test, labels, pictures, printed,
};
use maveric_stats::{bayes_correlation, bayes_groups, bayes_one, bayes_paired};

/// Bayes factors of t tests and correlations
#[derive(Debug, Clone, clap::Args)]
#[command(
    group = clap::ArgGroup::new("design").args(["subject", "mu", "group", "x"]),
    after_help = "\
The table: a row a cell with subject, condition and value; or a column a condition, by --wide; or a row a person with the value, with
group and value, or with two values.
Examples: maveric stats bayes data.csv --subject id --within condition --value score
          maveric stats bayes data.csv --between vehicle --value score
          maveric stats bayes data.csv --value score --mu=3
          maveric stats bayes data.csv --x age --y speed")]
pub struct Bayes {
    #[command(flatten)]
    conditions: Conditions,
    /// What the mean of one sample is compared with
    #[arg(long, requires = "value", conflicts_with = "wide", allow_hyphen_values = true)]
    mu: Option<f64>,
    /// Column that groups the rows
    #[arg(long, visible_alias = "between", requires = "value")]
    group: Option<String>,
    /// First column of a correlation
    #[arg(long, requires = "y", conflicts_with_all = ["value", "wide"])]
    x: Option<String>,
    /// Second column of a correlation
    #[arg(long, requires = "x")]
    y: Option<String>,
}

impl Test for Bayes {
    const NAME: &'static str = "bayes";

    fn lacks(&self) -> Option<&'static str> {
        if let Some(lacking) = self.conditions.lacks() {
            return Some(lacking);
        }
        let complete = self.x.is_some() || self.mu.is_some() || self.long().is_some();
        (!complete)
            .then_some("--value with --subject and --within, --between or --mu; or --x and --y")
    }

    fn long(&self) -> Option<Long<'_>> {
        let value = self.conditions.value.as_deref()?;
        // A group is named where groups are meant, whatever --wide has conditions become.
        match self.group.as_deref() {
            Some(group) => Some(Long::groups(group, value)),
            None => self.conditions.long(),
        }
    }

    fn value(&mut self) -> Option<&mut String> {
        self.conditions.value.as_mut()
    }

    fn has_figure(&self) -> bool {
        self.x.is_some() || self.long().is_some()
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        if let (Some(x), Some(y)) = (&self.x, &self.y) {
            let (of_x, of_y) = (table.numbers(x)?, table.numbers(y)?);
            let result = bayes_correlation(&of_x, &of_y)?;
            let sentence = pictures::first(&result);
            let picture = pictures::correlation((x, &of_x), (y, &of_y), sentence);
            let printed = printed::bayes_correlation(&result, x, y);
            return Ok(Ran::new(&result, printed).drawn(picture));
        }
        let Some(columns) = self.long() else {
            let values = self.conditions.sample(table)?;
            let result = bayes_one(&values, self.mu.unwrap_or_default())?;
            return Ok(Ran::new(&result, printed::bayes(&result)));
        };
        let (subject, factor, value) = (columns.subject, columns.within, columns.value);
        let result = match subject {
            Some(_) => bayes_paired(&columns.read(table)?),
            None => bayes_groups(&labels(table, factor)?, &table.numbers(value)?)?,
        };
        let rows = DesignRows::one_factor(table, subject, factor, value)?;
        // The factor of one pair among several is none of the whole picture.
        let title = match result.bayes_t.len() {
            1 => pictures::first(&result),
            _ => String::new(),
        };
        let picture = pictures::plain_cells(&rows, value, title);
        Ok(Ran::new(&result, printed::bayes(&result)).drawn(picture))
    }
}
