//! `simulate`: the learned model drives each condition.

use crate::{
    atomic_write::write_recording,
    design::DesignFile,
    error::StudyError,
    forget::refuse_learned_from_gone,
    once::count,
    outcome::{Outcome, Watch, for_each_on},
    run_folder::{read_model, read_scenario},
    stage::{Files, Stage},
    tables::{
        TableBuilder,
        conditions::{ConditionRow, read_conditions},
        drives::{former_drives, refuse_foreign, remove_former, write_drive, write_drive_list},
    },
    watching::{WatchedDrive, braking, read_watched, write_watch_page},
};
use maveric_domain::{
    Drive, DriveId, DriveMeta, DrivenBy, Embedding, ParticipantId, Recording, design::Condition,
    stream_seed,
};
use maveric_ingest::{Beside, IngestSettings};
use maveric_model::Model;
use maveric_report::html::CentreLine;
use maveric_simulator::{Driver, Rollout, RolloutReport, Scenario, SimulatorError, rollout};
use maveric_steering::ModelPlanner;
use path_slash::PathExt as _;
use serde::Serialize;
use std::path::{Path, PathBuf};

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
    /// Folder to write into: logs (MCAP), drives (Parquet), rollouts.csv
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
    /// Add a scene for Foxglove and Lichtblick to the logs: everybody's, or one participant's
    #[arg(long = "scene", value_name = "PARTICIPANT", num_args = 0..=1, default_missing_value = "all")]
    pub scenes: Option<Scenes>,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
}

/// Whose logs get a scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Scenes {
    /// Everybody's.
    All,
    /// One participant's.
    Of(String),
}

impl std::str::FromStr for Scenes {
    type Err = std::convert::Infallible;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "all" => Self::All,
            participant => Self::Of(participant.to_owned()),
        })
    }
}

impl Scenes {
    /// Whether a participant's logs get one.
    pub fn cover(&self, participant: &ParticipantId) -> bool {
        match self {
            Self::All => true,
            Self::Of(one) => one == participant.as_str(),
        }
    }

    /// Checks that the one asked for is among the participants.
    ///
    /// # Errors
    /// [`StudyError::NotPossible`] naming some who are.
    pub fn check<'a>(
        &self,
        participants: impl Iterator<Item = &'a ParticipantId>,
    ) -> Result<(), StudyError> {
        match self {
            Self::Of(one) => known(one, participants),
            Self::All => Ok(()),
        }
    }
}

/// Checks that a participant is among those there are.
fn known<'a>(
    wanted: &str,
    participants: impl Iterator<Item = &'a ParticipantId>,
) -> Result<(), StudyError> {
    let there: std::collections::BTreeSet<&str> = participants.map(ParticipantId::as_str).collect();
    if there.contains(wanted) {
        return Ok(());
    }
    let some: Vec<&str> = there.iter().take(5).copied().collect();
    Err(StudyError::NotPossible {
        problem: format!(
            "there is no participant {wanted} among the {}: {}{}",
            there.len(),
            some.join(", "),
            if there.len() > some.len() {
                ", …"
            } else {
                ""
            }
        ),
        help: Some("give one of them".to_owned()),
    })
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

impl Stage for Simulate {
    const NAME: &'static str = "simulate";
    const FAILURE: &'static str = "could not simulate";
    type Result = Simulated;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        let tables = ["drives/drives.csv", "drives/exclusions.csv", "rollouts.csv"];
        Ok(Files::default()
            .reads([&self.model, &self.conditions])
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
        let mut conditions = read_conditions(&self.conditions)?;
        if let Some(study) = study {
            // A sweep drives what the design does not name; of what it names, only what is not recorded elsewhere.
            let simulated = |id| study.design.condition(id).is_some_and(Condition::simulated);
            conditions.retain(|row| row.sweep.is_some() || simulated(row.condition));
            if conditions.is_empty() {
                let problem = "holds no condition that the design lets the program drive";
                return Err(StudyError::file(&self.conditions, problem));
            }
        }
        let mut names = std::collections::BTreeSet::new();
        for row in &conditions {
            let drive = row.drive()?;
            if !names.insert(drive.clone()) {
                let problem = format!("two rows are drive {drive}, expected a name for each");
                return Err(StudyError::file(&self.conditions, problem));
            }
        }
        refuse_foreign(&self.out.join("drives"), names.iter().map(DriveId::as_str))?;
        let people = || conditions.iter().map(|row| &row.participant);
        if let Some(scenes) = &self.scenes {
            scenes.check(people())?;
        }
        let watched = self.watch.as_ref().and_then(|_| {
            let first = || people().next().map(ToString::to_string);
            self.watch_participant.clone().or_else(first)
        });
        if let Some(participant) = &watched {
            known(participant, people())?;
        }
        let scenario = read_scenario(self.scenario.as_deref(), self.duration_s)?;
        let driven = for_each_on(self.jobs, &conditions, watch, "drives", |row| {
            drive(
                self,
                &model,
                &scenario,
                row,
                watched.as_deref() == Some(row.participant.as_str()),
            )
        })?;
        let mut stopped = Vec::new();
        let driven: Vec<Driven> = driven
            .into_iter()
            .filter_map(|ended| ended.map_err(|why| stopped.push(why)).ok())
            .collect();
        TableBuilder::default()
            .text("drive", stopped.iter().map(|(drive, _)| drive.as_str()))
            .text("what", stopped.iter().map(|(_, why)| why.to_string()))
            .write(&self.out.join("drives").join("exclusions.csv"))?;
        let ended_early = stopped.len();
        if let (true, Some((_, why))) = (driven.is_empty(), stopped.pop()) {
            return Err(why.into());
        }
        let list: Vec<(DriveMeta, usize, f64)> =
            driven.iter().map(|d| (d.0.clone(), d.1, d.2)).collect();
        let drives = self.out.join("drives");
        for gone in former_drives(&drives, list.iter().map(|d| d.0.drive.as_str())) {
            let log = self.out.join("logs").join(format!("{gone}.mcap"));
            remove_former(&log)?;
        }
        write_drive_list(&drives, &list)?;
        TableBuilder::default()
            .text("drive", driven.iter().map(|d| d.0.drive.as_str()))
            .beside(TableBuilder::of(driven.iter().map(|d| &d.3))?)
            .write(&self.out.join("rollouts.csv"))?;
        if let Some(page) = &self.watch {
            write_page(self, page, &driven)?;
        }
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
            format!(
                "{} left out: see drives/exclusions.csv",
                count(
                    ended_early,
                    "drive ended early and is",
                    "drives ended early and are"
                )
            )
        });
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
        Ok(Outcome {
            value,
            summary,
            warnings: collisions.into_iter().chain(early).collect(),
        })
    }
}

