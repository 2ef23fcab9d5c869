//! `generate`: a whole study of people who do not exist.

use crate::{
    atomic_write::{read_text, write_recording},
    design::DesignFile,
    error::StudyError,
    once::count,
    outcome::{Outcome, Watch, for_each_on},
    run_folder::{read_effects_on, read_scales, read_scenario},
    stage::{Files, Stage},
    tables::{
        Table, TableName, drives::remove_former, participants::write_participants, write_rows,
    },
};
use maveric_domain::{DriveId, DriveMeta, DrivenBy, Moment, ParticipantId, Scale, stream_seed};
use maveric_ingest::Beside;
use maveric_participants::{
    Cohort, CohortSettings, PlannedDrive, answer_at_random, answer_before, answers::ADB,
};
use maveric_simulator::{Driver, People, Scenario, rollout};
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Make up a whole study: synthetic participants, their answers and their driving logs
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: maveric generate --out study_data/generated/paper --seed 1")]
pub struct Generate {
    /// Design of the study (TOML); study.toml of the current directory when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Folder to write into: logs/study1, logs/study2, participants.csv, surveys.csv; the files that the design names when not given
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// World to drive in (TOML); the design's when not given, else the paper's
    #[arg(long)]
    pub scenario: Option<PathBuf>,
    /// Who drives (TOML), such as study_data/population_misspecified.toml; the scenario's people when not given
    #[arg(long)]
    pub population: Option<PathBuf>,
    /// Folder of questionnaire definitions; the design's when not given, else study_data/scales
    #[arg(long)]
    pub scales: Option<PathBuf>,
    /// Sizes of the effects in their answers (TOML); the design's when not given, else study_data/effects.toml
    #[arg(long)]
    pub effects: Option<PathBuf>,
    /// People who are learned from
    #[arg(long, alias = "study1", default_value_t = 30)]
    pub learn: usize,
    /// People who are tested
    #[arg(long, alias = "study2", default_value_t = 24)]
    pub test: usize,
    /// Length of a drive, in s; the scenario's when not given
    #[arg(long = "duration", value_name = "DURATION")]
    pub duration_s: Option<f64>,
    /// Everybody drives as themselves once more, on another day: logs/study1-again, logs/study2-again
    #[arg(long)]
    pub repeat_drives: bool,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
}

/// Most people that one call makes up.
const MOST_PEOPLE: usize = 100_000;

#[derive(Debug, Clone, Serialize)]
pub struct Generated {
    pub participants: usize,
    /// Drives of all of them together.
    pub drives: usize,
    pub answers: usize,
    pub collisions: usize,
}

/// Reads a population, or the people of the scenario in that file; without a file takes the people of `scenario`.
fn read_people(path: Option<&Path>, scenario: &Scenario) -> Result<People, StudyError> {
    let drivers = |s: &Scenario| People::Drivers(Box::new(s.settings().drivers.clone()));
    let Some(path) = path else {
        return Ok(drivers(scenario));
    };
    let text = read_text(path)?;
    toml::from_str(&text).or_else(|error| match toml::from_str::<Scenario>(&text) {
        Ok(scenario) => Ok(drivers(&scenario)),
        Err(_) => Err(StudyError::file(path, format!("not a population: {error}"))),
    })
}

