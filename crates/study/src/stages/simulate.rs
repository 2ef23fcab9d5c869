//! `simulate`: the learned model drives each condition.

mod logs;

pub use logs::Scenes;

use crate::{
    atomic_write::write_recording,
    beyond,
    design::DesignFile,
    error::StudyError,
    forget::refuse_learned_from_gone,
    once::count,
    outcome::{Outcome, Watch, for_each_on},
    run_folder::{read_model, read_scenario},
    stage::{Files, Stage},
    tables::{
        TableName,
        conditions::{ConditionRow, read_conditions},
        drives::{
            EndedEarly, former_drives, refuse_foreign, remove_former, write_drive, write_drive_list,
        },
        variability::read_variability,
        write_rows,
    },
    watching::{WatchedDrive, braking, read_watched, write_watch_page},
};
use logs::{Logged, known, log_of};
use maveric_domain::{
    BeyondWhy, Drive, DriveId, DriveMeta, DrivenBy, Embedding, Occasion, ParticipantId, Recording,
    Variability, design::Condition, stream_seed,
};
use maveric_ingest::{Beside, IngestSettings};
use maveric_model::Model;
use maveric_report::html::CentreLine;
use maveric_simulator::{Driver, Rollout, RolloutReport, Scenario, SimulatorError, rollout};
use maveric_steering::{ModelPlanner, Varying};
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

/// Drive each participant's conditions in the simulator
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric simulate --model model.maveric --conditions conditions.csv --out av --watch P07.html --watch-participant P07"
)]
pub struct Simulate {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given. Without either every condition is driven
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Trained model
    #[arg(long)]
    pub model: PathBuf,
    /// Conditions to drive
    #[arg(long)]
    pub conditions: PathBuf,
    /// How people's own drives wander, for the conditions of the design whose car varies: see `personalize --variability`
    #[arg(long, value_name = "FILE")]
    pub variability: Option<PathBuf>,
    /// Folder to write into: drives (Parquet), logs (MCAP) of whom the report shows, rollouts.csv
    #[arg(long)]
    pub out: PathBuf,
    /// World to drive in (TOML); the paper's when not given
    #[arg(long)]
    pub scenario: Option<PathBuf>,
    /// Length of a drive, in s; the scenario's when not given
    #[arg(long = "duration", value_name = "DURATION")]
    pub duration_s: Option<f64>,
    /// Write a page that plays one participant's conditions from above, side by side
    #[arg(long, value_name = "FILE.html")]
    pub watch: Option<PathBuf>,
    /// Whose conditions to watch; the first participant's when not given
    #[arg(long, value_name = "PARTICIPANT", requires = "watch")]
    pub watch_participant: Option<String>,
    /// Log of that participant's own drive, to be shown first
    #[arg(long, value_name = "LOG", requires = "watch")]
    pub watch_own: Option<PathBuf>,
    /// Write logs (MCAP) of everybody, or of one participant; without it only of the one whom the report shows, in the middle of all
    #[arg(long, value_name = "PARTICIPANT", num_args = 0..=1, default_missing_value = "all")]
    pub logs: Option<Scenes>,
    /// Write logs with a scene for Foxglove and Lichtblick: everybody's, or one participant's
    #[arg(long = "scene", value_name = "PARTICIPANT", num_args = 0..=1, default_missing_value = "all")]
    pub scenes: Option<Scenes>,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
}

/// What was driven.
#[derive(Debug, Clone, Serialize)]
pub struct Simulated {
    /// Drives that came to their end.
    pub drives: usize,
    /// Collisions over all drives.
    pub collisions: usize,
    /// Violations of the safety rule over all drives.
    pub rule_violations: usize,
    /// Interventions of the safety layer over all drives.
    pub interventions: usize,
    /// People whose style the car drives though their own drive is beyond what the model has learned from.
    pub beyond: Vec<ParticipantId>,
}

