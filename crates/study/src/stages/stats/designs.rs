//! Tests that read more than their columns say: what a design calls for, Bayes factors of cells, the terms of a formula.

use super::{
    columns::{self, WithinColumns},
    pictures, printed,
    ran::{ALPHA, Ran},
    rows::{DesignRows, FactorColumns},
};
use crate::{error::StudyError, tables::Table};
use maveric_stats::{
    self as tests, BayesTAnalysis, ByDesign, DesignChoice, Formula, MissingCells, OutcomeScale,
    Predictor, RandomIntercept,
};

/// The test that the design calls for.
pub(super) fn compare(
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

/// Cells with the sentence of a Bayes factor above them.
pub(super) fn bayes(
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
pub(super) fn mixed(
    table: &Table,
    subject: &str,
    fixed: &Formula,
    value: &str,
) -> Result<Ran, StudyError> {
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
