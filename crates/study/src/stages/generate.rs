//! `generate`: a whole study of people who do not exist.

use crate::{
    atomic_write::{atomic_write, read_text},
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch, for_each_on},
    stages::{rate::read_effects, score::read_scales, simulate::Scenes},
    tables::{
        Table, drives::remove_former, participants::write_participants, surveys::write_answers,
    },
};
use maveric_domain::{DriveId, DriveMeta, DrivenBy, ParticipantId, Seconds, stream_seed};
use maveric_ingest::{Beside, write_mcap_with};
use maveric_participants::{Cohort, CohortSettings, PlannedDrive, answer_before};
use maveric_simulator::{Driver, People, Scenario, rollout};
use serde::Serialize;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// What to make up.
#[derive(Debug, Clone)]
pub struct GenerateOptions {
    /// The study's design; `study.toml` of the folder one stands in without, else the paper's.
    pub design: Option<PathBuf>,
    /// Folder to write into.
    pub out: PathBuf,
    /// World to drive in; the paper's without.
    pub scenario: Option<PathBuf>,
    /// Who drives (TOML); the scenario's people without.
    pub population: Option<PathBuf>,
    /// Folder of questionnaire definitions.
    pub scales: PathBuf,
    /// Sizes of the effects in the answers.
    pub effects: PathBuf,
    /// People who are learned from.
    pub learn: usize,
    /// People who are tested.
    pub test: usize,
    /// Length of a drive, in s; the scenario's without.
    pub duration_s: Option<f64>,
    /// Whether everybody drives as themselves once more, on another day: `logs/study1-again`, `logs/study2-again`.
    pub repeat_drives: bool,
    /// Whose logs get a scene for Foxglove and Lichtblick.
    pub scenes: Scenes,
    /// Root of every random choice.
    pub seed: u64,
    /// Threads.
    pub jobs: usize,
}

/// What was made up.
#[derive(Debug, Clone, Serialize)]
pub struct Generated {
    /// People.
    pub participants: usize,
    /// Drives.
    pub drives: usize,
    /// Answers before the drives.
    pub answers: usize,
    /// Collisions over all drives.
    pub collisions: usize,
}

/// Reads a scenario, or takes the paper's, at the length asked for.
///
/// # Errors
/// [`StudyError`] naming the file and the key.
pub fn read_scenario(path: Option<&Path>, duration_s: Option<f64>) -> Result<Scenario, StudyError> {
    let scenario = match path {
        None => Scenario::paper(),
        Some(path) => toml::from_str(&read_text(path)?)
            .map_err(|e| StudyError::file(path, format!("not a scenario: {e}")))?,
    };
    match duration_s {
        None => Ok(scenario),
        Some(seconds) => Ok(scenario.with_duration(Seconds(seconds))?),
    }
}

/// Reads a population, or takes the people of `scenario`.
fn read_people(path: Option<&Path>, scenario: &Scenario) -> Result<People, StudyError> {
    match path {
        None => Ok(People::Drivers(Box::new(
            scenario.settings().drivers.clone(),
        ))),
        Some(path) => toml::from_str(&read_text(path)?)
            .map_err(|e| StudyError::file(path, format!("not a population: {e}"))),
    }
}

