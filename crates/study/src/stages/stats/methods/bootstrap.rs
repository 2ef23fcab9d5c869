//! Resampling intervals.

use super::{
    ALPHA, Conditions, Long, Ran, StudyError, Table, Test,
    choices::{STATISTIC, one_of},
};
use maveric_stats::{BootstrapData, BootstrapSettings, Statistic, bootstrap};

/// Percentile and BCa intervals by resampling
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a column of values; two of a correlation; or, as for `within`, a row a cell.
Examples: maveric stats bootstrap data.csv --statistic median --value score --resamples 2000 --seed 3
          maveric stats bootstrap data.csv --statistic eta2_partial --subject id --within condition --value score")]
pub struct Bootstrap {
    /// What to estimate
    #[arg(long, value_parser = one_of(&STATISTIC))]
    statistic: Statistic,
    /// First column of a correlation
    #[arg(long)]
    x: Option<String>,
    /// Second column of a correlation
    #[arg(long)]
    y: Option<String>,
    #[command(flatten)]
    conditions: Conditions,
    /// Resamples
    #[arg(long, default_value_t = 10_000)]
    resamples: usize,
    /// Root of the random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Test for Bootstrap {
    const NAME: &'static str = "bootstrap";
    const HAS_FIGURE: bool = false;

    fn lacks(&self) -> Option<&'static str> {
        if let Some(lacking) = self.conditions.lacks() {
            return Some(lacking);
        }
        match self.statistic {
            Statistic::Mean | Statistic::Median => {
                self.conditions.value.is_none().then_some("--value")
            }
            Statistic::Pearson | Statistic::Spearman => {
                self.x.as_ref().zip(self.y.as_ref()).is_none().then_some("--x and --y")
            }
            _ => self.long().is_none().then_some("--subject, --within and --value"),
        }
    }

    fn long(&self) -> Option<Long<'_>> {
        match self.statistic {
            Statistic::Mean | Statistic::Median | Statistic::Pearson | Statistic::Spearman => None,
            _ => self.conditions.long(),
        }
    }

    fn value(&mut self) -> Option<&mut String> {
        match self.statistic {
            Statistic::Pearson | Statistic::Spearman => None,
            _ => self.conditions.value.as_mut(),
        }
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let settings = BootstrapSettings {
            resamples: self.resamples,
            seed: self.seed,
            confidence: 1.0 - ALPHA,
        };
        if let Some(columns) = self.long() {
            let data = columns.read(table)?;
            let result = bootstrap(self.statistic, BootstrapData::Within(&data), &settings)?;
            return Ok(Ran::plainly(&result));
        }
        if let (Statistic::Pearson | Statistic::Spearman, Some(x), Some(y)) =
            (self.statistic, &self.x, &self.y)
        {
            let (x, y) = (table.numbers(x)?, table.numbers(y)?);
            let result = bootstrap(self.statistic, BootstrapData::Pairs(&x, &y), &settings)?;
            return Ok(Ran::plainly(&result));
        }
        let values = self.conditions.sample(table)?;
        let result = bootstrap(self.statistic, BootstrapData::Values(&values), &settings)?;
        Ok(Ran::plainly(&result))
    }
}