impl Stage for Simulate {
    const NAME: &'static str = "simulate";
    const FAILURE: &'static str = "could not simulate";
    type Result = Simulated;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        let tables = ["drives/drives.csv", "drives/exclusions.csv", "rollouts.csv"];
        Ok(Files::default()
            .reads([&self.model, &self.conditions])
            .reads(&self.variability)
            .reads(&self.scenario)
            .reads(&self.watch_own)
            .reads_design(self.design.as_deref())
            .writes_into(&self.out, &tables)
            .writes(&self.watch))
    }

    /// Drives every condition and writes logs, drives and what was counted in each.
    ///
    /// A drive that a set-point which is no number ended early is left out, with a row of `drives/exclusions.csv`.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Simulated>, StudyError> {
        let study = DesignFile::here(self.design.as_deref())?;
        if let Some(study) = &study {
            refuse_learned_from_gone(study, &self.model)?;
        }
        let model = read_model(&self.model)?;
        let conditions = self.conditions_to_drive(study.as_ref())?;
        let people = || conditions.iter().map(|row| &row.participant);
        for whose in self.scenes.iter().chain(&self.logs) {
            whose.check(people())?;
        }
        let logged = Logged::new(self, &conditions);
        let watched = self.watch.as_ref().and_then(|_| {
            let first = || people().next().map(ToString::to_string);
            self.watch_participant.clone().or_else(first)
        });
        if let Some(participant) = &watched {
            known(participant, people())?;
        }
        let scenario = read_scenario(self.scenario.as_deref(), self.duration_s)?;
        let rides = self.rides(study.as_ref(), &conditions)?;
        let ended = for_each_on(self.jobs, &rides, watch, "drives", |ride| {
            let who = &ride.row.participant;
            let is_watched = watched.as_deref() == Some(who.as_str());
            drive(self, &model, &scenario, ride, logged.cover(who), is_watched)
        })?;
        let mut stopped = Vec::new();
        let driven: Vec<Driven> = ended
            .into_iter()
            .filter_map(|ended| ended.map_err(|why| stopped.push(why)).ok())
            .collect();
        let ended_early = stopped.len();
        self.write(&driven, stopped, &logged)?;
        if let Some(page) = &self.watch {
            write_page(self, page, &driven)?;
        }
        let strangers = strangers(&conditions);
        let value = Simulated::from_drives(&driven, &strangers);
        let mut summary = vec![format!(
            "{} AV drives, {} collisions, {} safety interventions: {}",
            value.drives,
            value.collisions,
            value.interventions,
            self.out.to_slash_lossy()
        )];
        if let (Some(page), Some(participant)) = (&self.watch, &watched) {
            summary.push(format!(
                "drives of {participant} to watch: {}",
                page.to_slash_lossy()
            ));
        }
        let warnings = warnings(&value, ended_early, &strangers);
        Ok(Outcome::new(value, summary, warnings))
    }
}

impl Simulated {
    fn from_drives(driven: &[Driven], strangers: &BTreeMap<&ParticipantId, &BeyondWhy>) -> Self {
        let total = |count: fn(&RolloutReport) -> u32| {
            driven.iter().map(|d| count(&d.report) as usize).sum()
        };
        Self {
            drives: driven.len(),
            collisions: total(|r| r.collisions),
            rule_violations: total(|r| r.rule_violations),
            interventions: total(|r| r.interventions),
            beyond: strangers.keys().map(|who| (*who).clone()).collect(),
        }
    }
}

fn warnings(
    value: &Simulated,
    ended_early: usize,
    strangers: &BTreeMap<&ParticipantId, &BeyondWhy>,
) -> Vec<String> {
    let collisions = (value.collisions > 0)
        .then(|| format!("{} collisions: see rollouts.csv", value.collisions));
    let early = (ended_early > 0).then(|| {
        format!(
            "{} left out: see drives/exclusions.csv",
            count(
                ended_early,
                "drive ended early and is",
                "drives ended early and are"
            )
        )
    });
    let beyond = beyond::named(
        "participant",
        strangers.iter().map(|(who, why)| (who.to_string(), *why)),
        "; the car drives all the same, in a style that says little of this person",
    );
    collisions.into_iter().chain(early).chain(beyond).collect()
}

/// Whoever's style is driven though their own drive is beyond what the model has learned from.
fn strangers(conditions: &[ConditionRow]) -> BTreeMap<&ParticipantId, &BeyondWhy> {
    conditions
        .iter()
        .filter_map(|row| Some((&row.participant, row.beyond_why.as_ref()?)))
        .collect()
}

impl Simulate {
    /// The rows to drive: of a sweep all, since the design does not name them; of what it names, only what is not recorded elsewhere.
    fn conditions_to_drive(
        &self,
        study: Option<&DesignFile>,
    ) -> Result<Vec<ConditionRow>, StudyError> {
        let mut conditions = read_conditions(&self.conditions)?;
        if let Some(study) = study {
            let simulated = |id| study.design.condition(id).is_some_and(Condition::simulated);
            conditions.retain(|row| row.sweep.is_some() || simulated(row.condition));
            if conditions.is_empty() {
                let problem = "holds no condition that the design lets the program drive";
                return Err(StudyError::file(&self.conditions, problem));
            }
        }
        Ok(conditions)
    }

