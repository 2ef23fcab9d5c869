//! The synthetic drivers beside published figures and recordings.

use crate::{atomic_write::read_text, error::StudyError};
use maveric_pages::study::StudyPage;
use maveric_report::html::Section;
use maveric_simulator::{Distribution, Scenario, population_table};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::Path};

/// People in the table of the population.
const PEOPLE: usize = 1000;

/// `study_data/population_sources.toml`.
#[derive(Debug, Deserialize)]
struct Sources {
    source: Vec<Source>,
    recording: Vec<Recorded>,
}

#[derive(Debug, Deserialize, Serialize)]
struct Source {
    quantity: String,
    unit: String,
    mean: Option<f64>,
    sd: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    citation: String,
    checked: bool,
}

#[derive(Debug, Deserialize, Serialize)]
struct Recorded {
    quantity: String,
    unit: String,
    name: String,
    n: usize,
    mean: f64,
    sd: f64,
    deciles: [f64; 9],
}

/// The section of the scenario's people; published figures only where their file is given.
pub(super) fn section_car(
    scenario: &Scenario,
    sources: Option<&Path>,
    seed: u64,
    page: &StudyPage<'_>,
) -> Result<Section, StudyError> {
    let sources = sources.map(read_sources).transpose()?;
    let synthetic = population_table(&scenario.settings().drivers, PEOPLE, seed);
    let texts = page.texts.with(&BTreeMap::from([("people", PEOPLE)]));
    let table = texts.table("population", population(&synthetic, sources.as_ref(), page)?)?;
    Ok(texts.section("car", Vec::new(), vec![table])?)
}

fn read_sources(path: &Path) -> Result<Sources, StudyError> {
    toml::from_str(&read_text(path)?)
        .map_err(|e| StudyError::file(path, format!("not a list of sources: {e}")))
}

/// Whose quantity it is, and how it lies over them.
#[derive(Serialize)]
struct PopulationRow {
    quantity: String,
    unit: String,
    whose: String,
    n: Option<usize>,
    mean: Option<f64>,
    sd: Option<f64>,
    /// The 10th, 50th and 90th percent.
    tenths: Option<[f64; 3]>,
}

/// A row a source of each quantity; the generated one first.
fn population(
    synthetic: &[Distribution],
    sources: Option<&Sources>,
    page: &StudyPage<'_>,
) -> Result<Vec<PopulationRow>, StudyError> {
    let tenths = |deciles: &[f64; 9]| Some([deciles[0], deciles[4], deciles[8]]);
    let mut rows = Vec::new();
    for d in synthetic {
        rows.push(PopulationRow {
            quantity: d.quantity.to_owned(),
            unit: d.unit.to_owned(),
            whose: page.texts.with(d).text("synthetic_drivers")?,
            n: Some(d.n),
            mean: Some(d.mean),
            sd: Some(d.sd),
            tenths: tenths(&d.deciles),
        });
    }
    // A choice without a publication has no number to show.
    let published = sources.iter().flat_map(|s| &s.source);
    let mut quantities: Vec<String> = rows.iter().map(|row| row.quantity.clone()).collect();
    quantities.extend(published.clone().map(|s| s.quantity.clone()));
    for r in sources.iter().flat_map(|s| &s.recording) {
        quantities.push(r.quantity.clone());
        rows.push(PopulationRow {
            quantity: r.quantity.clone(),
            unit: r.unit.clone(),
            whose: page.texts.with(r).text("recorded_drivers")?,
            n: Some(r.n),
            mean: Some(r.mean),
            sd: Some(r.sd),
            tenths: tenths(&r.deciles),
        });
    }
    for s in published.filter(|s| s.citation != "chosen") {
        rows.push(PopulationRow {
            quantity: s.quantity.clone(),
            unit: s.unit.clone(),
            whose: page.texts.with(s).text("published_drivers")?,
            n: None,
            mean: s.mean,
            sd: s.sd,
            tenths: None,
        });
    }
    rows.sort_by_key(|row| quantities.iter().position(|quantity| *quantity == row.quantity));
    Ok(rows)
}
