//! `validate`: is the learned style the driver's? Identity, fidelity, dial and aggression line, over several trainings.
//!
//! It needs people who drove twice, which the paper's did not.

mod examine;
mod page;
mod people;
mod tables;

pub use examine::Examined;
pub use maveric_rehearsal::validation::{
    Across, Agreement, Dial, FULL, Fidelity, Identification, Likeness, Metric, Right,
};
use path_slash::PathExt as _;

use crate::{
    atomic_write::{atomic_write_bytes, write_json},
    error::StudyError,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    run_folder::{read_model, read_scenario},
    stages::report::write_page,
};
use maveric_analysis::Finding;
use maveric_domain::DrivenBy;
use maveric_rehearsal::validation::{MEASURES, mean, title, values};
use maveric_report::tables::Table;
use serde::Serialize;
use std::path::PathBuf;

/// What to validate, and how.
#[derive(Debug, Clone)]
pub struct ValidateOptions {
    /// A run's results, with second drives.
    pub run: PathBuf,
    /// Trained models: the same training with several seeds.
    pub models: Vec<PathBuf>,
    /// Folder to write into.
    pub out: PathBuf,
    /// World to drive in; the paper's without.
    pub scenario: Option<PathBuf>,
    /// Length of a drive, in s; the scenario's without.
    pub duration_s: Option<f64>,
    /// How far a step of the dial to either side is from the own style, in ADB points.
    pub points: f64,
    /// Roads on which each setting of the dial is driven; the measures are averaged.
    pub worlds: usize,
    /// Root of every random choice.
    pub seed: u64,
    /// Threads.
    pub jobs: usize,
    /// The command that makes the same again, for the page.
    pub command: String,
}

/// What was found.
#[derive(Debug, Clone, Serialize)]
pub struct Validated {
    /// Whether the drivers are made up.
    pub synthetic: bool,
    /// Drivers of Study 2 who drove twice.
    pub drivers: usize,
    /// Drivers of Study 1 who drove twice.
    pub training_drivers: usize,
    /// Model by model.
    pub models: Vec<Examined>,
    /// What became of each question, over all models.
    pub findings: Vec<Finding>,
}

/// Examines every model on the people of a run who drove twice; writes `validation.json`, `validation.md` and a
/// page with figures and tables.
///
/// # Errors
/// [`StudyError`] if the run, a model or the scenario cannot be read, nobody drove twice, or a file cannot be written.
pub fn validate(
    options: &ValidateOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Validated>, StudyError> {
    if options.models.is_empty() || options.worlds == 0 {
        return Err(StudyError::NotPossible {
            problem: format!(
                "{} models on {} roads: expected at least one of each",
                options.models.len(),
                options.worlds
            ),
            help: Some("name models with --model FILE".to_owned()),
        });
    }
    let models = options.models.iter().map(|path| &**path);
    let out = ["validation.md", "validation.json"].map(|name| options.out.join(name));
    spare_inputs(
        models.chain(options.scenario.as_deref()),
        out.iter().map(|path| &**path),
    )?;
    let people = people::read(&options.run)?;
    let scenario = read_scenario(options.scenario.as_deref(), options.duration_s)?;
    let examination = examine::Examination {
        people: &people,
        scenario: &scenario,
        points: options.points,
        worlds: options.worlds,
        seed: options.seed,
        jobs: options.jobs,
    };
    let mut models = Vec::new();
    for path in &options.models {
        let name = path.to_slash_lossy().into_owned();
        models.push(examination.examine(&name, &read_model(path)?, watch)?);
    }
    let tables = tables::tables(&models, options.points);
    let markdown: Vec<String> = tables.iter().map(Table::to_markdown).collect();
    let text = markdown.join("\n");
    atomic_write_bytes(&options.out.join("validation.md"), text.as_bytes())?;
    let collisions: u32 = models.iter().map(|m| m.collisions).sum();
    let value = Validated {
        synthetic: people
            .test
            .iter()
            .any(|p| p.first.meta().driven_by == DrivenBy::Synthetic),
        drivers: people.test.len(),
        training_drivers: people.training.len(),
        findings: examine::findings(&models),
        models,
    };
    write_json(&options.out.join("validation.json"), &value)?;
    let warnings = warnings(&people, collisions);
    let page = write_page(
        &options.out,
        &page::page(&value, options, tables, &warnings)?,
    )?;
    let mut summary: Vec<String> = text.lines().map(str::to_owned).collect();
    summary.push(format!(
        "{} drivers who drove twice, {} models: {}",
        value.drivers,
        value.models.len(),
        page.to_slash_lossy()
    ));
    Ok(Outcome {
        value,
        summary,
        warnings,
    })
}

/// What could not be compared, and what should not have happened.
fn warnings(people: &people::People, collisions: u32) -> Vec<String> {
    let mut warnings = Vec::new();
    for k in 0..MEASURES.len() {
        let missing = people
            .test
            .iter()
            .flat_map(|p| [&p.first, &p.again])
            .filter(|d| values(d)[k].is_none())
            .count();
        if missing > 0 {
            warnings.push(format!(
                "{missing} of {} own drives have no {}: left out of its fidelity, taken at the mean in identity",
                2 * people.test.len(),
                title(k).to_lowercase()
            ));
        }
    }
    if collisions > 0 {
        warnings.push(format!("{collisions} collisions in the car's drives"));
    }
    warnings
}
