//! The page of a validation: its figures and tables.

use super::{Dial, Fidelity, Validate, Validated, tables::over};
use crate::{error::StudyError, stages::report::hashed};
use maveric_pages::{PageTexts, cards::validation::Validation};
use maveric_report::{
    Card, Context, Figure, Report,
    figures::{
        dial_sweep::{DialPanel, DialSweep, dial_sweep},
        fidelity::{Fidelity as FidelityFigure, FidelityRow, fidelity},
    },
    html::Provenance,
    tables::Table,
};
use std::{collections::BTreeMap, path::PathBuf};

/// Tables of retest, identity, standard errors, fidelity and likeness come before those of the dial.
const FIRST_TABLES: usize = 5;

/// What the page opens with.
fn cards(validated: &Validated, points: f64) -> Result<Vec<Card>, StudyError> {
    let Some(first) = validated.models.first() else {
        return Ok(Vec::new());
    };
    let models = || validated.models.iter();
    let validation = Validation {
        fidelity: models().map(|m| m.fidelity.as_slice()).collect(),
        identity: &first.identity,
        dial: &first.dial,
        line: &first.line,
        drivers: validated.drivers,
        collisions: models().map(|m| m.collisions).sum(),
        near: models().map(|m| m.rule_violations).sum(),
        points,
    };
    Ok(validation.cards(&validated.findings)?)
}

pub(super) fn page(
    validated: &Validated,
    options: &Validate,
    (texts, mut tables): (&PageTexts, Vec<Table>),
    warnings: &[String],
) -> Result<Report, StudyError> {
    let context = Context::of(validated.synthetic, options.seed);
    let files = validated.models.iter();
    let files = files.flat_map(|m| std::iter::once(&m.model).chain(&m.same));
    let dial_tables = tables.split_off(FIRST_TABLES.min(tables.len()));
    let new = texts.page(&context, (options.seed, options.command.as_deref()))?;
    Ok(Report {
        cards: cards(validated, options.points)?,
        sections: vec![
            texts.section("identity", fidelity_of(validated, &context)?, tables)?,
            texts.section("dial", dial_of(validated, texts, &context)?, dial_tables)?,
        ],
        warnings: warnings.to_vec(),
        provenance: Provenance {
            parameters: vec![
                ("points".to_owned(), options.points.to_string()),
                ("worlds".to_owned(), options.worlds.to_string()),
            ],
            inputs: hashed(files.map(PathBuf::from))?,
            ..new.provenance
        },
        ..new
    })
}

fn fidelity_of(validated: &Validated, context: &Context) -> Result<Vec<Figure>, StudyError> {
    let models = &validated.models;
    let Some(one) = models.first() else {
        return Ok(Vec::new());
    };
    let accuracy =
        |k: usize, value: fn(&Fidelity) -> Option<f64>| over(models, |m| value(&m.fidelity[k]));
    let rows = one.fidelity.iter().enumerate().filter_map(|(k, row)| {
        Some(FidelityRow {
            measure: row.title.to_owned(),
            car: accuracy(k, |f| f.mimic)?,
            test_retest: accuracy(k, |f| f.test_retest),
            population: accuracy(k, |f| f.population_mean),
            paper: row.paper,
        })
    });
    let input = FidelityFigure {
        measures: rows.collect(),
        drivers: validated.drivers,
        seeds: models.len(),
    };
    Ok(vec![fidelity(&input, context)?])
}

fn dial_of(
    validated: &Validated,
    texts: &PageTexts,
    context: &Context,
) -> Result<Vec<Figure>, StudyError> {
    let Some(one) = validated.models.first() else {
        return Ok(Vec::new());
    };
    let share = |right: &super::Right| texts.with(right).text("share");
    let panel = |dial: &Dial| -> Result<DialPanel, StudyError> {
        let (unit, scale) = match dial.unit {
            "m/s" => (context.speed.name(), context.speed.per_mps()),
            "1" => ("count", 1.0),
            other => (other, 1.0),
        };
        let shares =
            [("aggressive", share(&dial.aggressive)?), ("cautious", share(&dial.cautious)?)];
        Ok(DialPanel {
            title: dial.title.to_owned(),
            axis: unit.to_owned(),
            drivers: dial
                .drivers
                .iter()
                .map(|d| d.iter().map(|v| v.map(|v| scale * v)).collect())
                .collect(),
            statistic: texts.with(&BTreeMap::from(shares)).text("right_way")?,
        })
    };
    let input = DialSweep {
        unit: texts.text("unit")?,
        points: one.steps.clone(),
        panels: one.dial.iter().map(panel).collect::<Result<_, _>>()?,
    };
    Ok(vec![dial_sweep(&input, context)?])
}