type Driven = (DriveMeta, usize, f64, RolloutReport, Option<WatchedDrive>);

/// Writes the page that plays the drives kept for it, the own drive first.
fn write_page(options: &Simulate, page: &Path, driven: &[Driven]) -> Result<(), StudyError> {
    let mut drives = match &options.watch_own {
        None => Vec::new(),
        Some(log) => read_watched(log, &IngestSettings::default())?,
    };
    drives.extend(driven.iter().filter_map(|d| d.4.clone()));
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

/// The car with a style in a world of the scenario.
pub(crate) fn drive_style(
    model: &Model,
    style: &Embedding,
    scenario: &Scenario,
    world: u64,
) -> Result<Rollout, StudyError> {
    let mut planner = ModelPlanner::new(model, style, &scenario.settings().controllers)?;
    let controllers = planner.controllers();
    let driver = Driver::Automated(&mut planner, &controllers);
    let driven = rollout(scenario, driver, world)?;
    match planner.failure() {
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
    row: &ConditionRow,
    watched: bool,
) -> Result<Result<Driven, Stopped>, StudyError> {
    let id = row.drive()?;
    let seed = stream_seed(options.seed, &[id.as_str(), "world"]);
    let driven = drive_style(model, &row.embedding, scenario, seed)?;
    if let Some(why) = driven.stopped {
        return Ok(Err((id, why)));
    }
    let meta = DriveMeta {
        drive: id,
        participant: row.participant.clone(),
        condition: row.condition,
        driven_by: DrivenBy::Automated,
    };
    let log = options
        .out
        .join("logs")
        .join(format!("{}.mcap", meta.drive));
    let beside = Beside {
        trace: &driven.trace,
        scene: options
            .scenes
            .as_ref()
            .is_some_and(|s| s.cover(&meta.participant)),
        ..Beside::default()
    };
    write_recording(&log, &driven.recording, &meta, &beside)?;
    let made = Drive::from_recording(meta.clone(), &driven.recording)?;
    write_drive(&options.out.join("drives"), &made)?;
    let duration = made.rows().time_s.last().copied().unwrap_or(0.0);
    let kept = watched.then(|| {
        let interventions = Some(braking(&driven.trace));
        let road = centre_line(scenario, &driven.recording);
        WatchedDrive::new(meta.clone(), &driven.recording, interventions, road)
    });
    let kept = kept.transpose()?;
    Ok(Ok((meta, made.len(), duration, driven.report, kept)))
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
