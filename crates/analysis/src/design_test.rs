//! The test of an outcome that the study's design calls for.

use crate::{
    AnalysisError,
    by_factor::{by_factor, of_groups},
    crossed::{Within, factors_within, too_many_between},
    data::StudyData,
    outcomes::Asked,
    result::{ByFactor, Panel},
    verdict::ALPHA,
};
use maveric_domain::{
    ConditionId, ParticipantId,
    design::{Covariate, DeclaredTest, Factor, Quantity},
};
use maveric_stats::{
    AskedTest, ByDesign, CarryOver, DesignChoice, DesignTable, MissingCells, NoCarryOver,
    OutcomeScale, carry_over, compare_by_design,
};

/// What an analysis is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// A study's page: everything, and Friedman's p exact where it is feasible.
    Report,
    /// One of many made-up studies, of which the tests alone are counted: Friedman's p by Iman and Davenport's F, a thousand times faster,
    /// no simple effects, no carry-over, nothing by what people perceived.
    Simulation,
}

/// One outcome of some people.
pub(crate) struct Tested<'a> {
    pub(crate) data: &'a StudyData,
    pub(crate) asked: &'a Asked,
    /// With its conditions and rows.
    pub(crate) panel: &'a Panel,
    pub(crate) people: &'a [ParticipantId],
    pub(crate) purpose: Purpose,
    pub(crate) period: Period,
}

/// Whether a test takes the period in which a condition was met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Period {
    /// As a factor.
    Taken,
    /// Nobody's order is known, or what is compared was not met in an order.
    None,
    /// The design declares the choice by what the data look like.
    Declined,
    /// The test is one of several factors, groups or covariates.
    SeveralFactors,
    /// The orders that there are do not tell it from the conditions, and no test was declared that would have to.
    NotTold,
}

impl Period {
    pub(crate) fn for_outcome(
        data: &StudyData,
        asked: &Asked,
        (conditions, people): (&[ConditionId], &[ParticipantId]),
        grouped: bool,
    ) -> Self {
        let in_orders = |c: &ConditionId| data.design.condition(*c).is_some();
        if conditions.len() < 2 || !data.has_orders() || !conditions.iter().all(in_orders) {
            return Self::None;
        }
        if asked.test == Some(DeclaredTest::Auto) {
            return Self::Declined;
        }
        let between = !grouped && !data.design.factors().is_empty();
        let several = between
            || !data.design.covariates().is_empty()
            || factors_within(&data.design, conditions).len() > 1;
        if several && asked.test.is_none() {
            return Self::SeveralFactors;
        }
        if asked.test.is_none() && !orders_tell_period(data, conditions, people) {
            return Self::NotTold;
        }
        Self::Taken
    }

    /// Why the period is not in the test, where orders are known.
    pub(crate) fn reason(self) -> Option<&'static str> {
        match self {
            Self::Taken | Self::None => None,
            Self::Declined => Some(
                "chosen by what the data look like, as declared (`test = \"auto\"`): the period in which a condition was met is not in the test",
            ),
            Self::NotTold => Some(
                "the orders in which people met the conditions do not tell the period from the conditions: it is not in the test",
            ),
            Self::SeveralFactors => Some(
                "the period in which a condition was met is not in this test of several factors: `test = \"mixed\"` takes it out",
            ),
        }
    }
}

/// Whether the orders of these people tell the period from the conditions.
fn orders_tell_period(
    data: &StudyData,
    conditions: &[ConditionId],
    people: &[ParticipantId],
) -> bool {
    let mut met = DesignTable::default();
    let mut cells = Vec::new();
    for person in people {
        for condition in conditions {
            if let Some(period) = data.period(person, *condition) {
                met.subjects.push(person.to_string());
                cells.push(condition.to_string());
                met.periods.push(period);
                met.values.push(Some(0.0));
            }
        }
    }
    met.within.push((String::new(), cells));
    met.columns().tells_period()
}

/// A test with what stands beside it.
pub(crate) struct Compared {
    pub(crate) comparison: ByDesign,
    /// What the factors did, with the reasons of what was not tested.
    pub(crate) by_factor: Option<(ByFactor, Vec<String>)>,
    pub(crate) carry_over: Option<CarryOver>,
}

