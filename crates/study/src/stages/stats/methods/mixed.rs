//! A linear model with a random intercept.

use super::{
    DesignRows, FactorColumns, Ran, Role, Roles, StudyError, Table, Test, labels, pictures, printed,
};
use maveric_stats::{Formula, Predictor, RandomIntercept, random_intercept};
use serde_json::json;

/// A linear model with a random intercept: coefficients, terms, marginal means; Satterthwaite's degrees of freedom
#[derive(Debug, Clone, clap::Args)]
#[command(
    group = clap::ArgGroup::new("terms").required(true).multiple(true).args(["fixed", "within", "between", "covariate"]),
    after_help = "\
The table: any number of rows a person, with subject, the predictors and the value. Rows with a missing value are left out; the person's
others stay. In --fixed a predictor whose values are all numbers is a covariate, any other a factor. Terms, means and pairs are at the mean
of the covariates, coefficients at 0.
Examples: maveric stats mixed data.csv --subject id --within style --between vehicle --covariate age --value score
          maveric stats mixed data.csv --subject id --fixed \"age*style + speed\" --value score")]
pub struct Mixed {
    /// Column that says whose row it is
    #[arg(long)]
    subject: String,
    /// Fixed effects: columns joined by +, : (their product) or * (both and their product)
    #[arg(long, value_parser = formula, conflicts_with_all = ["within", "between", "covariate"])]
    fixed: Option<Formula>,
    /// Columns of the factors within subjects; factors go in with all their products
    #[arg(long, value_delimiter = ',')]
    within: Vec<String>,
    /// Columns of the factors between subjects
    #[arg(long, value_delimiter = ',')]
    between: Vec<String>,
    /// Columns of numbers whose influence is taken out
    #[arg(long, value_delimiter = ',')]
    covariate: Vec<String>,
    /// Column with the value; several, as in score,speed, are analysed one by one
    #[arg(long)]
    value: String,
}

impl Test for Mixed {
    const NAME: &'static str = "mixed";

    fn value(&mut self) -> Option<&mut String> {
        Some(&mut self.value)
    }

    fn roles(&self) -> Roles {
        let fixed = self.fixed.iter().flat_map(maveric_stats::Formula::predictors);
        Roles::default()
            .and(Role::Subject, [&self.subject])
            .and(Role::Between, &self.between)
            .and(Role::Within, &self.within)
            .and(Role::Covariate, &self.covariate)
            .and(Role::Predictor, fixed)
            .and(Role::Number, [&self.value])
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let formula = self.formula()?;
        let cells = formula.predictors().iter().map(|n| self.cells(table, n));
        let cells = cells.collect::<Result<Vec<_>, StudyError>>()?;
        let predictors = formula.predictors().iter().zip(&cells);
        let numbers = predictors.clone();
        let numbers = numbers.filter(|(_, cells)| matches!(cells, Cells::Numbers(_)));
        let covariates = numbers.map(|(name, _)| name.clone()).collect();
        let predictors: Vec<(&str, Predictor)> = predictors
            .map(|(name, cells)| {
                let predictor = match cells {
                    Cells::Numbers(numbers) => Predictor::Covariate(numbers),
                    Cells::Labels(labels) => Predictor::Factor(labels),
                };
                (name.as_str(), predictor)
            })
            .collect();
        let people = labels(table, &self.subject)?;
        let model = random_intercept(&people, &formula, &predictors, &table.numbers(&self.value)?)?;
        let shown = self.shown(table, &model, covariates)?;
        let picture = pictures::mixed(shown.as_ref(), &self.value, &model);
        let roles = self.roles().found(table)?;
        let printed = printed::mixed(&model).also(roles.line());
        let mut ran = Ran::new(&model, printed).drawn(picture);
        ran.value["roles"] = roles.value();
        ran.value["warnings"] = json!(roles.warnings);
        Ok(ran)
    }
}

impl Mixed {
    /// The formula that was given, or that of the factors with all their products, and the covariates.
    fn formula(&self) -> Result<Formula, StudyError> {
        if let Some(formula) = &self.fixed {
            return Ok(formula.clone());
        }
        let factors = [&self.between[..], &self.within[..]].concat().join("*");
        let covariates = self.covariate.iter().cloned();
        let terms: Vec<String> = [factors].into_iter().chain(covariates).collect();
        let terms = terms.into_iter().filter(|term| !term.is_empty());
        let text = terms.collect::<Vec<_>>().join(" + ");
        formula(&text).map_err(|problem| {
            let help = "columns whose names have +, : or * in them need other names";
            StudyError::not_possible(problem).with_help(help)
        })
    }

    /// The cells of a predictor: of a factor by its flag labels, of a covariate by its flag numbers, of a formula what they are.
    fn cells(&self, table: &Table, name: &str) -> Result<Cells, StudyError> {
        if self.covariate.iter().any(|c| c == name) {
            return Ok(Cells::Numbers(table.numbers(name)?));
        }
        match self.fixed {
            Some(_) => Cells::read(table, name),
            None => Ok(Cells::Labels(table.text(name)?)),
        }
    }

    /// The cells of the highest term of factors alone; none in a model of covariates.
    fn shown(
        &self,
        table: &Table,
        model: &RandomIntercept,
        covariates: Vec<String>,
    ) -> Result<Option<DesignRows>, StudyError> {
        let Some((term, _)) = model.emm.iter().last() else {
            return Ok(None);
        };
        let columns = FactorColumns {
            subject: Some(self.subject.clone()),
            between: term.split(':').map(str::to_owned).collect(),
            covariates,
            value: self.value.clone(),
            ..FactorColumns::default()
        };
        DesignRows::read(table, &columns).map(Some)
    }
}

enum Cells {
    Numbers(Vec<Option<f64>>),
    Labels(Vec<Option<String>>),
}

impl Cells {
    fn read(table: &Table, name: &str) -> Result<Self, StudyError> {
        let cells = table.text(name)?;
        let is_number =
            |cell: &Option<String>| cell.as_ref().is_none_or(|cell| table.is_number(cell));
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
