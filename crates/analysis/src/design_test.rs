//! The test of an outcome that the study's design calls for.

use crate::{AnalysisError, data::StudyData, outcomes::Asked, result::Panel, verdict::ALPHA};
use maveric_domain::{
    ConditionId, Design, ParticipantId,
    design::{Column, Condition, Covariate, Quantity},
};
use maveric_stats::{
    ByDesign, DesignChoice, DesignColumns, MissingCells, OutcomeScale, compare_by_design,
};

/// How much work Friedman's p is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Friedman {
    /// Exact where it is feasible, as a study is reported.
    Exact,
    /// By Iman and Davenport's F: a thousand times faster, for many studies.
    Approximate,
}

/// The factor whose levels are the conditions, where those cross no others.
const CONDITION: &str = "condition";

/// Factors of a kind that a test can take.
pub(crate) const MOST_FACTORS: usize = 2;

/// One outcome of some people.
pub(crate) struct Tested<'a> {
    pub(crate) data: &'a StudyData,
    pub(crate) asked: &'a Asked,
    /// With its conditions and rows.
    pub(crate) panel: &'a Panel,
    pub(crate) people: &'a [ParticipantId],
    pub(crate) friedman: Friedman,
}

/// A factor within people: its name, and its level in each condition.
pub(crate) type Within = (String, Vec<String>);

/// The two factors that the conditions cross, if they do so completely.
pub(crate) fn crossed(conditions: &[&Condition]) -> Option<Vec<Within>> {
    let names: Vec<&String> = conditions.first()?.levels.keys().collect();
    if names.len() != MOST_FACTORS {
        return None;
    }
    let mut factors = Vec::new();
    let mut cells = 1;
    for name in names {
        let of = conditions.iter().map(|c| c.levels.get(name).cloned());
        let levels: Vec<String> = of.collect::<Option<_>>()?;
        let mut different = levels.clone();
        different.sort_unstable();
        different.dedup();
        if different.len() < 2 {
            return None;
        }
        cells *= different.len();
        factors.push((name.clone(), levels));
    }
    let cell = |at: usize| [&factors[0].1[at], &factors[1].1[at]];
    let twice = (1..conditions.len()).any(|b| (0..b).any(|a| cell(a) == cell(b)));
    (cells == conditions.len() && !twice).then_some(factors)
}

/// Runs the test; else why there is none.
pub(crate) fn by_design(tested: &Tested) -> Result<Result<ByDesign, String>, AnalysisError> {
    let (data, panel) = (tested.data, tested.panel);
    let between: &[Column] = if panel.group.is_some() {
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
    let rows = || {
        let people = tested.people.iter().zip(&panel.rows);
        people.flat_map(|(p, row)| (0..row.len()).map(move |at| (p, at, row[at])))
    };
    let subjects: Vec<String> = rows().map(|(p, ..)| p.to_string()).collect();
    let values: Vec<Option<f64>> = rows().map(|(.., value)| value).collect();
    let within: Vec<Within> = within
        .into_iter()
        .map(|(name, of)| (name, rows().map(|(_, at, _)| of[at].clone()).collect()))
        .collect();
    let level = |p, f: &Column| data.column(p, &f.column).map(str::to_owned);
    let between: Vec<(&str, Vec<Option<String>>)> = between
        .iter()
        .map(|f| {
            (
                f.column.as_str(),
                rows().map(|(p, ..)| level(p, f)).collect(),
            )
        })
        .collect();
    let mut covariates = Vec::new();
    for covariate in data.design.covariates() {
        let cells: Result<Vec<Option<f64>>, AnalysisError> =
            rows().map(|(p, ..)| number(data, p, covariate)).collect();
        covariates.push((covariate.column.as_str(), cells?));
    }
    let columns = DesignColumns {
        subjects: &subjects,
        within: within.iter().map(|(n, c)| (n.as_str(), &c[..])).collect(),
        between: between.iter().map(|(n, c)| (*n, &c[..])).collect(),
        covariates: covariates.iter().map(|(n, c)| (*n, &c[..])).collect(),
        with: data
            .design
            .covariates()
            .iter()
            .map(|c| {
                (
                    c.column.as_str(),
                    c.with.iter().map(String::as_str).collect(),
                )
            })
            .collect(),
        values: &values,
    };
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
    Ok(compare_by_design(&columns, &choice).map_err(|refused| refused.to_string()))
}

/// The factors that these conditions cross; else the conditions themselves are one.
pub(crate) fn factors_within(design: &Design, conditions: &[ConditionId]) -> Vec<Within> {
    let found: Option<Vec<&Condition>> =
        conditions.iter().map(|id| design.condition(*id)).collect();
    found.and_then(|all| crossed(&all)).unwrap_or_else(|| {
        let names = conditions.iter().map(ToString::to_string).collect();
        vec![(CONDITION.to_owned(), names)]
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
