//! `train`: the heads and the training drivers' embeddings.

mod epochs;

use crate::{
    atomic_write::{atomic_write_bytes, write_json},
    design::{DesignFile, drives_of},
    error::StudyError,
    off_the_scale,
    once::{count, told_once},
    outcome::{Outcome, Watch, threads},
    run_folder::{embeddings_path, training_path},
    stage::{Files, Stage},
    style_scores::StyleScores,
    tables::{
        embeddings::{EmbeddingRow, write_embeddings},
        surveys::read_scores,
    },
};
use epochs::EpochProgress;
use maveric_domain::{Drive, ScoreRange, StyleScore};
use maveric_model::{
    Days, EpochReport, HeadReport, Heads, Model, ModelError, NetworkReport, Selection, StyleHead,
    TrainSettings, TrainingDrive, learn_days, model_file, style_space::LinearHead, train as learn,
};
pub use maveric_model::{FreeSpeed, HeadsKind};
use maveric_participants::Part;
use path_slash::PathExt as _;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Learn heads and the training drivers' embeddings
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric train --drives drives/study1 --scores scores.csv --out model.maveric"
)]
pub struct Train {
    /// Design of the study (TOML); study.toml of the current directory when not given. Without either every drive counts
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Who takes part; the design's table when not given
    #[arg(long)]
    pub participants: Option<PathBuf>,
    /// Folder of drives
    #[arg(long)]
    pub drives: PathBuf,
    /// Folder of second drives of the same people, on another day: how far one person’s drives differ, for the standard errors of
    /// styles. Heads and networks do not learn from them
    #[arg(long, value_name = "FOLDER")]
    pub again: Option<PathBuf>,
    /// Questionnaire scores; without them there is no style head and no aggression line
    #[arg(long)]
    pub scores: Option<PathBuf>,
    /// Model to write; its report and the training embeddings go beside it
    #[arg(long)]
    pub out: PathBuf,
    /// Which heads learn: linear (habits as events) or paper (its five networks, which the epochs, fractions and patience below
    /// are about)
    #[arg(long, default_value_t = TrainSettings::default().heads, value_name = "linear|paper")]
    pub heads: HeadsKind,
    /// How linear heads read a free speed: in m/s, or beside what is posted (absolute or posted)
    #[arg(long, default_value = "absolute", value_name = "absolute|posted")]
    pub free_speed: FreeSpeed,
    /// Size of the embedding
    #[arg(long, default_value_t = TrainSettings::default().embedding_size)]
    pub embedding_size: usize,
    /// Passes over the training rows
    #[arg(long, default_value_t = TrainSettings::default().epochs)]
    pub epochs: usize,
    /// Share of each drive, from its start, that may be learned from
    #[arg(long, default_value_t = TrainSettings::default().fit_fraction)]
    pub fit_fraction: f64,
    /// Share of the people whom a run of its own keeps back, to choose the number of passes by (0: no such run)
    #[arg(long, default_value_t = TrainSettings::default().validation_fraction)]
    pub validation_fraction: f64,
    /// Passes without a lower loss on those people after which that run stops (0: never)
    #[arg(long, default_value_t = TrainSettings::default().patience)]
    pub patience: usize,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
}

/// How the training went, as it is written beside the model.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TrainingSummary {
    pub drives: usize,
    /// Of them with a score of the style.
    pub drives_with_adb: usize,
    pub parameters: usize,
    /// Drives and losses left out, and why.
    pub warnings: Vec<String>,
    pub seed: u64,
    pub settings: TrainSettings,
    /// The linear heads: what each learned from, and how well it does on driving kept back.
    pub heads: Vec<HeadReport>,
    /// How the linear heads read a score from a style.
    pub style: Option<StyleHead>,
    /// The paper's networks; none for linear heads.
    pub networks: Option<NetworkReport>,
    /// How far one person's drives differ; none where nobody drove twice, and standard errors are of the drive.
    pub days: Option<Days>,
    /// Scores of the style in the table that are of nobody who drove here.
    pub scores_without_drive: usize,
}

