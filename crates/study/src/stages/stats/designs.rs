//! Tests of any design, of groups, factors, bounds and models: from the columns of a table to the result.

use super::{
    columns::{self, WithinColumns},
    input::Long,
    pictures, printed,
    ran::{ALPHA, Ran},
    rows::{DesignRows, FactorColumns},
};
use crate::{error::StudyError, tables::Table};
use maveric_stats::{
    self as tests, BayesTAnalysis, ByDesign, DesignChoice, OutcomeScale, Predictor, RandomIntercept,
};
pub use maveric_stats::{Bounds, Formula, MissingCells};

/// How a factorial design is tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorialMethod {
    /// Analysis of variance, with means, contrasts and simple effects.
    Anova,
    /// Aligned ranks.
    Art,
}

/// A test of another design than one factor within subjects, and the columns that it reads.
#[derive(Debug, Clone)]
pub enum DesignTest {
    /// The test that the design calls for: what was varied, within whom and between whom, and what was answered.
    Compare {
        /// Columns of the design.
        columns: FactorColumns,
        /// Whether the values are ordered answers.
        ordinal: bool,
        /// What becomes of a subject with a missing cell.
        missing: MissingCells,
    },
    /// Up to two factors within subjects and two between.
    Factorial {
        /// Columns of the design.
        columns: FactorColumns,
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
            Self::Compare { .. } => "compare",
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
            Self::Compare { columns, .. } | Self::Factorial { columns, .. }
                if columns.within.len() == 1 =>
            {
                Some(Long {
                    subject: columns.subject.as_deref(),
                    within: &columns.within[0],
                    value: &columns.value,
                })
            }
            _ => None,
        }
    }

    /// Whether there are cells, contrasts or two columns to draw.
    pub(super) fn has_figure(&self) -> bool {
        !matches!(self, Self::BayesOne { .. })
    }

    /// The column of values, if there is one.
    pub(super) fn value(&mut self) -> Option<&mut String> {
        match self {
            Self::Ordinal(c) | Self::BayesPaired(c) | Self::Equivalence { columns: c, .. } => {
                Some(&mut c.value)
            }
            Self::Compare { columns, .. } | Self::Factorial { columns, .. } => {
                Some(&mut columns.value)
            }
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
pub(super) fn run(table: &Table, test: &DesignTest) -> Result<Ran, StudyError> {
    let one = |value: &str| table.numbers(value);
    Ok(match test {
        DesignTest::Compare {
            columns,
            ordinal,
            missing,
        } => compare(table, columns, *ordinal, *missing)?,
        DesignTest::Factorial { columns, method } => {
            let rows = DesignRows::read(table, columns)?;
            let design = rows.design()?;
            match method {
                FactorialMethod::Anova => {
                    let found = tests::factorial(&design);
                    let picture = pictures::factorial(&rows, &columns.value, &found, None);
                    Ran::of(&found, printed::factorial(&found)).drawn(picture)
                }
                FactorialMethod::Art => {
                    let found = tests::aligned_ranks(&design);
                    let picture = pictures::aligned(&rows, &columns.value, &found);
                    Ran::of(&found, printed::aligned(&found)).drawn(picture)
                }
            }
        }
        DesignTest::Mixed {
            subject,
            fixed,
            value,
        } => mixed(table, subject, fixed, value)?,
        DesignTest::Ordinal(c) => {
            let people = columns::labels(table, &c.subject)?;
            let conditions = columns::labels(table, &c.within)?;
            let found = tests::ordinal(&people, &conditions, &one(&c.value)?)?;
            let rows = DesignRows::one_factor(table, Some(&c.subject), &c.within, &c.value)?;
            let picture = pictures::ordinal(&rows, &c.value, &found, None);
            Ran::of(&found, printed::ordinal(&found)).drawn(picture)
        }
        DesignTest::Groups { group, value } => {
            let found = tests::groups(&columns::labels(table, group)?, &one(value)?)?;
            let rows = DesignRows::one_factor(table, None, group, value)?;
            let picture = pictures::groups(&rows, value, &found, None);
            Ran::of(&found, printed::groups(&found)).drawn(picture)
        }
        DesignTest::Equivalence { columns: c, bounds } => {
            let found = tests::equivalence(&columns::within(table, c)?, *bounds)?;
            let picture = pictures::equivalence(&c.value, &found);
            Ran::of(&found, printed::equivalence(&found)).drawn(picture)
        }
        DesignTest::EquivalenceOne { value, mu, bounds } => {
            let found = tests::equivalence_one(&one(value)?, *mu, *bounds)?;
            let picture = pictures::equivalence(value, &found);
            Ran::of(&found, printed::equivalence(&found)).drawn(picture)
        }
        DesignTest::BayesPaired(c) => {
            let found = tests::bayes_paired(&columns::within(table, c)?);
            bayes(table, &found, Some(&c.subject), &c.within, &c.value)?
        }
        DesignTest::BayesOne { value, mu } => Ran::plainly(&tests::bayes_one(&one(value)?, *mu)?),
        DesignTest::BayesGroups { group, value } => {
            let found = tests::bayes_groups(&columns::labels(table, group)?, &one(value)?)?;
            bayes(table, &found, None, group, value)?
        }
        DesignTest::BayesCorrelation { x, y } => {
            let (of_x, of_y) = (one(x)?, one(y)?);
            let found = tests::bayes_correlation(&of_x, &of_y)?;
            let said = pictures::first(&found);
            Ran::plainly(&found).drawn(pictures::correlation((x, &of_x), (y, &of_y), said))
        }
    })
}

/// The test that the design calls for.
fn compare(
    table: &Table,
    columns: &FactorColumns,
    ordinal: bool,
    missing: MissingCells,
) -> Result<Ran, StudyError> {
    let rows = DesignRows::read(table, columns)?;
    let choice = DesignChoice {
        scale: if ordinal {
            OutcomeScale::Ordinal
        } else {
            OutcomeScale::Measure
        },
        missing,
        alpha: ALPHA,
        exact: true,
    };
    let found = tests::compare_by_design(&rows.columns(), &choice)?;
    let picture = match (&found, &columns.subject) {
        (ByDesign::OneFactor(found), Some(subject)) => {
            let c = WithinColumns {
                subject: subject.clone(),
                within: columns.within.concat(),
                value: columns.value.clone(),
            };
            let data = columns::within(table, &c)?;
            let p = found.posthoc.pairs.values().map(|pair| pair.p_adjusted);
            pictures::conditions(&data, &c.value, pictures::first(&**found), &found.desc, p)
        }
        _ => pictures::by_design(&rows, &columns.value, &found),
    };
    Ok(Ran::of(&found, printed::by_design(&found)).drawn(picture))
}

fn bayes(
    table: &Table,
    found: &BayesTAnalysis,
    subject: Option<&str>,
    factor: &str,
    value: &str,
) -> Result<Ran, StudyError> {
    let rows = DesignRows::one_factor(table, subject, factor, value)?;
    let picture = pictures::plain_cells(&rows, value, pictures::first(found));
    Ok(Ran::plainly(found).drawn(picture))
}

/// Cells of a predictor.
enum Cells {
    Numbers(Vec<Option<f64>>),
    Labels(Vec<Option<String>>),
}

/// Reads the columns of a formula and fits the model.
fn mixed(table: &Table, subject: &str, fixed: &Formula, value: &str) -> Result<Ran, StudyError> {
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
    let rows = shown(table, subject, value, &found)?;
    let picture = pictures::mixed(rows.as_ref(), value, &found);
    Ok(Ran::of(&found, printed::mixed(&found)).drawn(picture))
}

/// The cells of the highest term of factors alone; none in a model of covariates.
fn shown(
    table: &Table,
    subject: &str,
    value: &str,
    found: &RandomIntercept,
) -> Result<Option<DesignRows>, StudyError> {
    let Some((term, _)) = found.emm.iter().last() else {
        return Ok(None);
    };
    let columns = FactorColumns {
        subject: Some(subject.to_owned()),
        between: term.split(':').map(str::to_owned).collect(),
        value: value.to_owned(),
        ..FactorColumns::default()
    };
    DesignRows::read(table, &columns).map(Some)
}
