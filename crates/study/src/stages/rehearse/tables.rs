//! What was found, as tables and as lines.

use super::{Cell, Rehearsal, TestRate};
use crate::{error::StudyError, mean::mean};
use maveric_pages::PageTexts;
use maveric_rehearsal::{ALPHA, FamilyRate, HypothesisRate, POWER, Part, n_for};
use maveric_report::tables::Table;
use maveric_stats::Proportion;
use serde::Serialize;
use std::collections::BTreeMap;

/// The tests of a part of the report in studies without effects.
#[derive(Serialize)]
struct PartRow {
    part: &'static str,
    tests: usize,
    mean: Option<f64>,
    lowest: Option<f64>,
    highest: Option<f64>,
    /// Of them those that keep their level.
    kept: usize,
}

impl PartRow {
    fn from_tests((part, tests): (Part, Vec<&TestRate>)) -> Self {
        let rates = tests.iter().filter_map(|t| Some(t.rate?.estimate));
        let rates: Vec<f64> = rates.collect();
        Self {
            part: part.title(),
            tests: tests.len(),
            mean: mean(&rates),
            lowest: rates.iter().copied().reduce(f64::min),
            highest: rates.iter().copied().reduce(f64::max),
            kept: tests.iter().filter(|t| keeps_level(t)).count(),
        }
    }
}

/// A test with the title of its part.
#[derive(Serialize)]
struct TestRow<'a> {
    title: &'static str,
    #[serde(flatten)]
    test: &'a TestRate,
}

/// Whether a test keeps its level: .05 within .01.
fn keeps_level(test: &TestRate) -> bool {
    test.rate.is_some_and(|r| (r.estimate - ALPHA).abs() <= 0.01)
}

/// The tables of studies without effects.
pub(super) fn null_tables(cell: &Cell, texts: &PageTexts) -> Result<Vec<Table>, StudyError> {
    let sizes = [("studies", cell.studies), ("participants", cell.participants)];
    let texts = texts.with(&BTreeMap::from(sizes));
    let tests = cell.tests.iter().map(|test| TestRow { title: test.part.title(), test });
    Ok(vec![
        texts.table("null-parts", cell.by_part().into_iter().map(PartRow::from_tests))?,
        texts.table("null-families", &cell.families)?,
        texts.table("null-tests", tests)?,
    ])
}

/// The rate of a test in a cell.
pub(super) fn rate_of(cell: &Cell, key: &str) -> Option<Proportion> {
    cell.tests.iter().find(|t| t.key == key)?.rate
}

/// A rate at each size tried, for one scale of the effects.
pub(super) fn curve(
    cells: &[Cell],
    scale: f64,
    rate: &dyn Fn(&Cell) -> Option<Proportion>,
) -> Vec<(usize, Proportion)> {
    let same = cells.iter().filter(|c| (c.effect_scale - scale).abs() < 1e-12);
    same.filter_map(|c| Some((c.participants, rate(c)?))).collect()
}

/// How many people a test needs, at each scale of the effects.
#[derive(Serialize)]
struct NeededRow {
    test: String,
    needed: Vec<Option<Needed>>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Needed {
    People(usize),
    /// No more than the smallest size tried.
    AtMost(String),
}

/// The tables of studies with effects.
pub(super) fn power_tables(
    rehearsal: &Rehearsal,
    texts: &PageTexts,
) -> Result<Vec<Table>, StudyError> {
    let mut tables = Vec::new();
    if !rehearsal.signs.is_empty() {
        tables.push(texts.table("power-signs", &rehearsal.signs)?);
    }
    let mut scales: Vec<f64> = Vec::new();
    for cell in &rehearsal.cells {
        if !scales.contains(&cell.effect_scale) {
            scales.push(cell.effect_scale);
        }
    }
    let Some(first) = rehearsal.cells.first() else {
        return Ok(tables);
    };
    let needed = |scale: f64, rate: &dyn Fn(&Cell) -> Option<Proportion>| {
        let curve = curve(&rehearsal.cells, scale, rate).into_iter();
        let points: Vec<(usize, f64)> = curve.map(|(n, r)| (n, r.estimate)).collect();
        let lowest = points.first().map(|(n, _)| *n);
        n_for(&points, POWER).map(|n| match lowest {
            Some(low) if n <= low => Needed::AtMost(format!("≤ {n}")),
            _ => Needed::People(n),
        })
    };
    let texts = texts.with(&BTreeMap::from([("scales", &scales)]));
    if !first.hypotheses.is_empty() {
        let rows = first.hypotheses.iter().enumerate();
        let rows = rows.map(|(at, h)| NeededRow {
            test: h.says.clone(),
            needed: scales
                .iter()
                .map(|scale| needed(*scale, &|c| c.hypotheses.get(at)?.shown))
                .collect(),
        });
        tables.push(texts.table("power-hypotheses", rows)?);
    }
    let rows = first.findings.iter().map(|finding| {
        let shown = |c: &Cell| c.findings.iter().find(|f| f.question == finding.question)?.shown;
        NeededRow {
            test: finding.question.to_string(),
            needed: scales.iter().map(|scale| needed(*scale, &shown)).collect(),
        }
    });
    tables.push(texts.table("power-findings", rows)?);
    let rows = first.tests.iter().map(|test| NeededRow {
        test: test.key.clone(),
        needed: scales.iter().map(|scale| needed(*scale, &|c| rate_of(c, &test.key))).collect(),
    });
    tables.push(texts.table("power-n", rows)?);
    Ok(tables)
}

/// A size and scale of the effects with one hypothesis.
#[derive(Serialize)]
struct HypothesisRow<'a> {
    effect_scale: f64,
    participants: usize,
    #[serde(flatten)]
    hypothesis: &'a HypothesisRate,
}

/// The result in a few lines.
pub(super) fn summary(rehearsal: &Rehearsal, texts: &PageTexts) -> Result<Vec<String>, StudyError> {
    let mut lines = Vec::new();
    let mut say = |key: &str, texts: PageTexts| -> Result<(), StudyError> {
        lines.push(texts.text(key)?);
        Ok(())
    };
    for cell in rehearsal.cells.iter().filter(|c| c.effect_scale == 0.0) {
        let kept = cell.tests.iter().filter(|t| keeps_level(t)).count();
        let values =
            [("participants", cell.participants), ("kept", kept), ("tests", cell.tests.len())];
        say("null_cell", texts.with(&BTreeMap::from(values)))?;
        for row in cell.by_part().into_iter().map(PartRow::from_tests) {
            say("null_part", texts.with(&row))?;
        }
        let known = |f: &&FamilyRate| f.any_holm.is_some() && f.any_uncorrected.is_some();
        for family in cell.families.iter().filter(known) {
            say("null_family", texts.with(family))?;
        }
    }
    for cell in rehearsal.cells.iter().filter(|c| c.effect_scale != 0.0) {
        for hypothesis in &cell.hypotheses {
            let row = HypothesisRow {
                effect_scale: cell.effect_scale,
                participants: cell.participants,
                hypothesis,
            };
            say("hypothesis", texts.with(&row))?;
        }
    }
    for row in &rehearsal.signs {
        say("sign", texts.with(row))?;
    }
    Ok(lines)
}
