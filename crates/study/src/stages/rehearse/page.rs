//! The page of a rehearsal: its figures and tables.

use super::{Cell, Rehearsal, Rehearse, tables};
use crate::{error::StudyError, stages::report::page_of};
use maveric_pages::cards::rehearsal::of_studies;
use maveric_report::{
    Card, Context, Figure, Report,
    figures::{
        curves::{CurvePanel, CurvePoint, Curves, curves},
        false_positives::{FalsePositives, PartRates, false_positives},
    },
    html::Section,
};

pub(super) fn page(found: &Rehearsal, options: &Rehearse) -> Result<Report, StudyError> {
    let context = Context::synthetic(options.seed);
    let sections = if found.is_null() {
        let sections = found
            .cells
            .iter()
            .take(1)
            .map(|cell| null_section(cell, &context));
        sections.collect::<Result<Vec<_>, _>>()?
    } else {
        vec![Section {
            title: "Power".to_owned(),
            intro: vec![
                "Effects × 1 are those that the made-up people were given, at about the sizes that the paper reports: this says what this design \
                 can show if effects are of that size, and nothing about people."
                    .to_owned(),
            ],
            figures: power_figure(found, options, &context)?,
            tables: tables::power_tables(found),
        }]
    };
    let title = if found.is_null() {
        "How often do the tests find what is not there?"
    } else {
        "How many people would it have needed?"
    };
    let subtitle = format!(
        "Synthetic participants: {} studies of each size and scale of the effects, at the level of measures and ratings, not driven",
        options.studies
    );
    let method = "Measures and ratings are drawn from a fitted population and analysed by the code that analyses a run; docs/rehearsal.md gives the generator and its sources.";
    Ok(Report {
        cards: cards(found)?,
        sections,
        ..page_of(
            (title, subtitle),
            &context,
            method,
            (options.seed, options.command.as_deref().unwrap_or_default()),
        )
    })
}

/// What the page opens with: of studies without effects the first size, else the largest.
fn cards(found: &Rehearsal) -> Result<Vec<Card>, StudyError> {
    let cell = if found.is_null() {
        found.cells.first()
    } else {
        found.largest()
    };
    let mut cards = Vec::new();
    for (cell, finding) in cell
        .into_iter()
        .flat_map(|c| found.findings.iter().map(move |f| (c, f)))
    {
        cards.extend(of_studies(cell, finding)?);
    }
    Ok(cards)
}

fn null_section(cell: &Cell, context: &Context) -> Result<Section, StudyError> {
    let parts = cell.by_part().into_iter().map(|(part, tests)| PartRates {
        name: part.title().to_owned(),
        rates: tests
            .iter()
            .filter_map(|t| t.rate.map(|r| r.estimate))
            .collect(),
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
    Ok(Section {
        title: "False positives".to_owned(),
        intro: vec![
            "No condition differs from another, no trait tells anything of a rating, no order, no halo: what is below .05 is there by chance. \
             A test of ranks cannot reach every level: with 24 people and ties its true level may lie a little below .05."
                .to_owned(),
        ],
        figures: vec![false_positives(&input, context)?],
        tables: tables::null_tables(cell),
    })
}

fn power_figure(
    found: &Rehearsal,
    options: &Rehearse,
    context: &Context,
) -> Result<Vec<Figure>, StudyError> {
    let shown: Vec<f64> = options.effect_scales.iter().copied().take(5).collect();
    let points = |scale: f64,
                  rate: &dyn Fn(&Cell) -> Option<maveric_stats::Proportion>|
     -> Vec<CurvePoint> {
        let rates = tables::curve(&found.cells, scale, rate).into_iter();
        rates
            .map(|(n, r)| CurvePoint {
                x: n as f64,
                y: r.estimate,
                low: r.low,
                high: r.high,
            })
            .collect()
    };
    let panel =
        |title: String, rate: &dyn Fn(&Cell) -> Option<maveric_stats::Proportion>| CurvePanel {
            title,
            y: "Power".to_owned(),
            curves: shown.iter().map(|scale| points(*scale, rate)).collect(),
        };
    let mut panels: Vec<CurvePanel> = Vec::new();
    if let Some(cell) = found.largest() {
        panels.extend(
            cell.hypotheses
                .iter()
                .enumerate()
                .map(|(i, h)| panel(h.says.clone(), &|c| c.hypotheses.get(i)?.shown)),
        );
        panels.extend(cell.best_tests().into_iter().map(|test| {
            let title = format!("{}: {}", test.part.title(), test.key);
            panel(title, &|c| tables::rate_of(c, &test.key))
        }));
    }
    panels.retain(|panel| panel.curves.iter().any(|c| !c.is_empty()));
    if panels.is_empty() {
        return Ok(Vec::new());
    }
    let declared = found.largest().is_some_and(|c| !c.hypotheses.is_empty());
    let reached: Vec<String> = found
        .signs
        .iter()
        .filter_map(|row| Some(format!("{}: {:.0} people.", row.text, row.n_for_80?)))
        .collect();
    let input = Curves {
        name: "power-curves".to_owned(),
        title: "Power by number of participants".to_owned(),
        caption: format!(
            "Share of {} synthetic studies{}, 95% intervals; dashed: .8.",
            options.studies,
            if declared {
                " in which a declared hypothesis is shown by its own rule, then of those in which the best test of each part has *p* < .05 (uncorrected)"
            } else {
                " with *p* < .05 (uncorrected), by the best test of each part"
            }
        ),
        alt: format!(
            "For a power of .8 at the planted sizes: {}",
            reached.join(" ")
        ),
        x: "Participants".to_owned(),
        curves: shown.iter().map(|s| format!("effects × {s}")).collect(),
        rule: Some(0.8),
        range: Some((0.0, 1.0)),
        panels,
    };
    Ok(vec![curves(&input, context)?])
}
