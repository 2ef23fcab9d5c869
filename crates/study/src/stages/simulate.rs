//! `simulate`: the learned model drives each condition.

use crate::{
    atomic_write::atomic_write,
    error::StudyError,
    model_planner::ModelPlanner,
    outcome::{Outcome, Watch, for_each_on},
    stages::{generate::read_scenario, train::read_model},
    tables::{
        TableBuilder,
        conditions::{ConditionRow, read_conditions},
        drives::{write_drive, write_drive_list},
    },
};
use maveric_domain::{Drive, DriveId, DriveMeta, DrivenBy, Study, stream_seed};
use maveric_ingest::write_mcap;
use maveric_model::Model;
use maveric_simulator::{Driver, RolloutReport, Scenario, SimulatorError, rollout};
use serde::Serialize;
use std::path::PathBuf;

/// What to drive.
#[derive(Debug, Clone)]
pub struct SimulateOptions {
    /// Trained model.
    pub model: PathBuf,
    /// Conditions to drive.
    pub conditions: PathBuf,
    /// Folder to write into.
    pub out: PathBuf,
    /// World to drive in; the paper's without.
    pub scenario: Option<PathBuf>,
    /// Length of a drive, in s; the scenario's without.
    pub duration_s: Option<f64>,
    /// Root of every random choice.
    pub seed: u64,
    /// Threads.
    pub jobs: usize,
}

/// What was driven.
#[derive(Debug, Clone, Serialize)]
pub struct Simulated {
    /// Drives.
    pub drives: usize,
    /// Collisions over all drives.
    pub collisions: usize,
    /// Violations of the safety rule over all drives.
    pub rule_violations: usize,
    /// Interventions of the safety layer over all drives.
    pub interventions: usize,
}

/// Drives every condition and writes logs, drives and what was counted in each.
///
/// A drive that a set-point which is no number ended early is left out, with a row of `drives/exclusions.csv`.
///
/// # Errors
/// [`StudyError`] if model, conditions or scenario cannot be read, an embedding does not fit the model, or every drive
/// ended early.
pub fn simulate(
    options: &SimulateOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Simulated>, StudyError> {
    let model = read_model(&options.model)?;
    let conditions = read_conditions(&options.conditions)?;
    let mut names = std::collections::BTreeSet::new();
    for row in &conditions {
        let drive = row.drive()?;
        if !names.insert(drive.clone()) {
            let problem = format!("two rows are drive {drive}, expected a name for each");
            return Err(StudyError::file(&options.conditions, problem));
        }
    }
    let scenario = read_scenario(options.scenario.as_deref(), options.duration_s)?;
    let driven = for_each_on(options.jobs, &conditions, watch, "drives", |row| {
        drive(options, &model, &scenario, row)
    })?;
    let mut stopped = Vec::new();
    let driven: Vec<Driven> = driven
        .into_iter()
        .filter_map(|ended| ended.map_err(|why| stopped.push(why)).ok())
        .collect();
    TableBuilder::default()
        .text("drive", stopped.iter().map(|(drive, _)| drive.as_str()))
        .text("what", stopped.iter().map(|(_, why)| why.to_string()))
        .write(&options.out.join("drives").join("exclusions.csv"))?;
    let ended_early = stopped.len();
    if let (true, Some((_, why))) = (driven.is_empty(), stopped.pop()) {
        return Err(why.into());
    }
    let list: Vec<(DriveMeta, usize, f64)> =
        driven.iter().map(|d| (d.0.clone(), d.1, d.2)).collect();
    write_drive_list(&options.out.join("drives"), &list)?;
    let counts =
        |of: fn(&RolloutReport) -> u32| driven.iter().map(move |d| Some(i64::from(of(&d.3))));
    TableBuilder::default()
        .text("drive", driven.iter().map(|d| d.0.drive.as_str()))
        .integers("collisions", counts(|r| r.collisions))
        .integers("rule_violations", counts(|r| r.rule_violations))
        .integers("interventions", counts(|r| r.interventions))
        .integers("held_changes", counts(|r| r.held_changes))
        .integers("given_up_changes", counts(|r| r.given_up_changes))
        .integers("started_changes", counts(|r| r.started_changes))
        .integers("leads", counts(|r| r.leads))
        .write(&options.out.join("rollouts.csv"))?;
    let total =
        |of: fn(&RolloutReport) -> u32| driven.iter().map(|d| of(&d.3) as usize).sum::<usize>();
    let value = Simulated {
        drives: driven.len(),
        collisions: total(|r| r.collisions),
        rule_violations: total(|r| r.rule_violations),
        interventions: total(|r| r.interventions),
    };
    let collisions = (value.collisions > 0)
        .then(|| format!("{} collisions: see rollouts.csv", value.collisions));
    let early = (ended_early > 0).then(|| {
        format!("{ended_early} drives ended early and are left out: see drives/exclusions.csv")
    });
    let summary = vec![format!(
        "{} AV drives, {} collisions, {} safety interventions: {}",
        value.drives,
        value.collisions,
        value.interventions,
        options.out.display()
    )];
    Ok(Outcome {
        value,
        summary,
        warnings: collisions.into_iter().chain(early).collect(),
    })
}

type Driven = (DriveMeta, usize, f64, RolloutReport);

/// A drive that ended early, and why.
type Stopped = (DriveId, SimulatorError);

fn drive(
    options: &SimulateOptions,
    model: &Model,
    scenario: &Scenario,
    row: &ConditionRow,
) -> Result<Result<Driven, Stopped>, StudyError> {
    let mut planner = ModelPlanner::new(model, &row.embedding)?;
    let id = row.drive()?;
    let seed = stream_seed(options.seed, &[id.as_str(), "world"]);
    let driven = rollout(
        scenario,
        Driver::Automated(&mut planner, &scenario.settings().controllers),
        seed,
    )?;
    if let Some(error) = planner.failure() {
        return Err(error.into());
    }
    if let Some(why) = driven.stopped {
        return Ok(Err((id, why)));
    }
    let meta = DriveMeta {
        drive: id,
        participant: row.participant.clone(),
        study: Study::Two,
        condition: row.condition,
        driven_by: DrivenBy::Automated,
    };
    let log = options
        .out
        .join("logs")
        .join(format!("{}.mcap", meta.drive));
    atomic_write(&log, |file| Ok(write_mcap(&driven.recording, &meta, file)?))?;
    let made = Drive::from_recording(meta.clone(), &driven.recording)?;
    write_drive(&options.out.join("drives"), &made)?;
    let duration = made.rows().time_s.last().copied().unwrap_or(0.0);
    Ok(Ok((meta, made.len(), duration, driven.report)))
}
