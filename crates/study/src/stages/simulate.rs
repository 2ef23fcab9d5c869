//! `simulate`: the learned model drives each condition.

mod drive;
mod logs;
mod rides;

pub(crate) use drive::drive_style;
pub use logs::LogChoice;

use crate::{
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
        conditions::ConditionRow,
        drives::{EndedEarly, former_drives, remove_former, write_drive_list},
        write_rows,
    },
    watching::{read_watched, write_watch_page},
};
use drive::{Driven, Stopped, drive};
use logs::{Logged, known, log_of};
use maveric_domain::{BeyondWhy, DriveMeta, ParticipantId};
use maveric_ingest::IngestSettings;
use maveric_simulator::RolloutReport;
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Drive each participant's conditions in the simulator
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric simulate --model model.maveric --conditions conditions.csv --out av --watch P07.html --watch-participant P07"
)]
pub struct Simulate {
    /// Design of the study (TOML); study.toml of the current directory when not given. Without either every condition is driven
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Trained model
    #[arg(long)]
    pub model: PathBuf,
    /// Conditions to drive
    #[arg(long)]
    pub conditions: PathBuf,
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
    pub logs: Option<LogChoice>,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
}

#[derive(Debug, Clone, Serialize)]
pub struct Simulated {
    /// Drives that came to their end.
    pub drives: usize,
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
        if let Some(logs) = &self.logs {
            logs.check(people())?;
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
            summary.push(format!("drives of {participant} to watch: {}", page.to_slash_lossy()));
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
            count(ended_early, "drive ended early and is", "drives ended early and are")
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
    conditions.iter().filter_map(|row| Some((&row.participant, row.beyond_why.as_ref()?))).collect()
}

impl Simulate {
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
        let ended = stopped
            .iter()
            .map(|(drive, why)| EndedEarly { drive: drive.to_string(), what: why.to_string() });
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
        let list: Vec<(DriveMeta, usize, f64)> =
            driven.iter().map(|d| (d.meta.clone(), d.rows, d.duration_s)).collect();
        write_drive_list(&drives, &list)?;
        let rollouts = driven.iter().map(|d| (("drive", &d.meta.drive), &d.report));
        write_rows(TableName::Rollouts, &self.out.join("rollouts.csv"), rollouts)
    }
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
        ("Conditions", options.conditions.to_slash_lossy().into_owned()),
        ("Scenario", scenario),
    ]
    .map(|(name, value)| (name.to_owned(), value));
    write_watch_page(page, drives, Some(options.seed), &provenance)
}

#[cfg(test)]
mod tests;
