//! `validate`: is the learned style the driver's? Identity, fidelity, dial and aggression line, over several trainings.
//!
//! It needs people who drove twice, which the paper's did not.

mod examine;
pub mod leave_out;
mod page;
mod people;
mod tables;

pub use examine::Examined;
pub use maveric_rehearsal::validation::{
    Across, Agreement, ByColumn, Dial, FULL, Fidelity, Held, Identification, Likeness, Looking,
    Metric, Retest, Right, ShareOfPeople,
};
use path_slash::PathExt as _;

use crate::{
    atomic_write::{atomic_write_bytes, write_json},
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch},
    run_folder::{read_model, read_scenario},
    stage::{Files, Stage},
    stages::report::write_page,
};
use maveric_analysis::Finding;
use maveric_domain::{Drive, DrivenBy, ScoreRange};
use maveric_model::{HeadsKind, Model, TrainSettings};
use maveric_pages::PageTexts;
use maveric_rehearsal::validation::{MEASURES, Values, mean, retest, title, values};
use maveric_report::tables::Table;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Check on people who drove twice whether the learned style is theirs: identity, fidelity, dial, aggression line
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric validate study_data/generated/validate --model models/1.maveric --model models/2.maveric --out validation"
)]
pub struct Validate {
    /// A run's results with second drives: see `generate --repeat-drives` and pipelines/validate.toml. With --leave-out a folder with
    /// `drives` of people in the roles of a design and, where they answered, `scores.csv`
    pub run: PathBuf,
    /// Trained model; several that differ, such as networks of the same training with other seeds, give ranges
    #[arg(long = "model", required_unless_present = "leave_out")]
    pub models: Vec<PathBuf>,
    /// Who is left out in turn, the rest being learned from: one person after the other of a study's own recordings
    #[arg(long, value_name = "people")]
    pub leave_out: Option<LeaveOut>,
    /// Design of the study whose roles were driven (TOML); study.toml of the current directory when not given
    #[arg(long, value_name = "FILE", requires = "leave_out")]
    pub design: Option<PathBuf>,
    /// Which heads learn where people are left out: linear, or paper, which needs a training for each exchange of roles
    #[arg(long, default_value_t = TrainSettings::default().heads, value_name = "linear|paper")]
    pub heads: HeadsKind,
    /// How often roles are exchanged within people; the design's number, else 1000, and none for the paper's networks, when not given
    #[arg(long, requires = "leave_out")]
    pub permutations: Option<usize>,
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

/// Who is left out in turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum LeaveOut {
    /// One person after the other
    People,
}

/// What a validation found, by what it was asked.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum Checked {
    /// Of people who drove twice.
    DroveTwice(Validated),
    /// Of people who were left out in turn.
    InTurn(leave_out::InTurn),
}

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
    /// Model by model; files that hold the same one are examined together.
    pub models: Vec<Examined>,
    /// What became of each question, over all models.
    pub findings: Vec<Finding>,
}

impl Stage for Validate {
    const NAME: &'static str = "validate";
    const FAILURE: &'static str = "could not validate";
    type Result = Checked;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        if self.leave_out.is_some() {
            let design = self.design.as_deref();
            return Ok(Files::default()
                .reads([self.run.join("drives")])
                .reads_if_there([self.run.join("scores.csv")])
                .reads_people(root, design, None)
                .reads_style(DesignFile::below(root, design).as_ref())
                .reads(&self.models)
                .reads(&self.scenario)
                .writes_into(&self.out, &["validation.md", "validation.json"]));
        }
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

    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Checked>, StudyError> {
        match self.leave_out {
            Some(LeaveOut::People) => Ok(leave_out::work(self, watch)?.map(Checked::InTurn)),
            None => Ok(self.drove_twice(watch)?.map(Checked::DroveTwice)),
        }
    }
}

