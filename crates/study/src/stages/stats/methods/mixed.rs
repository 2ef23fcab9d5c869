//! A linear model with a random intercept.

use crate::{
    error::StudyError,
    stages::stats::{
        columns::labels,
        pictures, printed,
        ran::Ran,
        rows::{DesignRows, FactorColumns},
        statistical_test::Test,
    },
    tables::Table,
};
use maveric_stats::{Formula, Predictor, RandomIntercept, random_intercept};

/// A linear model with a random intercept: coefficients, terms, marginal means; Satterthwaite's degrees of freedom
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: any number of rows a person, with subject, the predictors and the value. A predictor whose values are all numbers is a
covariate, any other a factor. Rows with a missing value are left out; the person's others stay.
Example: maveric stats mixed data.csv --subject id --fixed \"age*style + speed\" --value score")]
pub struct Mixed {
    /// Column that says whose row it is
    #[arg(long)]
    subject: String,
    /// Fixed effects: columns joined by +, : (their product) or * (both and their product)
    #[arg(long, value_parser = formula)]
    fixed: Formula,
    /// Column with the value
    #[arg(long)]
    value: String,
}

impl Test for Mixed {
    const NAME: &'static str = "mixed";

    fn value(&mut self) -> Option<&mut String> {
        Some(&mut self.value)
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let cells = self
            .fixed
            .predictors()
            .iter()
            .map(|name| Cells::read(table, name));
        let cells = cells.collect::<Result<Vec<_>, StudyError>>()?;
        let predictors: Vec<(&str, Predictor)> = self
            .fixed
            .predictors()
            .iter()
            .zip(&cells)
            .map(|(name, cells)| {
                let predictor = match cells {
                    Cells::Numbers(numbers) => Predictor::Covariate(numbers),
                    Cells::Labels(labels) => Predictor::Factor(labels),
                };
                (name.as_str(), predictor)
            })
            .collect();
        let people = labels(table, &self.subject)?;
        let found = random_intercept(
            &people,
            &self.fixed,
            &predictors,
            &table.numbers(&self.value)?,
        )?;
        let picture = pictures::mixed(self.shown(table, &found)?.as_ref(), &self.value, &found);
        Ok(Ran::of(&found, printed::mixed(&found)).drawn(picture))
    }
}

impl Mixed {
    /// The cells of the highest term of factors alone; none in a model of covariates.
    fn shown(
        &self,
        table: &Table,
        found: &RandomIntercept,
    ) -> Result<Option<DesignRows>, StudyError> {
        let Some((term, _)) = found.emm.iter().last() else {
            return Ok(None);
        };
        let columns = FactorColumns {
            subject: Some(self.subject.clone()),
            between: term.split(':').map(str::to_owned).collect(),
            value: self.value.clone(),
            ..FactorColumns::default()
        };
        DesignRows::read(table, &columns).map(Some)
    }
}

/// Cells of a predictor.
enum Cells {
    Numbers(Vec<Option<f64>>),
    Labels(Vec<Option<String>>),
}

impl Cells {
    fn read(table: &Table, name: &str) -> Result<Self, StudyError> {
        let cells = table.text(name)?;
        let is_number = |cell: &Option<String>| {
            cell.as_ref()
                .is_none_or(|cell| cell.trim().parse::<f64>().is_ok())
        };
        Ok(if cells.iter().all(is_number) {
            Self::Numbers(table.numbers(name)?)
        } else {
            Self::Labels(cells)
        })
    }
}

fn formula(text: &str) -> Result<Formula, String> {
    text.parse::<Formula>().map_err(|e| e.to_string())
}
