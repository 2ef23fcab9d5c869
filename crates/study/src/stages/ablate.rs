//! `ablate`: what each part of the model is worth on drivers that it has not seen.

use super::report::{hashed, write_page};
use crate::{
    atomic_write::write_json,
    design::DesignFile,
    error::StudyError,
    judged::Judged,
    mean::mean,
    outcome::{Outcome, Watch, threads},
    run_folder::adb_of,
    stage::{Files, Stage},
    tables::{drives::read_drives, surveys::read_scores},
};
use maveric_analysis::{Finding, Part, Question};
use maveric_domain::DrivenBy;
use maveric_model::{
    Ablated, AblationSettings, HeldOut, ModelError, TrainSettings, TrainingDrive, VariantResult,
    ablate as compare, variants,
};
use maveric_pages::{ABLATION, PageTexts, cards::ablation};
use maveric_report::{
    Context, Report,
    figures::ablation::{Ablation, AblationVariant, ablation as figure_of},
    html::Provenance,
    markup,
    tables::Table,
};
use maveric_stats::proportion;
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
};

/// Compare embedding sizes, losses, window lengths and baselines on drivers held out in turn
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric ablate --drives drives/study1 --scores scores.csv --sizes 1,2,5,8 --out ablation"
)]
pub struct Ablate {
    /// Folder of drives
    #[arg(long)]
    pub drives: PathBuf,
    /// Questionnaire scores
    #[arg(long)]
    pub scores: Option<PathBuf>,
    /// Folder to write into: ablation.json and a page
    #[arg(long)]
    pub out: PathBuf,
    /// Embedding sizes beside the default
    #[arg(long, value_delimiter = ',', default_value = "1,2,5,8")]
    pub sizes: Vec<usize>,
    /// Lengths of a window beside the default, in s
    #[arg(
        long = "windows",
        value_name = "WINDOWS",
        value_delimiter = ',',
        default_value = "2,8"
    )]
    pub windows_s: Vec<f64>,
    /// Parts into which the drivers are split
    #[arg(long, default_value_t = 5)]
    pub folds: usize,
    /// Passes over the rows of each training
    #[arg(long, default_value_t = 40)]
    pub epochs: usize,
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

type Of = fn(&HeldOut) -> Option<f64>;

/// What is compared: key of its title, unit, value.
const LOSSES: [(&str, &str, Of); 3] = [
    ("following_distance", "m", |h| h.following_distance_m),
    ("lane_change", "nats", |h| h.lane_change),
    ("speed", "m/s", |h| h.speed_mps),
];

/// What the texts of the page may ask for.
#[derive(Serialize)]
struct Words<'a> {
    preface: &'a str,
    drives: usize,
    folds: usize,
    folds_judged: usize,
    passes: usize,
    /// Share of a drive by which an unseen driver is known.
    known: f64,
    /// Drives that are too short to be judged.
    short: usize,
}

impl Stage for Ablate {
    const NAME: &'static str = "ablate";
    const FAILURE: &'static str = "could not ablate";
    type Result = Ablated;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        Ok(Files::default()
            .reads([&self.drives])
            .reads(&self.scores)
            .reads_design(None)
            .writes_into(&self.out, &["ablation.json"]))
    }

    fn repeated_by(&mut self, command: &str) {
        self.command.get_or_insert_with(|| command.to_owned());
    }

    /// Holds out each fold of drivers in turn for every variant; writes `ablation.json` and a page with the table and the
    /// figure.
    ///
    /// # Source
    /// Method section 3, "Embedding size"; the paper says that more than three numbers bring nothing.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Ablated>, StudyError> {
        let out = self.out.join("ablation.json");
        let drives = read_drives(&self.drives)?;
        let scores = self.scores.as_deref().map(read_scores).transpose()?;
        let scores = scores.unwrap_or_default();
        let baseline = DesignFile::find(None)?.design.baseline_id();
        let mut given = Vec::new();
        for drive in &drives {
            given.push(TrainingDrive {
                drive,
                adb: adb_of(drive, &scores, baseline)?,
            });
        }
        // Unseen drivers judge; nobody is kept back of those learned from.
        let base = TrainSettings {
            epochs: self.epochs,
            validation_fraction: 0.0,
            ..TrainSettings::default()
        };
        let settings = AblationSettings {
            folds: self.folds,
            ..AblationSettings::default()
        };
        let all = variants(&base, &self.sizes, &self.windows_s);
        let mut observe = |done, total| match watch.step(done, total, "trainings") {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        };
        let pool = threads(self.jobs)?;
        let found = pool.install(|| compare(&given, &all, &settings, self.seed, &mut observe));
        let found = match found {
            Err(ModelError::Cancelled { .. }) => return Err(StudyError::Interrupted),
            other => other?,
        };
        let synthetic = drives
            .iter()
            .any(|d| d.meta().driven_by == DrivenBy::Synthetic);
        let context = Context::of(synthetic, self.seed);
        let short = found.variants[0].of_each.iter();
        let short = short.filter(|h| h.is_none()).count();
        let words = Words {
            preface: &context.preface(),
            drives: found.drives.len(),
            folds: self.folds,
            folds_judged: found.settings.folds,
            passes: self.epochs,
            known: found.settings.known_fraction,
            short,
        };
        let texts = PageTexts::new(ABLATION, &words)?;
        let finding = parts(&found, &texts)?;
        let judged = Judged {
            result: &found,
            findings: finding.as_slice(),
        };
        write_json(&out, &judged)?;
        let table = texts.table("ablation", rows(&found))?;
        let text = table.to_markdown();
        let page = write_page(
            &self.out,
            &page(&found, finding.as_ref(), self, (&texts, table), &context)?,
        )?;
        let mut summary: Vec<String> = text.lines().map(str::to_owned).collect();
        summary.push(format!(
            "{} variants on {} drives, {} folds: {}",
            found.variants.len(),
            found.drives.len(),
            self.folds,
            page.to_slash_lossy()
        ));
        let mut warnings = Vec::new();
        if short > 0 {
            warnings.push(texts.text("short")?);
        }
        Ok(Outcome {
            value: found,
            summary,
            warnings,
        })
    }
}

