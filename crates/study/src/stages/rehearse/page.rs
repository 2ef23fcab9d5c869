//! The page of a rehearsal: its figures and tables.

use super::{Cell, Part, Rehearsal, RehearseOptions, tables};
use crate::error::StudyError;
use maveric_report::{
    Context, Figure, Report,
    figures::{
        curves::{CurvePanel, CurvePoint, Curves, curves},
        false_positives::{FalsePositives, PartRates, false_positives},
    },
    html::{Methods, Provenance, Section},
};

/// The tests whose power is drawn: of each part that which most studies found, at the largest size and the planted effects.
fn drawn(found: &Rehearsal) -> Vec<(String, String)> {
    let largest = |c: &&Cell| (c.effect_scale - 1.0).abs() < 1e-12;
    let Some(cell) = found.cells.iter().rfind(largest).or(found.cells.last()) else {
        return Vec::new();
    };
    let best = |part: Part| {
        let mut of_part = cell.tests.iter().filter(|t| t.part == part);
        let first = of_part.next()?;
        let most = of_part.fold(
            first,
            |best, t| if t.rejected > best.rejected { t } else { best },
        );
        Some((most.key.clone(), format!("{}: {}", part.title(), most.key)))
    };
    Part::ALL.into_iter().filter_map(best).collect()
}

pub(super) fn page(found: &Rehearsal, options: &RehearseOptions) -> Result<Report, StudyError> {
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
                "Effects × 1 are those planted in study_data/effects.toml and study_data/population.toml. They are made up, at about the \
                 sizes that the paper reports: this says what the paper’s design can show if effects are of that size, and nothing about people."
                    .to_owned(),
            ],
            figures: power_figure(found, options, &context)?,
            tables: tables::power_tables(found),
        }]
    };
    Ok(Report {
        title: if found.is_null() {
            "How often do the tests find what is not there?".to_owned()
        } else {
            "How many people would it have needed?".to_owned()
        },
        subtitle: format!(
            "Synthetic participants: {} studies of each size and scale of the effects, at the level of measures and ratings, not driven",
            options.studies
        ),
        context,
        summary: Vec::new(),
        live: Vec::new(),
        methods: Methods {
            text: vec!["Measures and ratings are drawn from a fitted population and analysed by the code that analyses a run; docs/null-and-power.md gives the generator and its sources.".to_owned()],
            files: Vec::new(),
        },
        sections,
        ledger: None,
        exclusions: Vec::new(),
        warnings: Vec::new(),
        provenance: Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            seed: Some(options.seed),
            command: options.command.clone(),
            parameters: Vec::new(),
            inputs: Vec::new(),
        },
    })
}

fn null_section(cell: &Cell, context: &Context) -> Result<Section, StudyError> {
    let parts = tables::by_part(cell)
        .into_iter()
        .map(|(part, tests)| PartRates {
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
    options: &RehearseOptions,
    context: &Context,
) -> Result<Vec<Figure>, StudyError> {
    let shown: Vec<f64> = options.effect_scales.iter().copied().take(5).collect();
    let points = |scale: f64, key: &str| -> Vec<CurvePoint> {
        let rates = tables::curve(&found.cells, scale, key).into_iter();
        rates
            .map(|(n, r)| CurvePoint {
                x: n as f64,
                y: r.estimate,
                low: r.low,
                high: r.high,
            })
            .collect()
    };
    let panels: Vec<CurvePanel> = drawn(found)
        .into_iter()
        .map(|(key, title)| CurvePanel {
            title,
            y: "Power".to_owned(),
            curves: shown.iter().map(|scale| points(*scale, &key)).collect(),
        })
        .filter(|panel| panel.curves.iter().any(|c| !c.is_empty()))
        .collect();
    if panels.is_empty() {
        return Ok(Vec::new());
    }
    let reached: Vec<String> = found
        .signs
        .iter()
        .filter_map(|row| Some(format!("{}: {:.0} people.", row.text, row.n_for_80?)))
        .collect();
    let input = Curves {
        name: "power-curves".to_owned(),
        title: "Power by number of participants".to_owned(),
        caption: format!(
            "Share of {} synthetic studies with *p* < .05 (uncorrected), 95% intervals; dashed: .8.",
            options.studies
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