impl Stage for Train {
    const NAME: &'static str = "train";
    const FAILURE: &'static str = "could not train";
    type Result = TrainingSummary;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let design = self.design.as_deref();
        let study = DesignFile::below(root, design);
        Ok(Files::default()
            .reads([&self.drives])
            .reads(&self.again)
            .reads(&self.scores)
            .reads_people(root, design, self.participants.as_deref())
            .reads_style(study.as_ref())
            .writes([&self.out, &training_path(&self.out), &embeddings_path(&self.out)]))
    }

    /// Trains on every drive of a folder; writes the model, the training's report and the training embeddings.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<TrainingSummary>, StudyError> {
        let design = self.design.as_deref();
        let drives = drives_of(&self.drives, design, self.participants.as_deref(), Part::Learn)?;
        let scores = self.scores.as_deref().map(read_scores).transpose()?;
        let study = DesignFile::here(design)?;
        let scores = StyleScores::of(scores.unwrap_or_default(), study.as_ref())?;
        let settings = self.settings();
        let baseline = DesignFile::find(design)?.design.baseline_id();
        let score = |drive: &Drive| scores.of_drive(drive, study.as_ref(), baseline);
        let mut unscored = Vec::new();
        let mut training = Vec::new();
        for drive in &drives {
            let adb = score(drive)?;
            if adb.is_none() && self.scores.is_some() {
                let why = "no score of the style, so it does not teach the style head";
                unscored.push((drive.meta().drive.to_string(), why.to_owned()));
            }
            training.push(TrainingDrive { drive, adb });
        }
        let scores_without_drive = without_drive(&scores, &drives);
        if let (Some(path), true) = (&self.scores, training.iter().all(|t| t.adb.is_none())) {
            refuse_foreign_scores(path, &scores, &drives, scores_without_drive)?;
        }
        let mut progress = EpochProgress::new(watch);
        let mut observe = |report: &EpochReport| progress.show(report);
        let pool = threads(self.jobs)?;
        let seed = self.seed;
        let trained = match pool.install(|| learn(&training, &settings, seed, &mut observe)) {
            Err(ModelError::Cancelled { .. }) => return Err(StudyError::Interrupted),
            other => other?,
        };
        let (report, model) = (trained.report, trained.model);
        let (model, nobody_twice) = match self.again.as_deref() {
            Some(folder) => {
                let again = drives_of(folder, design, self.participants.as_deref(), Part::Learn)?;
                pool.install(|| self.with_days(&model, &training, &again))?
            }
            None => (model, None),
        };
        atomic_write_bytes(&self.out, &model_file::to_bytes(&model)?)?;
        let summary = TrainingSummary {
            drives: report.drives,
            drives_with_adb: report.drives_with_adb,
            parameters: model.parameters(),
            days: model.days().cloned(),
            warnings: told_once("drive", unscored)
                .into_iter()
                .chain(nobody_twice)
                .chain(report.warnings.iter().map(ToString::to_string))
                .collect(),
            seed: self.seed,
            settings,
            heads: report.heads,
            style: style_of(&model),
            networks: report.networks,
            scores_without_drive,
        };
        write_json(&training_path(&self.out), &summary)?;
        let mut rows = self.places(&model, &drives, score)?;
        let off = off_the_scale::taken_out(model.score_range(), &mut rows);
        write_embeddings(&embeddings_path(&self.out), &rows)?;
        let mut warnings = summary.warnings.clone();
        warnings.extend(off_the_scale::warnings(model.score_range(), &off));
        let mut lines = self.lines(&summary, model.score_range());
        lines.extend(progress.rate_line());
        Ok(Outcome::new(summary, lines, warnings))
    }
}

impl Train {
    fn settings(&self) -> TrainSettings {
        TrainSettings {
            heads: self.heads,
            free_speed: self.free_speed,
            embedding_size: self.embedding_size,
            epochs: self.epochs,
            fit_fraction: self.fit_fraction,
            validation_fraction: self.validation_fraction,
            patience: self.patience,
            ..TrainSettings::default()
        }
    }

    /// Where the drives lie that the model learned from.
    fn places(
        &self,
        model: &Model,
        drives: &[Drive],
        score: impl Fn(&Drive) -> Result<Option<StyleScore>, StudyError>,
    ) -> Result<Vec<EmbeddingRow>, StudyError> {
        let axis = LinearHead::aggression(model).ok();
        let mut rows = Vec::new();
        for place in model.training() {
            let Some(drive) = drives.iter().find(|d| d.meta().drive == place.drive) else {
                continue;
            };
            let (meta, embedding) = (drive.meta(), place.embedding.clone());
            let adb = score(drive)?;
            let (id, who) = (place.drive.clone(), meta.participant.clone());
            rows.push(EmbeddingRow {
                session: meta.session,
                trial: meta.trial,
                // Linear heads learn where drivers lie from their driving alone.
                adb_used: self.heads == HeadsKind::Paper && adb.is_some(),
                adb: adb.map(StyleScore::points),
                adb_hat: axis.as_ref().map(|a| a.read(&embedding)).transpose()?,
                line_position: axis.as_ref().map(|a| a.position(&embedding)).transpose()?,
                ..EmbeddingRow::new(id, who, meta.condition, embedding)
            });
        }
        Ok(rows)
    }

    /// What is said of a training, a line each.
    fn lines(&self, summary: &TrainingSummary, scale: ScoreRange) -> Vec<String> {
        let mut lines = vec![format!(
            "{} heads, {} parameters trained on {} drives: {}",
            self.heads,
            summary.parameters,
            summary.drives,
            self.out.to_slash_lossy()
        )];
        lines.extend(summary.heads.iter().map(head_line));
        let style = summary.style.as_ref();
        lines.extend(style.map(|style| style_line(style, scale)));
        let selection = summary.networks.as_ref().and_then(|n| n.selection.as_ref());
        lines.extend(selection.map(validation_line));
        lines
    }

