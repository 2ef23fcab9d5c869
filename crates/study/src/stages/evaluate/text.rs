//! The tables of an evaluation as lines of text.

use super::tables::{compared, errors, shrinkage, texts};
use crate::error::StudyError;
use maveric_following::{ClosedLoopSeed, ClosedLoopStudy, FollowingEvaluation, FollowingMethod};
use maveric_pages::PageTexts;
use maveric_report::tables::Table;
use serde::Serialize;
use std::collections::BTreeMap;

/// What stands in the table of drivers.
const BY_DRIVER: [(FollowingMethod, &str); 10] = [
    (FollowingMethod::IdmOwn, "IDM own"),
    (FollowingMethod::IdmPopulationOwnTimeGap, "IDM own T"),
    (FollowingMethod::IdmPopulationShrunkenTimeGap, "IDM shr T"),
    (FollowingMethod::IdmPopulation, "IDM pop."),
    (FollowingMethod::FollowingDistanceOwn, "F own"),
    (FollowingMethod::FollowingDistanceMean, "F mean"),
    (FollowingMethod::ClosedLoopOwn, "net own"),
    (FollowingMethod::ClosedLoopShrunken, "net shr"),
    (FollowingMethod::ClosedLoopMean, "net mean"),
    (FollowingMethod::IdmFloor, "floor"),
];

pub(super) fn lines(evaluation: &FollowingEvaluation) -> Result<Vec<String>, StudyError> {
    let texts = &texts(evaluation, None)?;
    let block = |table: &Table| table.to_text().trim_end().to_owned();
    let [means, _] = errors(evaluation, texts)?;
    let mut blocks = vec![
        block(&means),
        texts.text("driven_line")?,
        block(&drivers(evaluation, texts)?),
    ];
    if !evaluation.compared.is_empty() {
        blocks.push(block(&compared(evaluation, texts)?));
    }
    blocks.push(shrinkage(evaluation, texts)?.join("\n"));
    if let Some(study) = &evaluation.closed_loop {
        blocks.push(seeds(study, texts)?.join("\n"));
    }
    blocks.push(harmed(evaluation, texts)?.join("\n"));
    blocks.retain(|block| !block.is_empty());
    Ok(blocks.join("\n\n").lines().map(str::to_owned).collect())
}

#[derive(Serialize)]
struct DriverRow<'a> {
    driver: &'a str,
    errors: Vec<Option<f64>>,
}

fn drivers(evaluation: &FollowingEvaluation, texts: &PageTexts) -> Result<Table, StudyError> {
    let tried = BY_DRIVER.into_iter();
    let tried: Vec<_> = tried
        .filter(|(m, _)| evaluation.mean(*m).is_some())
        .collect();
    let heads: Vec<&str> = tried.iter().map(|(_, head)| *head).collect();
    let rows = evaluation.drivers.iter().map(|d| DriverRow {
        driver: &d.driver,
        errors: tried
            .iter()
            .map(|(method, _)| d.gap_rmse_m(*method))
            .collect(),
    });
    let texts = texts.with(&BTreeMap::from([("tried", heads)]));
    Ok(texts.table("drivers", rows)?)
}

#[derive(Serialize)]
struct Seeds {
    n: usize,
    ranges: Vec<String>,
}

fn seeds(study: &ClosedLoopStudy, texts: &PageTexts) -> Result<Vec<String>, StudyError> {
    let seed_errors: Vec<[f64; 3]> = study.seeds.iter().map(ClosedLoopSeed::gap_rmse_m).collect();
    let range = |at: usize| {
        let values = || seed_errors.iter().map(|seed| seed[at]);
        let mean = values().sum::<f64>() / seed_errors.len() as f64;
        let low = values().fold(f64::INFINITY, f64::min);
        let high = values().fold(f64::NEG_INFINITY, f64::max);
        let range = BTreeMap::from([("mean", mean), ("low", low), ("high", high)]);
        Ok(texts.with(&range).text("range")?)
    };
    let seeds = Seeds {
        n: seed_errors.len(),
        ranges: [0, 1, 2]
            .map(range)
            .into_iter()
            .collect::<Result<_, StudyError>>()?,
    };
    let mut lines = vec![texts.with(&seeds).text("seeds")?];
    if let Some(strangers) = &study.strangers {
        let errors = BTreeMap::from([("errors", strangers.gap_rmse_m())]);
        lines.push(texts.with(&errors).text("strangers")?);
    }
    Ok(lines)
}

#[derive(Serialize)]
struct Harmed<'a> {
    what: String,
    names: Vec<&'a str>,
}

fn harmed(evaluation: &FollowingEvaluation, texts: &PageTexts) -> Result<Vec<String>, StudyError> {
    use FollowingMethod as M;
    let mut lines = Vec::new();
    for (what, own, mean) in [
        (
            "following_distance",
            M::FollowingDistanceOwn,
            M::FollowingDistanceMean,
        ),
        ("closed_loop", M::ClosedLoopOwn, M::ClosedLoopMean),
        (
            "closed_loop_shrunken",
            M::ClosedLoopShrunken,
            M::ClosedLoopMean,
        ),
    ] {
        if evaluation.mean(own).is_some() {
            let harmed = Harmed {
                what: texts.text(what)?,
                names: evaluation.harmed(own, mean),
            };
            lines.push(texts.with(&harmed).text("harmed")?);
        }
    }
    Ok(lines)
}
