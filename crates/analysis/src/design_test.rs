//! The test of an outcome that the study's design calls for.

use crate::{
    AnalysisError,
    by_factor::by_factor,
    crossed::{MOST_FACTORS, Within, factors_within},
    data::StudyData,
    outcomes::Asked,
    result::{ByFactor, Panel},
    verdict::ALPHA,
};
use maveric_domain::{
    ParticipantId,
    design::{Covariate, Factor, Quantity},
};
use maveric_stats::{
    ByDesign, DesignChoice, DesignTable, MissingCells, OutcomeScale, compare_by_design,
};

/// How much work Friedman's p is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Friedman {
    /// Exact where it is feasible, as a study is reported.
    Exact,
    /// By Iman and Davenport's F: a thousand times faster, for many studies.
    Approximate,
}

/// One outcome of some people.
pub(crate) struct Tested<'a> {
    pub(crate) data: &'a StudyData,
    pub(crate) asked: &'a Asked,
    /// With its conditions and rows.
    pub(crate) panel: &'a Panel,
    pub(crate) people: &'a [ParticipantId],
    pub(crate) friedman: Friedman,
}

/// The test of a design, and what its factors did with the reasons of what was not tested.
pub(crate) type Compared = (ByDesign, Option<(ByFactor, Vec<String>)>);

/// Runs the test; else why there is none.
pub(crate) fn by_design(tested: &Tested) -> Result<Result<Compared, String>, AnalysisError> {
    let (data, panel) = (tested.data, tested.panel);
    let between: &[Factor] = if panel.group.is_some() {
        // These people are of one level.
        &[]
    } else {
        data.design.factors()
    };
    if between.len() > MOST_FACTORS {
        return Ok(Err(format!(
            "{} factors between people: a test takes at most {MOST_FACTORS}",
            between.len()
        )));
    }
    let one_condition = panel.conditions.len() < 2;
    if one_condition && between.is_empty() {
        return Ok(Err(
            "one condition and no baseline: nothing to compare it with".to_owned(),
        ));
    }
    if panel.n < 2 {
        return Ok(Err(format!("{} with a value in every condition", panel.n)));
    }
    let within = if one_condition {
        Vec::new()
    } else {
        factors_within(&data.design, &panel.conditions)
    };
    let table = table(tested, within, between)?;
    let columns = table.columns();
    let choice = DesignChoice {
        scale: match tested.asked.quantity {
            Quantity::Measure(_) => OutcomeScale::Measure,
            Quantity::Score(_) => OutcomeScale::Rating,
        },
        missing: MissingCells::Listwise,
        alpha: ALPHA,
        exact: tested.friedman == Friedman::Exact,
    };
    // What one outcome lacks is no fault of the study.
    let found = match compare_by_design(&columns, &choice) {
        Ok(found) => found,
        Err(refused) => return Ok(Err(refused.to_string())),
    };
    // A simulation of many studies asks for the omnibus tests alone.
    if tested.friedman == Friedman::Approximate || panel.group.is_some() {
        return Ok(Ok((found, None)));
    }
    let by_factor = match &found {
        ByDesign::Factorial(tests) if tests.found.anova.levels.len() > 1 => {
            Some(by_factor(&data.design, &columns, tests)?)
        }
        _ => None,
    };
    Ok(Ok((found, by_factor)))
}

/// The rows of a test: one of each person in each condition.
fn table(
    tested: &Tested,
    within: Vec<Within>,
    between: &[Factor],
) -> Result<DesignTable, AnalysisError> {
    let (data, panel) = (tested.data, tested.panel);
    let design = &data.design;
    let rows = || {
        let people = tested.people.iter().zip(&panel.rows);
        people.flat_map(|(p, row)| (0..row.len()).map(move |at| (p, at, row[at])))
    };
    let within: Vec<Within> = within
        .into_iter()
        .map(|(name, of)| (name, rows().map(|(_, at, _)| of[at].clone()).collect()))
        .collect();
    let level = |p, f: &Factor| data.column(p, &f.name).map(str::to_owned);
    let between: Vec<(String, Vec<Option<String>>)> = between
        .iter()
        .map(|f| (f.name.clone(), rows().map(|(p, ..)| level(p, f)).collect()))
        .collect();
    let mut covariates = Vec::new();
    for covariate in design.covariates() {
        let cells: Result<Vec<Option<f64>>, AnalysisError> =
            rows().map(|(p, ..)| number(data, p, covariate)).collect();
        covariates.push((covariate.column.clone(), cells?));
    }
    let names = within.iter().map(|(name, _)| name);
    let names = names.chain(between.iter().map(|(name, _)| name));
    let names = names.chain(covariates.iter().map(|(name, _)| name));
    let labels = names.map(|name| (name.clone(), design.factor_label(name)));
    let with = design.covariates().iter();
    Ok(DesignTable {
        labels: labels.filter(|(name, label)| name != label).collect(),
        subjects: rows().map(|(p, ..)| p.to_string()).collect(),
        with: with.map(|c| (c.column.clone(), c.with.clone())).collect(),
        values: rows().map(|(.., value)| value).collect(),
        within,
        between,
        covariates,
    })
}

/// A covariate of a person, as a number.
fn number(
    data: &StudyData,
    person: &ParticipantId,
    covariate: &Covariate,
) -> Result<Option<f64>, AnalysisError> {
    let Some(text) = data.column(person, &covariate.column) else {
        return Ok(None);
    };
    let number = text.parse::<f64>().ok().filter(|v| v.is_finite());
    number.map(Some).ok_or_else(|| AnalysisError::NoNumber {
        column: covariate.column.clone(),
        participant: person.clone(),
        found: text.to_owned(),
    })
}
