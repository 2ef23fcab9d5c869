//! `maveric stats` of groups, factors, bounds and models.

use super::{
    choices::{FACTORIAL, MISSING, one_of},
    table::{Conditions, Factors, Input, Within, needs},
};
use crate::diagnostics::Failure;
use clap::Subcommand;
use maveric_study::stages::stats::{Bounds, FactorialMethod, Formula, MissingCells, Test};

#[derive(Debug, Subcommand)]
pub(super) enum DesignArgs {
    /// The test that the design calls for: check the assumptions, choose, compare the pairs; say why
    #[command(after_help = "\
The table: a row a cell, with subject, the factors and the value; a column a condition, by --wide; without --within a row a person.
Examples: maveric stats compare data.csv --subject id --within condition --value score --figure score.svg
          maveric stats compare data.csv --subject id --within condition --value score,speed --apa
          maveric stats compare data.csv --subject id --within style --between vehicle --value score
          maveric stats compare data.csv --subject id --within condition --covariate age --value score
          maveric stats compare data.csv --subject id --within condition --value answer --ordinal
          maveric stats compare data.csv --subject id --within condition --value score --missing mixed")]
    Compare {
        #[command(flatten)]
        factors: Factors,
        /// Columns of numbers whose influence is taken out
        #[arg(long, value_delimiter = ',')]
        covariate: Vec<String>,
        /// Products that are tested: age:style tests whether the effect of style within subjects changes with age, a:b where it is an
        /// interaction (age:a:b)
        #[arg(long, value_delimiter = ',', requires = "covariate", value_parser = product)]
        with: Vec<(String, String)>,
        /// The values are ordered answers: only their order counts
        #[arg(long)]
        ordinal: bool,
        /// What becomes of a person without every cell
        #[arg(long, value_parser = one_of(&MISSING), default_value = "listwise")]
        missing: MissingCells,
    },
    /// Up to two factors within subjects and two between: F, corrected; means, contrasts, simple effects; or aligned ranks
    #[command(after_help = "\
The table: a row a cell, with subject, the factors and the value; without --within a row a person.
Examples: maveric stats factorial data.csv --subject id --within style,load --between vehicle --value score
          maveric stats factorial data.csv --between vehicle,age --value score --method art")]
    Factorial {
        #[command(flatten)]
        factors: Factors,
        /// Analysis of variance; or aligned ranks, for comparing with other programs: on skewed values they find too much (a warning says how much)
        #[arg(long, value_parser = one_of(&FACTORIAL), default_value = "anova")]
        method: FactorialMethod,
    },
    /// A linear model with a random intercept: coefficients, terms, marginal means; Satterthwaite's degrees of freedom
    #[command(after_help = "\
The table: any number of rows a person, with subject, the predictors and the value. A predictor whose values are all numbers is a
covariate, any other a factor. Rows with a missing value are left out; the person's others stay.
Example: maveric stats mixed data.csv --subject id --fixed \"age*style + speed\" --value score")]
    Mixed {
        #[command(flatten)]
        input: Input,
        /// Column that says whose row it is
        #[arg(long)]
        subject: String,
        /// Fixed effects: columns joined by +, : (their product) or * (both and their product)
        #[arg(long, value_parser = formula)]
        fixed: Formula,
        /// Column with the value
        #[arg(long)]
        value: String,
    },
    /// Ordered answers: a cumulative logit model with a random intercept
    #[command(after_help = "\
The table: any number of rows a person and condition, with subject, condition and the answer as a whole number.
Example: maveric stats ordinal data.csv --subject id --within condition --value answer")]
    Ordinal(Within),
    /// Independent groups: each pair, and all of them at once
    #[command(after_help = "\
The table: a row a person, with the group and the value.
Example: maveric stats groups data.csv --group vehicle --value score")]
    Groups {
        #[command(flatten)]
        input: Input,
        /// Column that groups the rows
        #[arg(long)]
        group: String,
        /// Column with the value
        #[arg(long)]
        value: String,
    },
    /// Is the difference of conditions, or of a mean from a value, smaller than bounds? Two one-sided tests
    #[command(after_help = "\
