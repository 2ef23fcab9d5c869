//! The page of a validation: its figures and tables.

use super::{Dial, Fidelity, Validate, Validated, tables::over};
use crate::{
    error::StudyError,
    stages::report::{hashed, page_of},
};
use maveric_domain::MetresPerSecond;
use maveric_pages::cards::validation::Validation;
use maveric_report::{
    Card, Context, Figure, Report,
    figures::{
        dial_sweep::{DialPanel, DialSweep, dial_sweep},
        fidelity::{Fidelity as FidelityFigure, FidelityRow, fidelity},
    },
    html::{Provenance, Section},
    tables::Table,
};

/// Tables of retest, identity, standard errors, fidelity and likeness come before those of the dial.
const FIRST_TABLES: usize = 5;

/// What the page opens with.
fn cards(found: &Validated, points: f64) -> Result<Vec<Card>, StudyError> {
    let Some(first) = found.models.first() else {
        return Ok(Vec::new());
    };
    let models = || found.models.iter();
    let validation = Validation {
        fidelity: models().map(|m| m.fidelity.as_slice()).collect(),
        identity: &first.identity,
        dial: &first.dial,
        line: &first.line,
        drivers: found.drivers,
        collisions: models().map(|m| m.collisions).sum(),
        near: models().map(|m| m.rule_violations).sum(),
        points,
    };
    Ok(validation.cards(&found.findings)?)
}

pub(super) fn page(
    found: &Validated,
    options: &Validate,
    mut tables: Vec<Table>,
    warnings: &[String],
) -> Result<Report, StudyError> {
    let context = Context::of(found.synthetic, options.seed);
    let dial_tables = tables.split_off(FIRST_TABLES.min(tables.len()));
    let section = |title: &str, intro: &str, figures, tables| Section {
        title: title.to_owned(),
        intro: vec![intro.to_owned()],
        figures,
        tables,
    };
    let subtitle = format!(
        "{}{} drivers who drove twice, {} trained models",
        context.preface(),
        found.drivers,
        found.models.len()
    );
    let method = format!(
        "Each driver’s two drives were fitted apart, for each model; the car in the own style and {} steps of the dial up to ±{} points drove in {} worlds of \
         their own seeds. docs/validation.md defines every number.",
        found.models.first().map_or(0, |m| m.steps.len()),
        options.points,
        options.worlds
    );
    let new = page_of(
        (question(found.synthetic), subtitle),
        &context,
        method,
        (options.seed, options.command.as_deref().unwrap_or_default()),
    );
    Ok(Report {
        cards: cards(found, options.points)?,
        sections: vec![
            section(
                "Identity and fidelity",
                "Everybody drove twice, on two days and two roads.",
                fidelity_of(found, &context)?,
                tables,
            ),
            section(
                "The dial",
                "The figure shows the first model, the tables all of them.",
                dial_of(found, options, &context)?,
                dial_tables,
            ),
        ],
        warnings: warnings.to_vec(),
        provenance: Provenance {
            parameters: vec![
                ("points".to_owned(), options.points.to_string()),
                ("worlds".to_owned(), options.worlds.to_string()),
            ],
            inputs: hashed(found.models.iter().map(|m| m.model.clone().into()))?,
            ..new.provenance
        },
        ..new
    })
}

/// What is asked: of people who were made up it is known what was put in.
fn question(synthetic: bool) -> &'static str {
    if synthetic {
        "Does the model recover what was put in?"
    } else {
        "Is the learned style the driver’s?"
    }
}

fn fidelity_of(found: &Validated, context: &Context) -> Result<Vec<Figure>, StudyError> {
    let models = &found.models;
    let Some(one) = models.first() else {
        return Ok(Vec::new());
    };
    let of =
        |k: usize, value: fn(&Fidelity) -> Option<f64>| over(models, |m| value(&m.fidelity[k]));
    let rows = one.fidelity.iter().enumerate().filter_map(|(k, row)| {
        Some(FidelityRow {
            measure: row.title.to_owned(),
            car: of(k, |f| f.mimic)?,
            test_retest: of(k, |f| f.test_retest),
            population: of(k, |f| f.population_mean),
            paper: row.paper,
        })
    });
    let input = FidelityFigure {
        measures: rows.collect(),
        drivers: found.drivers,
        seeds: models.len(),
    };
    Ok(vec![fidelity(&input, context)?])
}

fn dial_of(
    found: &Validated,
    options: &Validate,
    context: &Context,
) -> Result<Vec<Figure>, StudyError> {
    let Some(one) = found.models.first() else {
        return Ok(Vec::new());
    };
    let share = |right: &super::Right| {
        right
            .share
            .map_or_else(|| "no value".to_owned(), |s| format!("{:.0}%", 100.0 * s))
    };
    let panel = |dial: &Dial| {
        // Speeds are read in mph by people.
        let (unit, scale) = match dial.unit {
            "m/s" => ("mph", MetresPerSecond(1.0).mph()),
            "1" => ("count", 1.0),
            other => (other, 1.0),
        };
        DialPanel {
            title: dial.title.to_owned(),
            axis: unit.to_owned(),
            drivers: dial
                .drivers
                .iter()
                .map(|d| d.iter().map(|v| v.map(|v| scale * v)).collect())
                .collect(),
            statistic: format!(
                "right way: {} at +{points}, {} at −{points}",
                share(&dial.aggressive),
                share(&dial.cautious),
                points = options.points
            ),
        }
    };
    let input = DialSweep {
        unit: "ADB points".to_owned(),
        points: one.steps.clone(),
        panels: one.dial.iter().map(panel).collect(),
    };
    Ok(vec![dial_sweep(&input, context)?])
}