impl Validate {
    /// Examines every model on the people of a run who drove twice; writes `validation.json`, `validation.md` and a
    /// page with figures and tables.
    fn drove_twice(&self, watch: Watch<'_>) -> Result<Outcome<Validated>, StudyError> {
        if self.models.is_empty() || self.worlds == 0 {
            let problem = format!(
                "{} models on {} roads: expected at least one of each",
                self.models.len(),
                self.worlds
            );
            let help = "name models with --model FILE";
            return Err(StudyError::not_possible(problem).with_help(help));
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
        for of in differing(&self.models)? {
            models.push(Examined {
                same: of.same,
                ..examination.examine(&of.file, &of.model, watch)?
            });
        }
        let measured = |drive: fn(&people::Person) -> &Drive| -> Vec<Values> {
            people.test.iter().map(|p| values(drive(p))).collect()
        };
        let retest = retest(&measured(|p| &p.first), &measured(|p| &p.again));
        let first = || people.test.iter().map(|p| p.first.meta().driven_by);
        let synthetic = first().any(|by| by == DrivenBy::Synthetic);
        let texts = tables::texts(&models, self, (people.test.len(), synthetic))?;
        let tables = tables::tables(&models, &retest, &texts)?;
        let value = Validated {
            synthetic,
            drivers: people.test.len(),
            training_drivers: people.training.len(),
            retest,
            findings: examine::findings(&models),
            models,
        };
        let mut summary = write(&self.out, &tables, &value)?;
        let warnings = warnings(&people, &value.models, &texts)?;
        let page = page::page(&value, self, (&texts, tables), &warnings)?;
        let page = write_page(&self.out, &page)?;
        let page = BTreeMap::from([("page", page.to_slash_lossy())]);
        summary.push(texts.with(&page).text("line")?);
        Ok(Outcome::new(value, summary, warnings))
    }
}

/// A model, and the files that hold it.
struct Differing {
    model: Model,
    file: String,
    same: Vec<String>,
}

/// The models of these files that drive differently: one that drives as an earlier one would be the same evidence a second time.
fn differing(files: &[PathBuf]) -> Result<Vec<Differing>, StudyError> {
    let mut all: Vec<Differing> = Vec::new();
    for path in files {
        let file = path.to_slash_lossy().into_owned();
        let model = read_model(path)?.on_range(ScoreRange::ADB);
        match all.iter_mut().find(|known| known.model.drives_as(&model)) {
            Some(known) => known.same.push(file),
            None => all.push(Differing { model, file, same: Vec::new() }),
        }
    }
    Ok(all)
}

/// Writes what was found as tables and as data, before a page of it could fail; gives the lines of the tables.
fn write<'a>(
    out: &Path,
    tables: impl IntoIterator<Item = &'a Table>,
    result: &impl Serialize,
) -> Result<Vec<String>, StudyError> {
    let tables: Vec<String> = tables.into_iter().map(Table::to_markdown).collect();
    let text = tables.join("\n");
    atomic_write_bytes(&out.join("validation.md"), text.as_bytes())?;
    write_json(&out.join("validation.json"), result)?;
    Ok(text.lines().map(str::to_owned).collect())
}

/// What was counted once, what could not be compared, and what should not have happened.
fn warnings(
    people: &people::People,
    models: &[Examined],
    texts: &PageTexts,
) -> Result<Vec<String>, StudyError> {
    #[derive(Serialize)]
    struct OneModel<'a> {
        model: &'a str,
        same: &'a [String],
        linear: bool,
    }
    #[derive(Serialize)]
    struct Gap {
        missing: usize,
        drives: usize,
        title: &'static str,
    }
    let mut warnings = Vec::new();
    for of in models.iter().filter(|m| !m.same.is_empty()) {
        let same =
            OneModel { model: &of.model, same: &of.same, linear: of.heads == HeadsKind::Linear };
        warnings.push(texts.with(&same).text("same")?);
    }
    for k in 0..MEASURES.len() {
        let drives = people.test.iter().flat_map(|p| [&p.first, &p.again]);
        let missing = Gap {
            missing: drives.filter(|d| values(d)[k].is_none()).count(),
            drives: 2 * people.test.len(),
            title: title(k),
        };
        if missing.missing > 0 {
            warnings.push(texts.with(&missing).text("missing")?);
        }
    }
    let collisions: u32 = models.iter().map(|m| m.collisions).sum();
    if collisions > 0 {
        let texts = texts.with(&BTreeMap::from([("collisions", collisions)]));
        warnings.push(texts.text("collisions")?);
    }
    Ok(warnings)
}