The table: a row a cell, with subject, condition and value; for one sample a column with the value.
Examples: maveric stats equivalence data.csv --subject id --within condition --value score --bounds=-0.5,0.5
          maveric stats equivalence data.csv --value score --mu=3 --bounds=-0.3,0.3 --standardized")]
    Equivalence {
        #[command(flatten)]
        input: Input,
        #[command(flatten)]
        conditions: Conditions,
        /// Column with the value
        #[arg(long)]
        value: String,
        /// What the mean of one sample is compared with
        #[arg(
            long,
            conflicts_with = "subject",
            required_unless_present = "subject",
            allow_hyphen_values = true
        )]
        mu: Option<f64>,
        /// Differences that count as none: LOW,HIGH
        #[arg(long, value_name = "LOW,HIGH", value_parser = two_numbers, allow_hyphen_values = true)]
        bounds: (f64, f64),
        /// The bounds are in standard deviations of the differences
        #[arg(long)]
        standardized: bool,
    },
    /// Bayes factors of t tests and correlations
    #[command(
        group = clap::ArgGroup::new("design").required(true).args(["subject", "mu", "group", "x"]),
        after_help = "\
The table: a row a cell with subject, condition and value; or a row a person with the value, with group and value, or with two values.
Examples: maveric stats bayes data.csv --subject id --within condition --value score
          maveric stats bayes data.csv --group vehicle --value score
          maveric stats bayes data.csv --value score --mu=3
          maveric stats bayes data.csv --x age --y speed"
    )]
    Bayes {
        #[command(flatten)]
        input: Input,
        #[command(flatten)]
        conditions: Conditions,
        /// Column with the value
        #[arg(long, conflicts_with = "x", required_unless_present = "x")]
        value: Option<String>,
        /// What the mean of one sample is compared with
        #[arg(long, requires = "value", allow_hyphen_values = true)]
        mu: Option<f64>,
        /// Column that groups the rows
        #[arg(long, requires = "value")]
        group: Option<String>,
        /// First column of a correlation
        #[arg(long, requires = "y")]
        x: Option<String>,
        /// Second column of a correlation
        #[arg(long, requires = "x")]
        y: Option<String>,
    },
}

fn formula(text: &str) -> Result<Formula, String> {
    text.parse::<Formula>().map_err(|e| e.to_string())
}

/// A covariate and the effect that it is multiplied by.
fn product(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once(':');
    let parts = parts.filter(|(covariate, effect)| !covariate.is_empty() && !effect.is_empty());
    parts
        .map(|(covariate, effect)| (covariate.to_owned(), effect.to_owned()))
        .ok_or_else(|| "expected a covariate and an effect, as in age:style".to_owned())
}

fn two_numbers(text: &str) -> Result<(f64, f64), String> {
    let numbers = text.split_once(',').map(|(low, high)| {
        let number = |part: &str| part.trim().parse::<f64>().ok();
        number(low).zip(number(high))
    });
    numbers
        .flatten()
        .ok_or_else(|| "expected two numbers, as in -0.5,0.5".to_owned())
}

impl DesignArgs {
    pub(super) fn split(self) -> Result<(Input, Test), Failure> {
        Ok(match self {
            Self::Compare {
                factors,
                covariate,
                with,
                ordinal,
                missing,
            } => {
                let (input, mut columns) = factors.split();
                columns.covariates = covariate;
                columns.products = with;
                let test = Test::Compare {
                    columns,
                    ordinal,
                    missing,
                };
                (input, test)
            }
            Self::Factorial { factors, method } => {
                let (input, columns) = factors.split();
                (input, Test::Factorial { columns, method })
            }
            Self::Mixed {
                input,
                subject,
                fixed,
                value,
            } => {
                let test = Test::Mixed {
                    subject,
                    fixed,
                    value,
                };
                (input, test)
            }
            Self::Ordinal(within) => {
                let (input, columns) = within.split();
                (input, Test::Ordinal(columns))
            }
            Self::Groups {
                input,
                group,
                value,
            } => (input, Test::Groups { group, value }),
            Self::Equivalence {
                input,
                conditions,
                value,
                mu,
                bounds: (low, high),
                standardized,
            } => {
                let bounds = if standardized {
                    Bounds::Standardized { low, high }
                } else {
                    Bounds::Raw { low, high }
                };
                let test = match (conditions.columns(&value), mu) {
                    (Some(columns), _) => Test::Equivalence { columns, bounds },
                    (None, Some(mu)) => Test::EquivalenceOne { value, mu, bounds },
                    (None, None) => return Err(needs("--subject and --within, or --mu")),
                };
                (input, test)
            }
            Self::Bayes {
                input,
                conditions,
                value,
                mu,
                group,
                x,
                y,
            } => {
                let test = match (x.zip(y), value) {
                    (Some((x, y)), _) => Test::BayesCorrelation { x, y },
                    (None, Some(value)) => match (conditions.columns(&value), mu, group) {
                        (Some(columns), ..) => Test::BayesPaired(columns),
                        (_, Some(mu), _) => Test::BayesOne { value, mu },
                        (_, _, Some(group)) => Test::BayesGroups { group, value },
                        _ => return Err(needs("--subject and --within, --group or --mu")),
                    },
                    (None, None) => return Err(needs("--value, or --x and --y")),
                };
                (input, test)
            }
        })
    }
}