    /// The model with what second drives say of days, and a warning where they are of too few people to say it.
    fn with_days(
        &self,
        model: &Model,
        training: &[TrainingDrive<'_>],
        again: &[Drive],
    ) -> Result<(Model, Option<String>), ModelError> {
        let same = |a: &Drive, b: &Drive| {
            let (a, b) = (a.meta(), b.meta());
            (&a.participant, a.condition) == (&b.participant, b.condition)
        };
        let twice: Vec<[&Drive; 2]> = again
            .iter()
            .filter_map(|second| {
                Some([training.iter().find(|t| same(t.drive, second))?.drive, second])
            })
            .collect();
        let model = learn_days(model, training, self.fit_fraction, &twice, self.seed)?;
        let warning = model.days().is_none().then(|| {
            format!(
                "{} drove twice, expected at least {}: standard errors of styles are of a drive, not of a person",
                count(twice.len(), "person who is learned from", "people who are learned from"),
                self.embedding_size
            )
        });
        Ok((model, warning))
    }
}

/// How linear heads read a score from a style.
fn style_of(model: &Model) -> Option<StyleHead> {
    match model.heads() {
        Heads::Linear(linear) => linear.style.clone(),
        Heads::Paper(_) => None,
    }
}

/// What a head learned from and how it does on driving kept back, in a line.
fn head_line(head: &HeadReport) -> String {
    let learned = format!("{}: {} events of {} drives", head.title, head.events, head.drives);
    let Some(kept) = &head.kept_back else {
        return learned;
    };
    let worse = no_better(kept.head, kept.own_mean);
    let unit = if head.unit == "1" { "" } else { head.unit.as_str() };
    format!(
        "{learned}; off by {:.2} {unit} on {} kept back, the own mean by {:.2}, everybody's by {:.2}{worse}",
        kept.head, kept.events, kept.own_mean, kept.everybody
    )
}

fn no_better(error: f64, of_own_mean: f64) -> &'static str {
    if error < of_own_mean { "" } else { " (no better than the own mean)" }
}

/// How well the style says the score, in a line.
fn style_line(style: &StyleHead, scale: ScoreRange) -> String {
    let digits = 1 + scale.decimals();
    let left_out = match (style.cross_fitted_rmse, style.cross_fitted_r) {
        (Some(rmse), Some(r)) => {
            format!("; for people left out off by {rmse:.digits$} points, r = {r:.2}")
        }
        _ => String::new(),
    };
    format!(
        "score from {} of {}{left_out}",
        count(style.drives, "drive", "drives"),
        count(style.people, "person", "people")
    )
}

/// What the run that kept people back found, in a line.
fn validation_line(selection: &Selection) -> String {
    let (networks, own) = (&selection.networks, &selection.own_means);
    let beside = |what: &str, unit: &str, network: Option<f64>, own: Option<f64>| {
        let (network, own) = (network?, own?);
        let worse = no_better(network, own);
        Some(format!("{what} off by {network:.2} {unit}, the own mean by {own:.2}{worse}"))
    };
    let gap = beside("F", "m", networks.following_distance_m, own.following_distance_m);
    let speed = beside("V", "m/s", networks.speed_mps, own.speed_mps);
    let calibration = selection.quality.lane_change.as_ref().map(|c| {
        format!(
            "P(change) off by {:.4} where {:.4} is observed",
            c.expected_calibration_error, c.observed
        )
    });
    let parts: Vec<String> = [gap, speed, calibration].into_iter().flatten().collect();
    format!(
        "{} passes are best for {} people kept back: {}",
        selection.kept_epoch,
        selection.people,
        parts.join("; ")
    )
}

/// Scores of participants without a drive here.
fn without_drive(scores: &StyleScores, drives: &[Drive]) -> usize {
    let scored = scores.rows.iter().filter(|s| s.value.is_some());
    let foreign = scored.filter(|s| drives.iter().all(|d| d.meta().participant != s.participant));
    foreign.count()
}

/// Scores that are all of other people are the wrong file, and not a study without scores.
fn refuse_foreign_scores(
    path: &Path,
    scores: &StyleScores,
    drives: &[Drive],
    foreign: usize,
) -> Result<(), StudyError> {
    let total = scores.rows.iter().filter(|s| s.value.is_some()).count();
    if foreign == 0 || foreign < total {
        return Ok(());
    }
    let of_scores = scores.rows.first().map(|s| s.participant.to_string());
    let of_drives = drives.first().map(|d| d.meta().participant.to_string());
    let problem = format!(
        "none of its {total} scores of the style is of a participant who drives here: the first is of {}, the first \
             drive of {}",
        of_scores.unwrap_or_default(),
        of_drives.unwrap_or_default()
    );
    let help = "give the scores of these participants, or none: there is then no style head";
    Err(StudyError::file(path, problem).with_help(help))
}
