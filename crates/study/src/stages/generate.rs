//! `generate`: a whole study of people who do not exist.

use crate::{
    atomic_write::{read_text, write_recording},
    design::DesignFile,
    error::StudyError,
    once::count,
    outcome::{Outcome, Watch, for_each_on},
    outputs::spare_inputs,
    run_folder::{read_effects_on, read_scales, read_scenario},
    stages::simulate::Scenes,
    tables::{
        Table, drives::remove_former, participants::write_participants, surveys::write_answers,
    },
};
use maveric_domain::{DriveId, DriveMeta, DrivenBy, ParticipantId, stream_seed};
use maveric_ingest::Beside;
use maveric_participants::{Cohort, CohortSettings, PlannedDrive, answer_before};
use maveric_simulator::{Driver, People, Scenario, rollout};
use path_slash::PathExt as _;
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
    /// Folder to write into; without, the files that the design names, from its folder.
    pub out: Option<PathBuf>,
    /// World to drive in; the design's without, else the paper's.
    pub scenario: Option<PathBuf>,
    /// Who drives: a population or a scenario (TOML); the scenario's people without.
    pub population: Option<PathBuf>,
    /// Folder of questionnaire definitions; the design's without.
    pub scales: Option<PathBuf>,
    /// Sizes of the effects in the answers; the design's without.
    pub effects: Option<PathBuf>,
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

/// Most people that one call makes up.
const MOST_PEOPLE: usize = 100_000;

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

/// Reads a population, or the people of the scenario in that file; without a file takes the people of `scenario`.
fn read_people(path: Option<&Path>, scenario: &Scenario) -> Result<People, StudyError> {
    match path {
        None => Ok(People::Drivers(Box::new(
            scenario.settings().drivers.clone(),
        ))),
        Some(path) => {
            let text = read_text(path)?;
            toml::from_str(&text).or_else(|error| match toml::from_str::<Scenario>(&text) {
                Ok(scenario) => Ok(People::Drivers(Box::new(
                    scenario.settings().drivers.clone(),
                ))),
                Err(_) => Err(StudyError::file(path, format!("not a population: {error}"))),
            })
        }
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
    let people = options.learn.saturating_add(options.test);
    if people > MOST_PEOPLE {
        return Err(StudyError::NotPossible {
            problem: format!(
                "{people} people, expected at most {MOST_PEOPLE}: each drives, and a log is about a megabyte"
            ),
            help: Some("make up fewer, or several studies with seeds of their own".to_owned()),
        });
    }
    let study = DesignFile::find(options.design.as_deref())?;
    let place = Place::of(options, &study)?;
    let given = [&options.design, &options.population, &place.scenario];
    let given = given.into_iter().filter_map(Option::as_deref);
    let inputs = given.chain([&*place.scales, &place.effects]);
    spare_inputs(inputs, [&*place.people, &place.answers])?;
    let scenario = read_scenario(place.scenario.as_deref(), options.duration_s)?;
    let people = read_people(options.population.as_deref(), &scenario)?;
    let scales = read_scales(&place.scales)?;
    let effects = read_effects_on(&place.effects, &scales)?;
    place.refuse_real_people()?;
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
        drive(options, &place, &scenario, &people, planned, day)
    })?;
    remove_former_logs(&place, &planned)?;
    write_participants(&place.people, &cohort, &study.design)?;
    write_answers(&place.answers, &answers)?;
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
        place.people.to_slash_lossy()
    )];
    Ok(Outcome {
        value,
        summary,
        warnings: warnings.into_iter().collect(),
    })
}

/// Where everything is and goes.
struct Place {
    logs: PathBuf,
    people: PathBuf,
    answers: PathBuf,
    scenario: Option<PathBuf>,
    scales: PathBuf,
    effects: PathBuf,
}

impl Place {
    fn of(options: &GenerateOptions, study: &DesignFile) -> Result<Self, StudyError> {
        let files = study.design.files();
        let own = |given: &Option<PathBuf>, path: Option<&PathBuf>, usual: &str| {
            let of_design = || {
                path.filter(|_| study.path.is_some())
                    .map(|p| study.resolve(p))
            };
            given
                .clone()
                .or_else(of_design)
                .unwrap_or_else(|| usual.into())
        };
        let world = Some(&files.scenario).filter(|_| study.path.is_some());
        let world = world.map(|p| study.resolve(p)).filter(|p| p.is_file());
        let (logs, people, answers) = match &options.out {
            Some(out) => (
                out.join("logs"),
                out.join("participants.csv"),
                out.join("surveys.csv"),
            ),
            None if study.path.is_some() => (
                study.resolve(&files.logs),
                study.resolve(&study.design.people().file),
                study.resolve(&files.answers),
            ),
            None => {
                return Err(StudyError::NotPossible {
                    problem: "there is no folder to write into".to_owned(),
                    help: Some("give --out FOLDER, or --design FILE of a study".to_owned()),
                });
            }
        };
        Ok(Self {
            logs,
            people,
            answers,
            scenario: options.scenario.clone().or(world),
            scales: own(&options.scales, Some(&files.scales), "study_data/scales"),
            effects: own(
                &options.effects,
                files.effects.as_ref(),
                "study_data/effects.toml",
            ),
        })
    }

    /// Real people are never replaced: their table has rows and no latents.
    fn refuse_real_people(&self) -> Result<(), StudyError> {
        if !self.people.is_file() {
            return Ok(());
        }
        let table = Table::read(&self.people)?;
        if table.rows() == 0 || table.has("latent_pace") {
            return Ok(());
        }
        Err(StudyError::BadFile {
            path: self.people.clone(),
            problem: format!(
                "holds {} not made up",
                count(table.rows(), "person who was", "people who were")
            ),
            help: Some("make people up in a folder of their own: --out FOLDER".to_owned()),
        })
    }
}

/// Removes the logs of people whom an earlier call listed here, apart from those that were written now: whatever reads
/// the folder would take them for drives of this study.
fn remove_former_logs(place: &Place, planned: &[(PlannedDrive, &str)]) -> Result<(), StudyError> {
    let listed = Table::read(&place.people).and_then(|table| table.ids("participant"));
    let former: Vec<ParticipantId> = listed.unwrap_or_default();
    let written: BTreeSet<String> = planned
        .iter()
        .map(|(drive, _)| format!("{}.mcap", drive.drive))
        .collect();
    for folder in std::fs::read_dir(&place.logs)
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
    place: &Place,
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
    let path = place
        .logs
        .join(format!("{folder}{day_name}"))
        .join(format!("{}.mcap", planned.drive));
    let beside = Beside {
        scene: options.scenes.cover(&planned.participant),
        ..Beside::default()
    };
    write_recording(&path, &driven.recording, &meta, &beside)?;
    Ok(driven.report.collisions as usize)
}