    /// A ride of each condition in each session and trial, every one with a name of its own, and so in another world.
    fn rides<'a>(
        &self,
        study: Option<&DesignFile>,
        conditions: &'a [ConditionRow],
    ) -> Result<Vec<Ride<'a>>, StudyError> {
        let varying = self.varying(study, conditions)?;
        let (mut rides, mut names) = (Vec::new(), BTreeSet::new());
        for (row, varying) in conditions.iter().zip(varying) {
            let occasions = match study {
                Some(study) if row.sweep.is_none() => study.design.occasions(row.condition),
                _ => vec![Occasion::FIRST],
            };
            for occasion in occasions {
                let id = row.drive_on(occasion)?;
                if !names.insert(id.clone()) {
                    let problem = format!("two rows are drive {id}, expected a name for each");
                    return Err(StudyError::file(&self.conditions, problem));
                }
                rides.push(Ride {
                    row,
                    id,
                    occasion,
                    varying,
                });
            }
        }
        refuse_foreign(&self.out.join("drives"), names.iter().map(DriveId::as_str))?;
        Ok(rides)
    }

    /// Writes what was driven and what ended early, and removes logs that an earlier run wrote and this one does not.
    ///
    /// # Errors
    /// Why the last drive ended, where no drive is left; a file that cannot be written.
    fn write(
        &self,
        driven: &[Driven],
        mut stopped: Vec<Stopped>,
        logged: &Logged<'_>,
    ) -> Result<(), StudyError> {
        let drives = self.out.join("drives");
        let ended = stopped.iter().map(|(drive, why)| EndedEarly {
            drive: drive.to_string(),
            what: why.to_string(),
        });
        write_rows(TableName::EndedEarly, &drives.join("exclusions.csv"), ended)?;
        if let (true, Some((_, why))) = (driven.is_empty(), stopped.pop()) {
            return Err(why.into());
        }
        let unlogged = driven.iter().map(|d| &d.meta);
        let unlogged = unlogged.filter(|meta| !logged.cover(&meta.participant));
        let unlogged = unlogged.map(|meta| meta.drive.clone());
        for gone in former_drives(&drives, driven.iter().map(|d| d.meta.drive.as_str()))
            .into_iter()
            .chain(unlogged)
        {
            remove_former(&log_of(&self.out, gone.as_str()))?;
        }
        let list: Vec<(DriveMeta, usize, f64)> = driven
            .iter()
            .map(|d| (d.meta.clone(), d.rows, d.duration_s))
            .collect();
        write_drive_list(&drives, &list)?;
        let rollouts = driven.iter().map(|d| (("drive", &d.meta.drive), &d.report));
        write_rows(
            TableName::Rollouts,
            &self.out.join("rollouts.csv"),
            rollouts,
        )
    }

    /// What wanders in each of `conditions`: as in the person's own drive where the design says so, nothing elsewhere.
    fn varying(
        &self,
        study: Option<&DesignFile>,
        conditions: &[ConditionRow],
    ) -> Result<Vec<Option<Variability>>, StudyError> {
        let design = study.map(|s| &s.design);
        let varies = |row: &ConditionRow| {
            let condition = design.and_then(|d| d.condition(row.condition));
            row.sweep.is_none() && condition.is_some_and(|c| c.vary)
        };
        let Some(first) = conditions.iter().find(|row| varies(row)) else {
            return Ok(vec![None; conditions.len()]);
        };
        let Some(path) = &self.variability else {
            let problem = format!(
                "the car of condition {} varies, and nothing says how people's own drives do",
                first.condition
            );
            let help = "write it with `maveric personalize --variability FILE` and give it with --variability FILE";
            return Err(StudyError::not_possible(problem).with_help(help));
        };
        let known = read_variability(path)?;
        let baseline = design.and_then(maveric_domain::Design::baseline_id);
        let variability = |row: &ConditionRow| {
            if !varies(row) {
                return Ok(None);
            }
            let by_hand = known
                .iter()
                .find(|k| k.participant == row.participant && Some(k.condition) == baseline);
            by_hand.map(|k| Some(k.variability())).ok_or_else(|| {
                let whose = &row.participant;
                StudyError::file(
                    path,
                    format!("has no row of the own drive of participant {whose}"),
                )
            })
        };
        conditions.iter().map(variability).collect()
    }
}

struct Ride<'a> {
    row: &'a ConditionRow,
    id: DriveId,
    occasion: Occasion,
    varying: Option<Variability>,
}

/// A drive that was driven to its end; with what the page plays where it is watched.
struct Driven {
    meta: DriveMeta,
    rows: usize,
    duration_s: f64,
    report: RolloutReport,
    watched: Option<WatchedDrive>,
}