impl Stage for Generate {
    const NAME: &'static str = "generate";
    const FAILURE: &'static str = "could not generate the study";
    type Result = Generated;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let study = DesignFile::below_or_paper(root, self.design.as_deref())?;
        let place = Place::new(self, &study, root)?;
        Ok(Files::default()
            .reads_design(self.design.as_deref())
            .reads(&self.population)
            .reads(&place.scenario)
            .reads([&place.scales, &place.effects])
            .writes([&place.logs, &place.people, &place.answers]))
    }

    /// Makes up participants, their answers and their driving logs, labelled as synthetic throughout.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Generated>, StudyError> {
        let people = self.learn.saturating_add(self.test);
        if people > MOST_PEOPLE {
            let problem = format!(
                "{people} people, expected at most {MOST_PEOPLE}: each drives, and a log is about a megabyte"
            );
            let help = "make up fewer, or several studies with seeds of their own";
            return Err(StudyError::not_possible(problem).with_help(help));
        }
        let study = DesignFile::find(self.design.as_deref())?;
        let place = Place::new(self, &study, Path::new(""))?;
        let scenario = read_scenario(place.scenario.as_deref(), self.duration_s)?;
        let people = read_people(self.population.as_deref(), &scenario)?;
        let scales = read_scales(&place.scales)?;
        let effects = read_effects_on(&place.effects, &scales)?;
        place.refuse_real_people()?;
        let cohort = Cohort::draw(
            self.learn,
            self.test,
            self.seed,
            &CohortSettings::default(),
            &study.design,
        )?;
        let mut answers = answer_before(&cohort, &scales, &effects, self.seed)?;
        let without_effects = |scale: &&Scale| {
            let is_asked = study.design.protocol().before.contains(&scale.id);
            is_asked && scale.id != ADB && !effects.answers.contains_key(&scale.id)
        };
        for person in &cohort.participants {
            let scales = scales.iter().filter(without_effects);
            let (rate, seed) = (effects.missing_rate, self.seed);
            answers.extend(answer_at_random(&person.id, Moment::Pre, scales, rate, seed));
        }
        let mut planned: Vec<(PlannedDrive, &str)> =
            cohort.drives.iter().map(|d| (d.clone(), "")).collect();
        if self.repeat_drives {
            planned.extend(again(&cohort)?.into_iter().map(|d| (d, "-again")));
        }
        let collisions = for_each_on(self.jobs, &planned, watch, "drives", |(planned, day)| {
            drive(self, &place, &scenario, &people, planned, day)
        })?;
        remove_former_logs(&place, &planned)?;
        write_participants(&place.people, &cohort, &study.design)?;
        write_rows(TableName::Answers, &place.answers, &answers)?;
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
        Ok(Outcome::new(value, summary, warnings.into_iter().collect()))
    }
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
    fn new(options: &Generate, study: &DesignFile, root: &Path) -> Result<Self, StudyError> {
        let files = study.design.files();
        let world = Some(&files.scenario).filter(|_| study.path.is_some());
        let world = world.map(|p| study.resolve(p)).filter(|p| root.join(p).is_file());
        let (logs, people, answers) = match &options.out {
            Some(out) => (out.join("logs"), out.join("participants.csv"), out.join("surveys.csv")),
            None if study.path.is_some() => {
                (study.resolve(&files.logs), study.people_file(None), study.resolve(&files.answers))
            }
            None => {
                let problem = "there is no folder to write into";
                let help = "give --out FOLDER, or --design FILE of a study";
                return Err(StudyError::not_possible(problem).with_help(help));
            }
        };
        Ok(Self {
            logs,
            people,
            answers,
            scenario: options.scenario.clone().or(world),
            scales: study.scales_folder(options.scales.as_deref()),
            effects: study.effects_file(options.effects.as_deref()),
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
        let problem = format!(
            "holds {} not made up",
            count(table.rows(), "person who was", "people who were")
        );
        let help = "make people up in a folder of their own: --out FOLDER";
        Err(StudyError::file(&self.people, problem).with_help(help))
    }
}

/// Removes the logs of people whom an earlier call listed here, apart from those that were written now: whatever reads
/// the folder would take them for drives of this study.
fn remove_former_logs(place: &Place, planned: &[(PlannedDrive, &str)]) -> Result<(), StudyError> {
    let listed = Table::read(&place.people).and_then(|table| table.ids("participant"));
    let former: Vec<ParticipantId> = listed.unwrap_or_default();
    let written: BTreeSet<String> =
        planned.iter().map(|(drive, _)| format!("{}.mcap", drive.drive)).collect();
    for folder in std::fs::read_dir(&place.logs).into_iter().flatten().flatten() {
        for file in std::fs::read_dir(folder.path()).into_iter().flatten().flatten() {
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
    let own_drives = cohort.drives.iter().filter(|d| !d.role);
    own_drives
        .map(|d| {
            Ok(PlannedDrive { drive: DriveId::new(format!("{}-again", d.drive))?, ..d.clone() })
        })
        .collect()
}

/// Drives once and writes the log; gives the number of collisions.
fn drive(
    options: &Generate,
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
    let meta = DriveMeta::new(
        planned.drive.clone(),
        planned.participant.clone(),
        planned.condition,
        DrivenBy::Synthetic,
    )
    .on(planned.occasion);
    let folder = format!("study{}", planned.part.number());
    let path =
        place.logs.join(format!("{folder}{day_name}")).join(format!("{}.mcap", planned.drive));
    write_recording(&path, &driven.recording, &meta, &Beside::default())?;
    Ok(driven.report.collisions as usize)
}