/// Runs the test; else why there is none.
pub(crate) fn by_design(tested: &Tested) -> Result<Result<Compared, String>, AnalysisError> {
    let (data, panel) = (tested.data, tested.panel);
    let between: &[Factor] = if panel.group.is_some() {
        // These people are of one level.
        &[]
    } else {
        data.design.factors()
    };
    if let Some(why) = too_many_between(between.len()) {
        return Ok(Err(why));
    }
    let one_condition = panel.conditions.len() < 2;
    if one_condition && between.is_empty() {
        return Ok(Err("one condition and no baseline: nothing to compare it with".to_owned()));
    }
    if panel.n < 2 {
        return Ok(Err(format!("{} with a value in every condition", panel.n)));
    }
    let within =
        if one_condition { Vec::new() } else { factors_within(&data.design, &panel.conditions) };
    let table = table(tested, within, between)?;
    let columns = table.columns();
    let choice = DesignChoice {
        test: match tested.asked.test {
            None | Some(DeclaredTest::Auto) => AskedTest::Chosen,
            Some(DeclaredTest::Mixed) => AskedTest::Mixed,
            Some(DeclaredTest::Ordinal) => AskedTest::Ordinal,
            Some(DeclaredTest::RmAnova) => AskedTest::RmAnova,
            Some(DeclaredTest::Friedman) => AskedTest::Friedman,
        },
        scale: match tested.asked.quantity {
            Quantity::Measure(_) => OutcomeScale::Measure,
            Quantity::Score(_) => OutcomeScale::Rating,
        },
        missing: MissingCells::Listwise,
        alpha: ALPHA,
        exact: tested.purpose == Purpose::Report,
    };
    // What one outcome lacks is no fault of the study.
    let comparison = match compare_by_design(&columns, &choice) {
        Ok(comparison) => comparison,
        Err(refused) => {
            let over_everybody = tested.asked.test.filter(|_| panel.group.is_none());
            let never = over_everybody.and_then(|test| data.design.never_run(test));
            let why = never.map(|test| {
                format!("{test}: this test is of one factor within people, and of nothing else")
            });
            return Ok(Err(why.unwrap_or_else(|| refused.to_string())));
        }
    };
    let (mut factors, mut carried) = (None, None);
    if tested.purpose == Purpose::Report && panel.group.is_none() {
        factors = match &comparison {
            ByDesign::Factorial(tests) if tests.found.anova.levels.len() > 1 => {
                Some(by_factor(&data.design, &columns, tests)?)
            }
            ByDesign::Groups(groups) => {
                of_groups(&columns, &groups.found).map(|found| (found, Vec::new()))
            }
            _ => None,
        };
        carried = match (tested.period, &comparison) {
            (Period::Taken, ByDesign::Ordinal(_)) => {
                Some(CarryOver::NotFitted { why_not: NoCarryOver::OrderedAnswers })
            }
            (Period::Taken, _) => Some(carry_over(&columns)?),
            _ => None,
        };
    }
    Ok(Ok(Compared { comparison, by_factor: factors, carry_over: carried }))
}

/// The rows of a test: one of each person in each condition.
fn table(
    tested: &Tested,
    within: Vec<Within>,
    between: &[Factor],
) -> Result<DesignTable, AnalysisError> {
    let (data, panel) = (tested.data, tested.panel);
    let design = &data.design;
    let mut people: Vec<(&ParticipantId, &Vec<Option<f64>>)> =
        tested.people.iter().zip(&panel.rows).collect();
    // The levels of groups stand in alphabetical order, whoever comes first: which of two is the first is then in no id.
    people.sort_by_cached_key(|(p, _)| {
        let levels = between.iter().map(|f| data.column(p, &f.name));
        levels.collect::<Vec<_>>()
    });
    let rows = || {
        let people = people.iter();
        people.flat_map(|&(p, row)| (0..row.len()).map(move |column| (p, column, row[column])))
    };
    let within: Vec<Within> = within
        .into_iter()
        .map(|(name, levels)| (name, rows().map(|(_, column, _)| levels[column].clone()).collect()))
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
        periods: rows()
            .filter(|_| tested.period == Period::Taken)
            // Whose order is not known has no values either.
            .map(|(p, column, _)| data.period(p, panel.conditions[column]).unwrap_or(0))
            .collect(),
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
    covariate_number(person, covariate, text).map(Some)
}

/// The number that stands in somebody's cell of a covariate.
///
/// # Errors
/// [`AnalysisError::NoNumber`] for what is none.
pub fn covariate_number(
    person: &ParticipantId,
    covariate: &Covariate,
    cell: &str,
) -> Result<f64, AnalysisError> {
    let number = cell.parse::<f64>().ok().filter(|v| v.is_finite());
    number.ok_or_else(|| AnalysisError::NoNumber {
        column: covariate.column.clone(),
        participant: person.clone(),
        found: cell.to_owned(),
    })
}
