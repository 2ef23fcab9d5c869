//! The page of a rehearsal: its figures and tables.

use super::{Cell, Rehearsal, Rehearse, SignRow, tables};
use crate::error::StudyError;
use maveric_pages::{PageTexts, cards::rehearsal::of_studies};
use maveric_report::{
    Card, Context, Figure, Report,
    figures::{
        curves::{CurvePanel, CurvePoint, Curves, curves},
        false_positives::{FalsePositives, PartRates, false_positives},
    },
    html::Section,
};
use maveric_stats::Proportion;
use serde::Serialize;
use std::collections::BTreeMap;

/// What the texts of the page may ask for.
#[derive(Serialize)]
pub(super) struct Words<'a> {
    pub(super) studies: usize,
    pub(super) null: bool,
    pub(super) signs: &'a [SignRow],
}

pub(super) fn page(
    rehearsal: &Rehearsal,
    options: &Rehearse,
    texts: &PageTexts,
) -> Result<Report, StudyError> {
    let context = Context::synthetic(options.seed);
    let sections = if rehearsal.is_null() {
        let cells = rehearsal.cells.iter().take(1);
        let sections = cells.map(|cell| null_section(cell, texts, &context));
        sections.collect::<Result<Vec<_>, _>>()?
    } else {
        let figures = power_figure(rehearsal, options, texts, &context)?;
        vec![texts.section("power", figures, tables::power_tables(rehearsal, texts)?)?]
    };
    Ok(Report {
        cards: cards(rehearsal)?,
        sections,
        ..texts.page(&context, (options.seed, options.command.as_deref()))?
    })
}

/// What the page opens with: of studies without effects the first size, else the largest.
fn cards(rehearsal: &Rehearsal) -> Result<Vec<Card>, StudyError> {
    let cell = if rehearsal.is_null() { rehearsal.cells.first() } else { rehearsal.largest() };
    let mut cards = Vec::new();
    for (cell, finding) in
        cell.into_iter().flat_map(|c| rehearsal.findings.iter().map(move |f| (c, f)))
    {
        cards.extend(of_studies(cell, finding)?);
    }
    Ok(cards)
}

fn null_section(cell: &Cell, texts: &PageTexts, context: &Context) -> Result<Section, StudyError> {
    let parts = cell.by_part().into_iter().map(|(part, tests)| PartRates {
        name: part.title().to_owned(),
        rates: tests.iter().filter_map(|t| t.rate.map(|r| r.estimate)).collect(),
    });
    let families = cell.families.iter().filter_map(|f| {
        let holm = f.any_holm?;
        Some((f.family.clone(), holm.estimate, (holm.low, holm.high)))
    });
    let input = FalsePositives {
        parts: parts.collect(),
        families: families.collect(),
        studies: cell.studies,
        participants: cell.participants,
    };
    let figures = vec![false_positives(&input, context)?];
    Ok(texts.section("null", figures, tables::null_tables(cell, texts)?)?)
}

fn power_figure(
    rehearsal: &Rehearsal,
    options: &Rehearse,
    texts: &PageTexts,
    context: &Context,
) -> Result<Vec<Figure>, StudyError> {
    let shown: Vec<f64> = options.effect_scales.iter().copied().take(5).collect();
    let point = |(n, rate): (usize, Proportion)| CurvePoint {
        x: n as f64,
        y: rate.estimate,
        low: rate.low,
        high: rate.high,
    };
    let power = texts.text("power")?;
    let panel = |title: String, rate: &dyn Fn(&Cell) -> Option<Proportion>| CurvePanel {
        title,
        y: power.clone(),
        curves: (shown.iter())
            .map(|scale| tables::curve(&rehearsal.cells, *scale, rate).into_iter())
            .map(|curve| curve.map(point).collect())
            .collect(),
    };
    let mut panels: Vec<CurvePanel> = Vec::new();
    if let Some(cell) = rehearsal.largest() {
        panels.extend(
            cell.hypotheses
                .iter()
                .enumerate()
                .map(|(i, h)| panel(h.says.clone(), &|c| c.hypotheses.get(i)?.shown)),
        );
        for test in cell.best_tests() {
            let names = BTreeMap::from([("part", test.part.title()), ("about", &*test.about)]);
            let title = texts.with(&names).text("best")?;
            panels.push(panel(title, &|c| tables::rate_of(c, &test.key)));
        }
    }
    panels.retain(|panel| panel.curves.iter().any(|c| !c.is_empty()));
    if panels.is_empty() {
        return Ok(Vec::new());
    }
    let declared = rehearsal.largest().is_some_and(|c| !c.hypotheses.is_empty());
    let texts = texts.with(&BTreeMap::from([("declared", declared)]));
    let effects = shown.iter().map(|scale| {
        let values = BTreeMap::from([("scale", *scale)]);
        texts.with(&values).text("effects")
    });
    let input = Curves {
        name: "power-curves".to_owned(),
        title: texts.text("curves")?,
        caption: texts.text("curves_caption")?,
        alt: texts.text("curves_alt")?,
        x: texts.text("participants")?,
        curves: effects.collect::<Result<_, _>>()?,
        rule: Some(0.8),
        range: Some((0.0, 1.0)),
        panels,
    };
    Ok(vec![curves(&input, context)?])
}
