//! Tests of groups, factors, bounds and models: from the columns of a table to the result.

use super::{WithinColumns, columns, input::Long, plain};
use crate::{error::StudyError, tables::Table};
use maveric_stats::{self as tests, BetweenColumn, FactorialDesign, Predictor, WithinColumn};
pub use maveric_stats::{Bounds, Formula};
use serde_json::Value;

/// How a factorial design is tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorialMethod {
    /// Analysis of variance, with means, contrasts and simple effects.
    Anova,
    /// Aligned ranks.
    Art,
}

/// The columns of a factorial design.
#[derive(Debug, Clone)]
pub struct FactorialColumns {
    /// Whose row it is; without it every row is a subject.
    pub subject: Option<String>,
    /// Factors within subjects.
    pub within: Vec<String>,
    /// Factors between subjects.
    pub between: Vec<String>,
    /// The value.
    pub value: String,
}

/// A test of another design than one factor within subjects, and the columns that it reads.
#[derive(Debug, Clone)]
pub enum DesignTest {
    /// Up to two factors within subjects and two between.
    Factorial {
        /// Columns of the design.
        columns: FactorialColumns,
        /// How it is tested.
        method: FactorialMethod,
    },
    /// A linear model with a random intercept.
    Mixed {
        /// Whose row it is.
        subject: String,
        /// The fixed effects; a predictor whose values are all numbers is a covariate, any other a factor.
        fixed: Formula,
        /// The value.
        value: String,
    },
    /// A cumulative logit model of whole numbers of which the order counts, with a random intercept.
    Ordinal(WithinColumns),
    /// Independent groups.
    Groups {
        /// The groups.
        group: String,
        /// The value.
        value: String,
    },
    /// Whether conditions differ by less than bounds.
    Equivalence {
        /// Columns of the design.
        columns: WithinColumns,
        /// What counts as no difference.
        bounds: Bounds,
    },
    /// Whether the mean of one sample differs by less than bounds from a value.
    EquivalenceOne {
        /// The column.
        value: String,
        /// What its mean is compared with.
        mu: f64,
        /// What counts as no difference.
        bounds: Bounds,
    },
    /// Bayes factors of paired t tests.
    BayesPaired(WithinColumns),
    /// Bayes factor of a t test of one sample.
    BayesOne {
        /// The column.
        value: String,
        /// What its mean is compared with.
        mu: f64,
    },
    /// Bayes factors of t tests of independent groups.
    BayesGroups {
        /// The groups.
        group: String,
        /// The value.
        value: String,
    },
    /// Bayes factor of a correlation.
    BayesCorrelation {
        /// First column.
        x: String,
        /// Second column.
        y: String,
    },
}

impl DesignTest {
    /// Its name on the command line.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Factorial { .. } => "factorial",
            Self::Mixed { .. } => "mixed",
            Self::Ordinal(_) => "ordinal",
            Self::Groups { .. } => "groups",
            Self::Equivalence { .. } | Self::EquivalenceOne { .. } => "equivalence",
            Self::BayesPaired(_)
            | Self::BayesOne { .. }
            | Self::BayesGroups { .. }
            | Self::BayesCorrelation { .. } => "bayes",
        }
    }

    /// The columns that a wide table becomes; `None` if there is not one factor.
    pub(super) fn long(&self) -> Option<Long<'_>> {
        match self {
            Self::Ordinal(c) | Self::BayesPaired(c) | Self::Equivalence { columns: c, .. } => {
                Some(c.long())
            }
            Self::Groups { group, value } | Self::BayesGroups { group, value } => Some(Long {
                subject: None,
                within: group,
                value,
            }),
            Self::Factorial { columns, .. } if columns.within.len() == 1 => Some(Long {
                subject: columns.subject.as_deref(),
                within: &columns.within[0],
                value: &columns.value,
            }),
            _ => None,
        }
    }

    /// The column of values, if there is one.
    pub(super) fn value(&mut self) -> Option<&mut String> {
        match self {
            Self::Ordinal(c) | Self::BayesPaired(c) | Self::Equivalence { columns: c, .. } => {
                Some(&mut c.value)
            }
            Self::Factorial { columns, .. } => Some(&mut columns.value),
            Self::Mixed { value, .. }
            | Self::Groups { value, .. }
            | Self::EquivalenceOne { value, .. }
            | Self::BayesOne { value, .. }
            | Self::BayesGroups { value, .. } => Some(value),
            Self::BayesCorrelation { .. } => None,
        }
    }
}

