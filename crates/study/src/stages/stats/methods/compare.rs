//! The test that a design calls for.

use super::{
    ALPHA, DesignRows, FactorColumns, Ran, Role, Roles, StudyError, Table, Test, WithinColumns,
    by_its_columns,
    choices::{MISSING, one_of},
    pictures, plain, printed,
};
use maveric_stats::{
    ByDesign, DesignChoice, MissingCells, OutcomeScale, compare_by_design, follow_up,
};

/// The test that the design calls for: check the assumptions, choose, compare the pairs; say why
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
The table: a row a cell, with subject, the factors and the value; a column a condition, by --wide; without --within a row a person.
Examples: maveric stats compare data.csv --subject id --within condition --value score --figure score.svg
          maveric stats compare data.csv --subject id --within condition --value score,speed --apa
          maveric stats compare data.csv --subject id --within style --between vehicle --value score
          maveric stats compare data.csv --subject id --within condition --covariate age --value score
          maveric stats compare data.csv --subject id --within condition --value answer --ordinal
          maveric stats compare data.csv --subject id --within condition --value score --missing mixed")]
pub struct Compare {
    #[command(flatten)]
    columns: FactorColumns,
    /// Columns of numbers whose influence is taken out
    #[arg(long, value_delimiter = ',')]
    covariate: Vec<String>,
    /// Products that are tested: age:style tests whether the effect of style within subjects changes with age, a:b where it is an
    /// interaction (age:a:b)
    #[arg(long, value_delimiter = ',', requires = "covariate", value_parser = product)]
    with: Vec<(String, String)>,
    /// The values are ordered answers: of one factor only their order counts; of several, or with a covariate, ranks are of each
    /// person's means and differences of the answers' numbers
    #[arg(long)]
    ordinal: bool,
    /// What becomes of a person without every cell
    #[arg(long, value_parser = one_of(&MISSING), default_value = "listwise")]
    missing: MissingCells,
}

impl Test for Compare {
    const NAME: &'static str = "compare";

    by_its_columns!();

    fn lacks(&self) -> Option<&'static str> {
        self.columns.lacks()
    }

    fn roles(&self) -> Roles {
        self.columns.roles().and(Role::Covariate, &self.covariate)
    }

    fn run(&self, table: &Table) -> Result<Ran, StudyError> {
        let columns = FactorColumns {
            covariates: self.covariate.clone(),
            products: self.with.clone(),
            ..self.columns.clone()
        };
        let rows = DesignRows::read(table, &columns)?;
        let choice = DesignChoice {
            scale: if self.ordinal { OutcomeScale::Ordinal } else { OutcomeScale::Measure },
            missing: self.missing,
            alpha: ALPHA,
            ..DesignChoice::default()
        };
        let result = compare_by_design(&rows.columns(), &choice)?;
        let after = match &result {
            ByDesign::Factorial(chosen) => Some(follow_up(&rows.columns(), chosen)?),
            _ => None,
        };
        let picture = match (&result, &columns.subject) {
            (ByDesign::OneFactor(one_factor), Some(subject)) => {
                let c = WithinColumns {
                    subject: subject.clone(),
                    within: columns.within.concat(),
                    value: columns.value.clone(),
                };
                let data = c.read(table)?;
                let p = one_factor.posthoc.pairs.values().map(|pair| pair.p_adjusted);
                pictures::conditions(
                    &data,
                    &c.value,
                    pictures::first(&**one_factor),
                    &one_factor.desc,
                    p,
                )
            }
            _ => pictures::by_design(&rows, &columns.value, &result, after.as_ref()),
        };
        let printed = printed::by_design(&result, after.as_ref());
        let mut ran = Ran::new(&result, printed).drawn(picture);
        if let Some(after) = &after {
            ran.value["follow_up"] = plain(after);
        }
        Ok(ran)
    }
}

/// A covariate and the effect that it is multiplied by.
fn product(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once(':');
    let parts = parts.filter(|(covariate, effect)| !covariate.is_empty() && !effect.is_empty());
    parts
        .map(|(covariate, effect)| (covariate.to_owned(), effect.to_owned()))
        .ok_or_else(|| "expected a covariate and an effect, as in age:style".to_owned())
}