/// Writes the page that plays the drives kept for it, the own drive first.
fn write_page(options: &Simulate, page: &Path, driven: &[Driven]) -> Result<(), StudyError> {
    let mut drives = match &options.watch_own {
        None => Vec::new(),
        Some(log) => read_watched(log, &IngestSettings::default())?,
    };
    drives.extend(driven.iter().filter_map(|d| d.watched.clone()));
    let scenario = match &options.scenario {
        Some(path) => path.to_slash_lossy().into_owned(),
        None => "the paper's".to_owned(),
    };
    let provenance = [
        ("Version", env!("CARGO_PKG_VERSION").to_owned()),
        ("Seed", options.seed.to_string()),
        ("Model", options.model.to_slash_lossy().into_owned()),
        (
            "Conditions",
            options.conditions.to_slash_lossy().into_owned(),
        ),
        ("Scenario", scenario),
    ]
    .map(|(name, value)| (name.to_owned(), value));
    write_watch_page(page, drives, Some(options.seed), &provenance)
}

/// The car with a style in a world of the scenario; what wanders, if anything does.
pub(crate) fn drive_style(
    model: &Model,
    style: &Embedding,
    varying: Option<&Variability>,
    scenario: &Scenario,
    world: u64,
) -> Result<Rollout, StudyError> {
    let planner = ModelPlanner::new(model, style, &scenario.settings().controllers)?;
    let controllers = planner.controllers();
    // Nothing wanders with a variability of nothing: the set-points are the planner's own.
    let varying = varying.copied().unwrap_or_default();
    let mut planner = Varying::new(planner, &varying, &controllers, world);
    let driver = Driver::Automated(&mut planner, &controllers);
    let driven = rollout(scenario, driver, world)?;
    match planner.into_inner().failure() {
        Some(error) => Err(error.into()),
        None => Ok(driven),
    }
}

/// A drive that ended early, and why.
type Stopped = (DriveId, SimulatorError);

fn drive(
    options: &Simulate,
    model: &Model,
    scenario: &Scenario,
    ride: &Ride<'_>,
    logged: bool,
    watched: bool,
) -> Result<Result<Driven, Stopped>, StudyError> {
    let (id, row) = (ride.id.clone(), ride.row);
    let seed = stream_seed(options.seed, &[id.as_str(), "world"]);
    let driven = drive_style(model, &row.embedding, ride.varying.as_ref(), scenario, seed)?;
    if let Some(why) = driven.stopped {
        return Ok(Err((id, why)));
    }
    let who = row.participant.clone();
    let meta = DriveMeta::new(id, who, row.condition, DrivenBy::Automated).on(ride.occasion);
    if logged {
        let scenes = options.scenes.as_ref();
        let beside = Beside {
            trace: &driven.trace,
            scene: scenes.is_some_and(|s| s.cover(&meta.participant)),
            ..Beside::default()
        };
        let log = log_of(&options.out, meta.drive.as_str());
        write_recording(&log, &driven.recording, &meta, &beside)?;
    }
    let recorded = Drive::from_recording(meta.clone(), &driven.recording)?;
    write_drive(&options.out.join("drives"), &recorded)?;
    let watched = watched.then(|| {
        let interventions = Some(braking(&driven.trace));
        let road = centre_line(scenario, &driven.recording);
        WatchedDrive::new(meta.clone(), &driven.recording, interventions, road)
    });
    Ok(Ok(Driven {
        meta,
        rows: recorded.len(),
        duration_s: recorded.rows().time_s.last().copied().unwrap_or(0.0),
        report: driven.report,
        watched: watched.transpose()?,
    }))
}

/// Where a road that bends lies on the map, over the stretch that is driven and seen.
fn centre_line(scenario: &Scenario, recording: &Recording) -> Option<CentreLine> {
    const STEP_M: f64 = 10.0;
    const SIGHT_M: f64 = 200.0;
    let line = scenario.centre_line();
    if line.is_straight() {
        return None;
    }
    let x_m = &recording.ego().x_m;
    let start_m = x_m.iter().copied().fold(f64::MAX, f64::min) - SIGHT_M;
    let end_m = x_m.iter().copied().fold(f64::MIN, f64::max) + SIGHT_M;
    let places = ((end_m - start_m) / STEP_M).ceil() as usize + 1;
    let place = |i: usize| {
        let pose = line.map_pose(start_m + i as f64 * STEP_M, 0.0);
        (pose.x_m, pose.y_m)
    };
    Some(CentreLine {
        start_m,
        step_m: STEP_M,
        map_m: (0..places).map(place).collect(),
    })
}

#[cfg(test)]
mod tests;