/// Runs one test on the table.
pub(super) fn run(table: &Table, test: &DesignTest) -> Result<Value, StudyError> {
    let one = |value: &str| table.numbers(value);
    Ok(match test {
        DesignTest::Factorial { columns, method } => {
            let design = factorial(table, columns)?;
            match method {
                FactorialMethod::Anova => plain(&tests::factorial(&design)),
                FactorialMethod::Art => plain(&tests::aligned_ranks(&design)),
            }
        }
        DesignTest::Mixed {
            subject,
            fixed,
            value,
        } => mixed(table, subject, fixed, value)?,
        DesignTest::Ordinal(c) => {
            let (people, conditions) = (
                columns::labels(table, &c.subject)?,
                columns::labels(table, &c.within)?,
            );
            plain(&tests::ordinal(&people, &conditions, &one(&c.value)?)?)
        }
        DesignTest::Groups { group, value } => plain(&tests::groups(
            &columns::labels(table, group)?,
            &one(value)?,
        )?),
        DesignTest::Equivalence { columns, bounds } => {
            let data = columns::within(table, columns)?;
            plain(&tests::equivalence(&data, *bounds)?)
        }
        DesignTest::EquivalenceOne { value, mu, bounds } => {
            plain(&tests::equivalence_one(&one(value)?, *mu, *bounds)?)
        }
        DesignTest::BayesPaired(c) => plain(&tests::bayes_paired(&columns::within(table, c)?)),
        DesignTest::BayesOne { value, mu } => plain(&tests::bayes_one(&one(value)?, *mu)?),
        DesignTest::BayesGroups { group, value } => {
            let groups = columns::labels(table, group)?;
            plain(&tests::bayes_groups(&groups, &one(value)?)?)
        }
        DesignTest::BayesCorrelation { x, y } => {
            plain(&tests::bayes_correlation(&one(x)?, &one(y)?)?)
        }
    })
}

/// Reads the columns of a factorial design.
fn factorial(table: &Table, columns: &FactorialColumns) -> Result<FactorialDesign, StudyError> {
    let subjects = match &columns.subject {
        Some(subject) => columns::labels(table, subject)?,
        None => (1..=table.rows()).map(|row| row.to_string()).collect(),
    };
    let within: Result<Vec<_>, _> = columns
        .within
        .iter()
        .map(|f| columns::labels(table, f))
        .collect();
    let between: Result<Vec<_>, _> = columns.between.iter().map(|f| table.text(f)).collect();
    let (within, between) = (within?, between?);
    let within: Vec<WithinColumn> = columns
        .within
        .iter()
        .map(String::as_str)
        .zip(within.iter().map(Vec::as_slice))
        .collect();
    let between: Vec<BetweenColumn> = columns
        .between
        .iter()
        .map(String::as_str)
        .zip(between.iter().map(Vec::as_slice))
        .collect();
    let values = table.numbers(&columns.value)?;
    Ok(FactorialDesign::from_columns(
        &subjects, &within, &between, &values,
    )?)
}

/// Cells of a predictor.
enum Cells {
    Numbers(Vec<Option<f64>>),
    Labels(Vec<Option<String>>),
}

/// Reads the columns of a formula and fits the model.
fn mixed(table: &Table, subject: &str, fixed: &Formula, value: &str) -> Result<Value, StudyError> {
    let read = |name: &String| {
        let cells = table.text(name)?;
        let is_number = |cell: &Option<String>| {
            cell.as_ref()
                .is_none_or(|cell| cell.trim().parse::<f64>().is_ok())
        };
        Ok(if cells.iter().all(is_number) {
            Cells::Numbers(table.numbers(name)?)
        } else {
            Cells::Labels(cells)
        })
    };
    let cells: Result<Vec<Cells>, StudyError> = fixed.predictors().iter().map(read).collect();
    let cells = cells?;
    let predictors: Vec<(&str, Predictor)> = fixed
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
    let people = columns::labels(table, subject)?;
    let found = tests::random_intercept(&people, fixed, &predictors, &table.numbers(value)?)?;
    Ok(plain(&found))
}
