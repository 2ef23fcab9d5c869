//! `validate`: is the learned style the driver's? Identity, fidelity, dial and aggression line, over several trainings.
//!
//! It needs people who drove twice, which the paper's did not.

mod examine;
mod page;
mod people;
mod tables;

pub use examine::Examined;
pub use maveric_rehearsal::validation::{
    Across, Agreement, Dial, FULL, Fidelity, Held, Identification, Likeness, Metric, Retest, Right,
    ShareOfPeople,
};
use path_slash::PathExt as _;

use crate::{
    atomic_write::{atomic_write_bytes, write_json},
    error::StudyError,
    outcome::{Outcome, Watch},
    run_folder::{read_model, read_scenario},
    stage::{Files, Stage},
    stages::report::write_page,
};
use maveric_analysis::Finding;
use maveric_domain::{Drive, DrivenBy};
use maveric_rehearsal::validation::{MEASURES, Values, mean, retest, title, values};
use maveric_report::tables::Table;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Check on people who drove twice whether the learned style is theirs: identity, fidelity, dial, aggression line
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric validate study_data/generated/validate --model models/1.maveric --model models/2.maveric --out validation"
)]
pub struct Validate {
    /// A run's results with second drives: see `generate --repeat-drives` and pipelines/validate.toml
    pub run: PathBuf,
    /// Trained model; several of them, of the same training with other seeds, give ranges
    #[arg(long = "model", required = true)]
    pub models: Vec<PathBuf>,
    /// Folder to write into: validation.md, validation.json, one CSV a table
    #[arg(long)]
    pub out: PathBuf,
    /// World to drive in (TOML); the paper's when not given
    #[arg(long)]
    pub scenario: Option<PathBuf>,
    /// Length of a drive, in s; the scenario's when not given
    #[arg(long = "duration", value_name = "DURATION")]
    pub duration_s: Option<f64>,
    /// How far a step of the dial to either side is from the own style, in points of the ADB scale
    #[arg(long, default_value_t = 15.0)]
    pub points: f64,
    /// Roads on which each setting of the dial is driven; the measures are averaged
    #[arg(long, default_value_t = 1)]
    pub worlds: usize,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
    /// The command that makes the same again, for the page; this one when not given
    #[arg(long, value_name = "TEXT")]
    pub command: Option<String>,
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
    /// How much of what differs between the drives of those who are tested is theirs.
    pub retest: Vec<Retest>,
    /// Model by model.
    pub models: Vec<Examined>,
    /// What became of each question, over all models.
    pub findings: Vec<Finding>,
}

impl Stage for Validate {
    const NAME: &'static str = "validate";
    const FAILURE: &'static str = "could not validate";
    type Result = Validated;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        Ok(Files::default()
            .reads([self.run.join("drives"), self.run.join("scores.csv")])
            .reads_if_there([self.run.join("participants.csv")])
            .reads(&self.models)
            .reads(&self.scenario)
            .writes_into(&self.out, &["validation.md", "validation.json"]))
    }

    fn repeated_by(&mut self, command: &str) {
        self.command.get_or_insert_with(|| command.to_owned());
    }

    /// Examines every model on the people of a run who drove twice; writes `validation.json`, `validation.md` and a
    /// page with figures and tables.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Validated>, StudyError> {
        if self.models.is_empty() || self.worlds == 0 {
            return Err(StudyError::NotPossible {
                problem: format!(
                    "{} models on {} roads: expected at least one of each",
                    self.models.len(),
                    self.worlds
                ),
                help: Some("name models with --model FILE".to_owned()),
            });
        }
        let people = people::read(&self.run)?;
        let scenario = read_scenario(self.scenario.as_deref(), self.duration_s)?;
        let examination = examine::Examination {
            people: &people,
            scenario: &scenario,
            points: self.points,
            worlds: self.worlds,
            seed: self.seed,
            jobs: self.jobs,
        };
        let mut models = Vec::new();
        for path in &self.models {
            let name = path.to_slash_lossy().into_owned();
            models.push(examination.examine(&name, &read_model(path)?, watch)?);
        }
        let measured = |of: fn(&people::Person) -> &Drive| -> Vec<Values> {
            people.test.iter().map(|p| values(of(p))).collect()
        };
        let retest = retest(&measured(|p| &p.first), &measured(|p| &p.again));
        let tables = tables::tables(&models, &retest, self.points);
        let markdown: Vec<String> = tables.iter().map(Table::to_markdown).collect();
        let text = markdown.join("\n");
        atomic_write_bytes(&self.out.join("validation.md"), text.as_bytes())?;
        let collisions: u32 = models.iter().map(|m| m.collisions).sum();
        let value = Validated {
            synthetic: people
                .test
                .iter()
                .any(|p| p.first.meta().driven_by == DrivenBy::Synthetic),
            drivers: people.test.len(),
            training_drivers: people.training.len(),
            retest,
            findings: examine::findings(&models),
            models,
        };
        write_json(&self.out.join("validation.json"), &value)?;
        let warnings = warnings(&people, collisions);
        let page = write_page(&self.out, &page::page(&value, self, tables, &warnings)?)?;
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