/// Makes up participants, their answers and their driving logs, labelled as synthetic throughout.
///
/// # Errors
/// [`StudyError`] where scenario, scales or effects are not as they should be, or a file cannot be written.
pub fn generate(
    options: &GenerateOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Generated>, StudyError> {
    let scenario = read_scenario(options.scenario.as_deref(), options.duration_s)?;
    let people = read_people(options.population.as_deref(), &scenario)?;
    let scales = read_scales(&options.scales)?;
    let effects = read_effects(&options.effects)?;
    let study = DesignFile::find(options.design.as_deref())?;
    let cohort = Cohort::draw(
        options.learn,
        options.test,
        options.seed,
        &CohortSettings::default(),
        &study.design,
    )?;
    options
        .scenes
        .check(cohort.drives.iter().map(|d| &d.participant))?;
    let answers = answer_before(&cohort, &scales, &effects, options.seed)?;
    let mut planned: Vec<(PlannedDrive, &str)> =
        cohort.drives.iter().map(|d| (d.clone(), "")).collect();
    if options.repeat_drives {
        planned.extend(again(&cohort)?.into_iter().map(|d| (d, "-again")));
    }
    let collisions = for_each_on(options.jobs, &planned, watch, "drives", |(planned, day)| {
        drive(options, &scenario, &people, planned, day)
    })?;
    let people_file = options.out.join("participants.csv");
    remove_former_logs(&options.out, &people_file, &planned)?;
    write_participants(&people_file, &cohort, &study.design)?;
    write_answers(&options.out.join("surveys.csv"), &answers)?;
    let value = Generated {
        participants: cohort.participants.len(),
        drives: planned.len(),
        answers: answers.len(),
        collisions: collisions.iter().sum(),
    };
    let warnings = (value.collisions > 0)
        .then(|| format!("{} collisions in the synthetic drives", value.collisions));
    let summary = vec![format!(
        "{} synthetic participants, {} drives: {}",
        value.participants,
        value.drives,
        options.out.display()
    )];
    Ok(Outcome {
        value,
        summary,
        warnings: warnings.into_iter().collect(),
    })
}

/// Removes the logs of people whom an earlier call listed here, apart from those that were written now: whatever reads
/// the folder would take them for drives of this study.
fn remove_former_logs(
    out: &Path,
    people: &Path,
    planned: &[(PlannedDrive, &str)],
) -> Result<(), StudyError> {
    let listed = Table::read(people).and_then(|table| table.ids("participant"));
    let former: Vec<ParticipantId> = listed.unwrap_or_default();
    let written: BTreeSet<String> = planned
        .iter()
        .map(|(drive, _)| format!("{}.mcap", drive.drive))
        .collect();
    for folder in std::fs::read_dir(out.join("logs"))
        .into_iter()
        .flatten()
        .flatten()
    {
        for file in std::fs::read_dir(folder.path())
            .into_iter()
            .flatten()
            .flatten()
        {
            let name = file.file_name().to_string_lossy().into_owned();
            let theirs = |id: &ParticipantId| name.starts_with(&format!("{id}-"));
            let is_log = file.path().extension().is_some_and(|e| e == "mcap");
            if is_log && !written.contains(&name) && former.iter().any(theirs) {
                remove_former(&file.path())?;
            }
        }
    }
    Ok(())
}

/// Everybody's own drive once more. Its name is another, and so are the day and the road that follow from the name; the
/// person is the same.
fn again(cohort: &Cohort) -> Result<Vec<PlannedDrive>, StudyError> {
    let own = cohort.drives.iter().filter(|d| !d.role);
    own.map(|d| {
        Ok(PlannedDrive {
            drive: DriveId::new(format!("{}-again", d.drive))?,
            ..d.clone()
        })
    })
    .collect()
}

/// Drives once and writes the log; gives the number of collisions.
fn drive(
    options: &GenerateOptions,
    scenario: &Scenario,
    people: &People,
    planned: &PlannedDrive,
    day_name: &str,
) -> Result<usize, StudyError> {
    let person = stream_seed(options.seed, &[planned.participant.as_str(), "person"]);
    let day = stream_seed(options.seed, &[planned.drive.as_str(), "day"]);
    let who = people.draw(&planned.traits, person, day);
    let world = stream_seed(options.seed, &[planned.drive.as_str(), "world"]);
    let driven = rollout(scenario, Driver::from(&who), world)?;
    let meta = DriveMeta {
        drive: planned.drive.clone(),
        participant: planned.participant.clone(),
        condition: planned.condition,
        driven_by: DrivenBy::Synthetic,
    };
    let folder = format!("study{}", planned.part.number());
    let path = options
        .out
        .join("logs")
        .join(format!("{folder}{day_name}"))
        .join(format!("{}.mcap", planned.drive));
    let beside = Beside {
        scene: options.scenes.cover(&planned.participant),
        ..Beside::default()
    };
    atomic_write(&path, |file| {
        Ok(write_mcap_with(&driven.recording, &meta, &beside, file)?)
    })?;
    Ok(driven.report.collisions as usize)
}
