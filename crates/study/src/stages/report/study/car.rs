//! The car's controllers, and the synthetic drivers beside published figures and recordings.

use crate::{atomic_write::read_text, error::StudyError};
use maveric_domain::MetresPerSecond;
use maveric_report::{
    Context, Figure,
    figures::{
        lane_change_quality::{LaneChangeQuality, QualityPanel, lane_change_quality},
        step_responses::{StepPanel, StepResponses, step_responses},
    },
    html::Section,
    tables::{Cell, Column, Table},
};
use maveric_simulator::{
    Distribution, LaneChangeTracking, Scenario, StepResponse, lane_change_tracking,
    population_table,
};
use serde::Deserialize;
use std::path::Path;

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

#[derive(Debug, Deserialize)]
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

#[derive(Debug, Deserialize)]
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
    context: &Context,
) -> Result<Section, StudyError> {
    let speeds = SPEEDS_MPS.map(MetresPerSecond);
    let tracked = lane_change_tracking(scenario, &speeds)?;
    let answers = maveric_simulator::step_responses(scenario)?;
    let sources = sources.map(read_sources).transpose()?;
    let made = population_table(&scenario.settings().drivers, PEOPLE, seed);
    Ok(Section {
        title: "The car and its drivers".to_owned(),
        intro: vec![
            "The networks ask for a speed, a gap and the moment of a lane change; these controllers carry it out. The gap is shown twice: \
             by the rule of this scenario, and by the paper's, in which the following controller takes part below λ only and the gap settles \
             near λ."
                .to_owned(),
        ],
        figures: vec![steps(&answers, context)?, quality(&tracked, context)?],
        tables: vec![population(&made, sources.as_ref())],
    })
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
    let band = 0.05 * (end - first).abs();
    // The band stands round what was asked for: what ends outside it has not settled there.
    let settled = answer.steady_state_error.abs() <= band;
    StepPanel {
        title: title.to_owned(),
        axis: axis.to_owned(),
        unit: answer.unit.to_owned(),
        time_s: answer.time_s.clone(),
        value: answer.value.clone(),
        target: answer.target.clone(),
        overshoot: answer.overshoot_percent / 100.0 * (end - first).abs(),
        settling_s: answer.settling_time_s.filter(|_| settled),
        step_at_s: 0.0,
        band,
        steady_state_error: answer
            .settling_time_s
            .filter(|_| settled)
            .map(|_| -answer.steady_state_error),
    }
}

fn quality(tracked: &[LaneChangeTracking], context: &Context) -> Result<Figure, StudyError> {
    let panel = |title: &str, axis: &str, of: fn(&LaneChangeTracking) -> f64| QualityPanel {
        title: title.to_owned(),
        axis: axis.to_owned(),
        values: tracked.iter().map(of).collect(),
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
        manoeuvre:
            "Changes to the left on a straight road over the longest duration of the scenario."
                .to_owned(),
    };
    Ok(lane_change_quality(&input, context)?)
}

/// A row a source of each quantity; the generated one first.
fn population(made: &[Distribution], sources: Option<&Sources>) -> Table {
    let mut quantities: Vec<&str> = made.iter().map(|d| d.quantity).collect();
    if let Some(sources) = sources {
        let others = sources.source.iter().map(|s| s.quantity.as_str());
        let recorded = sources.recording.iter().map(|r| r.quantity.as_str());
        for name in others.chain(recorded) {
            if !quantities.contains(&name) {
                quantities.push(name);
            }
        }
    }
    let mut rows = Vec::new();
    for quantity in quantities {
        rows.extend(made.iter().filter(|d| d.quantity == quantity).map(|d| {
            let tenths = [d.deciles[0], d.deciles[4], d.deciles[8]];
            let label = format!("synthetic, retest r = {}", retest(d));
            row(
                quantity,
                d.unit,
                &label,
                [Some(d.mean), Some(d.sd)],
                Some(d.n),
                Some(tenths),
            )
        }));
        let Some(sources) = sources else { continue };
        rows.extend(
            sources
                .recording
                .iter()
                .filter(|r| r.quantity == quantity)
                .map(|r| {
                    let tenths = [r.deciles[0], r.deciles[4], r.deciles[8]];
                    let label = format!("recorded: {}", r.name);
                    row(
                        quantity,
                        &r.unit,
                        &label,
                        [Some(r.mean), Some(r.sd)],
                        Some(r.n),
                        Some(tenths),
                    )
                }),
        );
        // A choice without a publication has no number to show.
        let published = |s: &&Source| s.quantity == quantity && s.citation != "chosen";
        rows.extend(sources.source.iter().filter(published).map(|s| {
            let range = match (s.low, s.high) {
                (Some(low), Some(high)) => format!(", range {low} to {high}"),
                _ => String::new(),
            };
            let read = if s.checked {
                ""
            } else {
                ", not read at its source"
            };
            let label = format!("{}{range}{read}", s.citation);
            row(quantity, &s.unit, &label, [s.mean, s.sd], None, None)
        }));
    }
    let title = "Synthetic drivers beside published figures and recordings";
    Table {
        columns: ["Quantity", "Of"]
            .map(Column::left)
            .into_iter()
            .chain(["*n*", "*M*", "*SD*", "10%", "50%", "90%"].map(Column::right))
            .collect(),
        rows,
        ..Table::of::<()>("population", title, []).noted(format!(
            "Synthetic: parameters of {PEOPLE} people drawn from the scenario’s population; retest *r*: the same people on two days. *M* and *SD* over \
             drivers. The population was not fitted to the others: a dash is what a source does not give, or what could not be read."
        ))
    }
}

fn retest(d: &Distribution) -> String {
    d.retest_r.map_or_else(
        || "none".to_owned(),
        |r| format!("{r:.2}").trim_start_matches('0').to_owned(),
    )
}

fn row(
    quantity: &str,
    unit: &str,
    of: &str,
    [mean, sd]: [Option<f64>; 2],
    n: Option<usize>,
    tenths: Option<[f64; 3]>,
) -> Vec<Cell> {
    let [low, middle, high] = tenths.map_or([None; 3], |values| values.map(Some));
    vec![
        Cell::text(format!("{} ({unit})", quantity.replace('_', " "))),
        Cell::text(of),
        n.map_or(Cell::Missing, Cell::count),
        Cell::number(mean, 2),
        Cell::number(sd, 2),
        Cell::number(low, 2),
        Cell::number(middle, 2),
        Cell::number(high, 2),
    ]
}
