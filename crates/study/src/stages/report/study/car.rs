//! The car's controllers, and the synthetic drivers beside published figures and recordings.

use crate::{atomic_write::read_text, error::StudyError};
use maveric_domain::MetresPerSecond;
use maveric_pages::study::StudyPage;
use maveric_report::{
    Context, Figure,
    figures::{
        lane_change_quality::{LaneChangeQuality, QualityPanel, lane_change_quality},
        step_responses::{StepPanel, StepResponses, step_responses},
    },
    html::Section,
};
use maveric_simulator::{
    Distribution, LaneChangeTracking, Scenario, StepResponse, lane_change_tracking,
    population_table,
};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::Path};

/// People in the table of the population.
const PEOPLE: usize = 1000;
/// Speeds of the lane changes, in m/s.
const SPEEDS_MPS: [f64; 6] = [10.0, 15.0, 20.0, 25.0, 30.0, 35.0];

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

/// The section of the scenario's car and people; published figures only where their file is given.
pub(super) fn section_car(
    scenario: &Scenario,
    sources: Option<&Path>,
    seed: u64,
    page: &StudyPage<'_>,
) -> Result<Section, StudyError> {
    let speeds = SPEEDS_MPS.map(MetresPerSecond);
    let tracked = lane_change_tracking(scenario, &speeds)?;
    let answers = maveric_simulator::step_responses(scenario)?;
    let sources = sources.map(read_sources).transpose()?;
    let synthetic = population_table(&scenario.settings().drivers, PEOPLE, seed);
    let figures = vec![steps(&answers, page.context)?, quality(&tracked, page)?];
    let texts = page.texts.with(&BTreeMap::from([("people", PEOPLE)]));
    let table = texts.table(
        "population",
        population(&synthetic, sources.as_ref(), page)?,
    )?;
    Ok(texts.section("car", figures, vec![table])?)
}

fn read_sources(path: &Path) -> Result<Sources, StudyError> {
    toml::from_str(&read_text(path)?)
        .map_err(|e| StudyError::file(path, format!("not a list of sources: {e}")))
}

fn steps(answers: &[StepResponse], context: &Context) -> Result<Figure, StudyError> {
    let panels = answers.iter().map(panel).collect();
    Ok(step_responses(&StepResponses { panels }, context)?)
}

fn panel(answer: &StepResponse) -> StepPanel {
    let (title, axis) = match answer.name {
        "velocity" => ("Velocity", "Speed (m/s)"),
        "following_gap" => ("Gap, this rule", "Gap (m)"),
        "following_gap_paper" => ("Gap, the paper's rule", "Gap (m)"),
        _ => ("Lane change", "Lateral position (m)"),
    };
    let first = answer.value.first().copied().unwrap_or_default();
    let target = answer.target.last().copied().unwrap_or_default();
    let end = target - answer.steady_state_error;
    let moved = (end - first).abs();
    StepPanel {
        title: title.to_owned(),
        axis: axis.to_owned(),
        unit: answer.unit.to_owned(),
        time_s: answer.time_s.clone(),
        value: answer.value.clone(),
        target: answer.target.clone(),
        end: Some(end),
        overshoot: answer.overshoot_percent / 100.0 * moved,
        settling_s: answer.settling_time_s,
        step_at_s: 0.0,
        band: 0.05 * moved,
        steady_state_error: answer.settling_time_s.map(|_| -answer.steady_state_error),
    }
}

fn quality(tracked: &[LaneChangeTracking], page: &StudyPage<'_>) -> Result<Figure, StudyError> {
    let panel = |title: &str, axis: &str, value: fn(&LaneChangeTracking) -> f64| QualityPanel {
        title: title.to_owned(),
        axis: axis.to_owned(),
        values: tracked.iter().map(value).collect(),
        limit: None,
    };
    let input = LaneChangeQuality {
        speed_mps: tracked.iter().map(|t| t.speed_mps).collect(),
        panels: vec![
            panel("Lateral error", "Largest (m)", |t| {
                t.largest_lateral_error_m
            }),
            panel("Lateral acceleration", "Largest (m/s²)", |t| {
                t.largest_lateral_acceleration_mps2
            }),
            panel("Lateral jerk", "Largest (m/s³)", |t| {
                t.largest_lateral_jerk_mps3
            }),
        ],
        manoeuvre: page.texts.text("lane_changes")?,
    };
    Ok(lane_change_quality(&input, page.context)?)
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
    rows.sort_by_key(|row| {
        quantities
            .iter()
            .position(|quantity| *quantity == row.quantity)
    });
    Ok(rows)
}