/// A variant's value on every drive.
fn values(variant: &VariantResult, of: Of) -> Vec<Option<f64>> {
    variant
        .of_each
        .iter()
        .map(|h| h.as_ref().and_then(of))
        .collect()
}

/// A variant with each loss: its mean, and on how many of the drives of both it is lower than the reference.
#[derive(Serialize)]
struct Row<'a> {
    name: &'a str,
    losses: [LossRow; 3],
}

#[derive(Serialize)]
struct LossRow {
    mean: Option<f64>,
    better: Option<usize>,
    both: Option<usize>,
}

fn rows(found: &Ablated) -> impl Iterator<Item = Row<'_>> {
    let reference = &found.variants[0];
    let row = |variant: &VariantResult, of: Of| {
        let known: Vec<f64> = values(variant, of).into_iter().flatten().collect();
        let pairs = values(variant, of).into_iter().zip(values(reference, of));
        let both: Vec<f64> = pairs.filter_map(|(v, r)| Some(v? - r?)).collect();
        let compared = variant.name != reference.name && !both.is_empty();
        LossRow {
            mean: mean(&known),
            better: compared.then(|| both.iter().filter(|d| **d < 0.0).count()),
            both: compared.then_some(both.len()),
        }
    };
    found.variants.iter().map(move |variant| Row {
        name: &variant.name,
        losses: LOSSES.map(|(_, _, of)| row(variant, of)),
    })
}

fn page(
    found: &Ablated,
    finding: Option<&Finding>,
    options: &Ablate,
    (texts, table): (&PageTexts, Table),
    context: &Context,
) -> Result<Report, StudyError> {
    let titles = LOSSES.map(|(key, unit, _)| Ok(format!("{} ({unit})", texts.text(key)?)));
    // The own time gap predicts one thing of three; it stands in the table.
    let shown = found.variants.iter().filter(|v| {
        LOSSES
            .iter()
            .all(|(_, _, of)| values(v, *of).iter().any(Option::is_some))
    });
    let figure = Ablation {
        losses: titles.into_iter().collect::<Result<_, StudyError>>()?,
        variants: shown
            .map(|v| AblationVariant {
                name: v.name.clone(),
                losses: LOSSES.iter().map(|(_, _, of)| values(v, *of)).collect(),
            })
            .collect(),
        folds: found.settings.folds,
    };
    let new = texts.page(context, (options.seed, options.command.as_deref()))?;
    let figures = vec![figure_of(&figure, context)?];
    Ok(Report {
        cards: finding
            .map(|finding| ablation::parts(finding, &found.variants[0].name))
            .into_iter()
            .collect::<Result<_, _>>()?,
        sections: vec![texts.section("ablation", figures, vec![table])?],
        provenance: Provenance {
            inputs: hashed(options.scores.iter().cloned())?,
            ..new.provenance
        },
        ..new
    })
}

/// Is the whole model better than it is without each of its parts? For every variant and loss it has to be on more than half of the unseen
/// drives; ties count for neither.
fn parts(found: &Ablated, texts: &PageTexts) -> Result<Option<Finding>, StudyError> {
    let Some((reference, others)) = found.variants.split_first() else {
        return Ok(None);
    };
    let mut parts = Vec::new();
    for variant in others {
        for (title, _, of) in LOSSES {
            let pairs = values(variant, of).into_iter().zip(values(reference, of));
            let differences = pairs.filter_map(|(v, r)| Some(v? - r?));
            let differences: Vec<f64> = differences.filter(|d| *d != 0.0).collect();
            let worse = differences.iter().filter(|d| **d > 0.0).count();
            let share = proportion(worse, differences.len(), 0.95).ok();
            if let Some(share) = share {
                let title = texts.text(title)?;
                let of = format!("{}: {}", variant.name, markup::plain(&title));
                let ends = (0.5, f64::INFINITY);
                parts.push(Part::share(of, differences.len(), Some(&share), ends));
            }
        }
    }
    Ok(Some(Finding::every(Question::Parts, parts)))
}
