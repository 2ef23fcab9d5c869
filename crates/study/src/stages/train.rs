//! `train`: the networks and the training drivers' embeddings.

use crate::{
    atomic_write::{atomic_write_bytes, write_json},
    design::drives_of,
    error::StudyError,
    outcome::{Outcome, Watch},
    style_scale::style_scores,
    tables::{
        embeddings::{EmbeddingRow, write_embeddings},
        surveys::read_scores,
    },
};
use maveric_domain::{AdbScore, ConditionId, Drive, Moment, Score};
use maveric_model::{
    Checkpoints, EpochReport, Model, ModelError, Quality, Selection, TrainParams, TrainSettings,
    TrainingDrive, TrainingState, checkpoint, style_space::AggressionAxis, train_resumable,
};
use maveric_participants::Part;
use serde::{Deserialize, Serialize};
use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
    time::Instant,
};

/// What to train on, and how.
#[derive(Debug, Clone)]
pub struct TrainOptions {
    /// The study's design; `study.toml` of the folder one stands in without. Without either every drive counts.
    pub design: Option<PathBuf>,
    /// Who takes part; the design's table without.
    pub participants: Option<PathBuf>,
    /// Folder of drives.
    pub drives: PathBuf,
    /// Questionnaire scores.
    pub scores: Option<PathBuf>,
    /// Model to write.
    pub out: PathBuf,
    /// Size of the embedding.
    pub embedding_size: usize,
    /// Passes over the rows.
    pub epochs: usize,
    /// Share of each drive, from its start, that may be learned from.
    pub fit_fraction: f64,
    /// Root of every random choice.
    pub seed: u64,
    /// Threads.
    pub jobs: usize,
    /// Share of each drive, at its end, that a run of its own keeps back to measure the losses on; 0: no such run.
    pub validation_fraction: f64,
    /// Epochs without a lower validation loss after which that run stops; 0: never.
    pub patience: usize,
    /// Whether to go on from the checkpoint beside the model, where there is one.
    pub resume: bool,
    /// Epochs from checkpoint to checkpoint; 0: only when interrupted.
    pub checkpoint_every: usize,
}

/// How the training went, as it is written beside the model.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TrainingSummary {
    /// Drives learned from.
    pub drives: usize,
    /// Of them with an ADB score.
    pub drives_with_adb: usize,
    /// Rows learned from.
    pub rows: usize,
    /// Of them following.
    pub following_rows: usize,
    /// Of them with a lane change being started.
    pub lane_change_rows: usize,
    /// Numbers in the networks.
    pub parameters: usize,
    /// Losses without data, and why.
    pub left_out: Vec<String>,
    /// Drives left out, and why.
    pub warnings: Vec<String>,
    /// Seed of the training.
    pub seed: u64,
    /// Settings of the training.
    pub settings: TrainSettings,
    /// Every epoch of the run that made the model.
    pub epochs: Vec<EpochReport>,
    /// The run that kept the end of every drive back: its losses on both parts, what stopped it, and how good its
    /// predictions are for rows it has not learned from.
    #[serde(default)]
    pub selection: Option<Selection>,
    /// How good the model's own predictions are: calibration of P(change), residuals of F and V.
    #[serde(default)]
    pub quality: Option<Quality>,
    /// ADB scores in the table that are of nobody who drove here.
    #[serde(default)]
    pub scores_without_drive: usize,
}

/// Name of the model among a run's results.
pub const MODEL_FILE: &str = "model.maveric";

/// File beside the model that holds the training's report.
pub fn training_path(model: &Path) -> PathBuf {
    beside(model, "_training.json")
}

/// File beside the model that holds the training embeddings.
pub fn embeddings_path(model: &Path) -> PathBuf {
    beside(model, "_embeddings.csv")
}

/// File beside the model that a training keeps its state in until it is done.
pub fn checkpoint_path(model: &Path) -> PathBuf {
    beside(model, "_checkpoint.maveric")
}

fn beside(model: &Path, suffix: &str) -> PathBuf {
    let stem = model.file_stem().unwrap_or_default().to_string_lossy();
    model.with_file_name(format!("{stem}{suffix}"))
}

/// Reads a trained model.
///
/// # Errors
/// [`StudyError`] naming the file, if it is no model, damaged, or of another version.
pub fn read_model(path: &Path) -> Result<Model, StudyError> {
    if path.is_dir() {
        return Err(StudyError::file(path, "is a folder, expected a model file"));
    }
    let bytes = std::fs::read(path).map_err(StudyError::read(path))?;
    checkpoint::from_bytes(&bytes).map_err(|e| StudyError::BadFile {
        path: path.to_owned(),
        problem: e.to_string(),
        help: e
            .suggestion()
            .map(str::to_owned)
            .or_else(|| Some("train a model with `maveric train`".to_owned())),
    })
}

/// The ADB score that belongs to a drive: the one answered before the drives, or in a professional's role.
pub(crate) fn adb_of(drive: &Drive, scores: &[Score]) -> Result<Option<AdbScore>, StudyError> {
    let meta = drive.meta();
    let moment = if meta.condition == ConditionId::OWN {
        Moment::Pre
    } else {
        Moment::After(meta.condition)
    };
    let points = scores
        .iter()
        .find(|s| {
            s.participant == meta.participant
                && s.moment == moment
                && s.scale == "adb"
                && s.subscale == "total"
        })
        .and_then(|s| s.value);
    Ok(points.map(AdbScore::new).transpose()?)
}

/// Trains on every drive of a folder; writes the model, the training's report and the training embeddings.
///
/// # Errors
/// [`StudyError`] if drives or scores cannot be read or settings are out of range; [`StudyError::Interrupted`].
pub fn train(
    options: &TrainOptions,
    watch: Watch<'_>,
) -> Result<Outcome<TrainingSummary>, StudyError> {
    let design = options.design.as_deref();
    let drives = drives_of(
        &options.drives,
        design,
        options.participants.as_deref(),
        Part::Learn,
    )?;
    let scores = options
        .scores
        .as_deref()
        .map(read_scores)
        .transpose()?
        .unwrap_or_default();
    let (scores, scale) = style_scores(scores, design)?;
    let settings = TrainSettings {
        embedding_size: options.embedding_size,
        epochs: options.epochs,
        fit_fraction: options.fit_fraction,
        validation_fraction: options.validation_fraction,
        patience: options.patience,
        ..TrainSettings::default()
    };
    let params = TrainParams::new(settings.clone())?;
    let mut unscored = Vec::new();
    let mut training = Vec::new();
    for drive in &drives {
        let adb = adb_of(drive, &scores)?;
        if adb.is_none() && options.scores.is_some() {
            unscored.push(format!(
                "drive {}: no ADB score, so it does not teach the style head",
                drive.meta().drive
            ));
        }
        training.push(TrainingDrive { drive, adb });
    }
    let scores_without_drive = without_drive(&scores, &drives);
    if let (Some(path), true) = (&options.scores, training.iter().all(|t| t.adb.is_none())) {
        refuse_foreign_scores(path, &scores, &drives, scores_without_drive)?;
    }
    let mut progress = EpochProgress::new(watch);
    let mut observe = |report: &EpochReport| progress.show(report);
    let (resume, mut resumed) = if options.resume {
        read_checkpoint(&checkpoint_path(&options.out))?
    } else {
        (None, Vec::new())
    };
    let mut failed = None;
    let mut save = |state: &TrainingState| {
        let write = || -> Result<(), StudyError> {
            atomic_write_bytes(&checkpoint_path(&options.out), &state.to_bytes()?)
        };
        match write() {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                failed = Some(error);
                ControlFlow::Break(())
            }
        }
    };
    let checkpoints = Checkpoints {
        resume,
        every: options.checkpoint_every,
        save: &mut save,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.jobs)
        .build();
    let pool = pool.map_err(|e| StudyError::NotPossible {
        problem: format!("cannot start {} threads: {e}", options.jobs),
        help: None,
    })?;
    let seed = options.seed;
    let trained =
        pool.install(|| train_resumable(&training, &params, seed, checkpoints, &mut observe));
    let trained = match (trained, failed) {
        (_, Some(error)) => return Err(error),
        (Err(ModelError::Cancelled { .. }), None) => return Err(StudyError::Interrupted),
        (other, None) => other?,
    };
    atomic_write_bytes(&options.out, &checkpoint::to_bytes(&trained.model)?)?;
    let report = trained.report;
    let summary = TrainingSummary {
        drives: report.drives,
        drives_with_adb: report.drives_with_adb,
        rows: report.rows,
        following_rows: report.following_rows,
        lane_change_rows: report.lane_change_rows,
        parameters: report.parameters,
        left_out: report
            .left_out
            .iter()
            .map(|(loss, why)| format!("{loss}: {why}"))
            .collect(),
        warnings: unscored
            .into_iter()
            .chain(report.warnings.iter().map(ToString::to_string))
            .collect(),
        seed: options.seed,
        settings,
        epochs: report.epochs,
        selection: report.selection,
        quality: Some(report.quality),
        scores_without_drive,
    };
    write_json(&training_path(&options.out), &summary)?;
    let axis = AggressionAxis::of(&trained.model).ok();
    let mut rows = Vec::new();
    for (id, embedding) in trained.embeddings {
        let Some(drive) = drives.iter().find(|d| d.meta().drive == id) else {
            continue;
        };
        let meta = drive.meta();
        rows.push(EmbeddingRow {
            drive: id,
            participant: meta.participant.clone(),
            condition: meta.condition,
            adb_used: adb_of(drive, &scores)?.is_some(),
            adb: adb_of(drive, &scores)?.map(AdbScore::points),
            adb_hat: axis
                .as_ref()
                .map(|a| a.aggression_hat(&embedding))
                .transpose()?,
            line_position: axis.as_ref().map(|a| a.position(&embedding)).transpose()?,
            start_spread: None,
            rows: None,
            details: None,
            embedding,
        });
    }
    scale.outward_rows(&mut rows);
    write_embeddings(&embeddings_path(&options.out), &rows)?;
    let checkpoint = checkpoint_path(&options.out);
    if checkpoint.exists() {
        std::fs::remove_file(&checkpoint).map_err(StudyError::write(&checkpoint))?;
    }
    resumed.extend(summary.warnings.iter().cloned());
    let warnings = resumed;
    let mut lines = vec![format!(
        "{} parameters trained on {} drives, {} rows: {}",
        summary.parameters,
        summary.drives,
        summary.rows,
        options.out.display()
    )];
    lines.extend(summary.selection.as_ref().map(validation_line));
    lines.extend(progress.rate_line());
    Ok(Outcome {
        value: summary,
        summary: lines,
        warnings,
    })
}

/// What the run with validation found, in a line.
fn validation_line(selection: &Selection) -> String {
    let last = selection.epochs.get(selection.kept_epoch.wrapping_sub(1));
    let numbers = |of: fn(&EpochReport) -> Option<f64>| {
        last.and_then(of)
            .map_or("none".to_owned(), |v| format!("{v:.3}"))
    };
    let line = format!(
        "epoch {} of a run on the rest: loss {} on {} rows kept back, {} on the rows learned from",
        selection.kept_epoch,
        numbers(|e| e.validation_total),
        selection.validation_rows,
        // L4 has no rows, so the loss kept back has none of it.
        numbers(|e| Some(e.total)),
    );
    match &selection.quality.lane_change {
        Some(calibration) => format!(
            "{line}; P(change) off by {:.4} where {:.4} is observed",
            calibration.expected_calibration_error, calibration.observed
        ),
        None => line,
    }
}

/// ADB scores of participants without a drive here.
fn without_drive(scores: &[Score], drives: &[Drive]) -> usize {
    let foreign = |s: &&Score| {
        s.scale == "adb"
            && s.subscale == "total"
            && s.value.is_some()
            && !drives.iter().any(|d| d.meta().participant == s.participant)
    };
    scores.iter().filter(foreign).count()
}

/// Scores that are all of other people are the wrong file, and not a study without scores.
fn refuse_foreign_scores(
    path: &Path,
    scores: &[Score],
    drives: &[Drive],
    foreign: usize,
) -> Result<(), StudyError> {
    let total = scores
        .iter()
        .filter(|s| s.scale == "adb" && s.subscale == "total" && s.value.is_some())
        .count();
    if foreign == 0 || foreign < total {
        return Ok(());
    }
    let of_scores = scores.iter().find(|s| s.scale == "adb");
    let of_scores = of_scores.map(|s| s.participant.to_string());
    let of_drives = drives.first().map(|d| d.meta().participant.to_string());
    Err(StudyError::BadFile {
        path: path.to_owned(),
        problem: format!(
            "none of its {total} ADB scores is of a participant who drives here: the first is of {}, the first \
             drive of {}",
            of_scores.unwrap_or_default(),
            of_drives.unwrap_or_default()
        ),
        help: Some(
            "give the scores of these participants, or none: there is then no style head"
                .to_owned(),
        ),
    })
}

/// The state to go on from, and what to tell about it.
fn read_checkpoint(path: &Path) -> Result<(Option<TrainingState>, Vec<String>), StudyError> {
    if !path.exists() {
        let none = format!(
            "no checkpoint {}, so the training starts from the beginning",
            path.display()
        );
        return Ok((None, vec![none]));
    }
    let bytes = std::fs::read(path).map_err(StudyError::read(path))?;
    let state = TrainingState::from_bytes(&bytes).map_err(|error| StudyError::BadFile {
        path: path.to_owned(),
        problem: error.to_string(),
        help: error.suggestion().map(str::to_owned),
    })?;
    Ok((Some(state), Vec::new()))
}

/// Tells how the epochs go: losses, bound, rate.
struct EpochProgress<'a> {
    watch: Watch<'a>,
    last: Instant,
    /// Rows a second of the fastest epoch so far.
    rows_per_s: Option<f64>,
}

impl<'a> EpochProgress<'a> {
    fn new(watch: Watch<'a>) -> Self {
        Self {
            watch,
            last: Instant::now(),
            rows_per_s: None,
        }
    }

    fn show(&mut self, report: &EpochReport) -> ControlFlow<()> {
        let seconds = self.last.elapsed().as_secs_f64();
        self.last = Instant::now();
        // The first epoch includes reading the rows.
        let rate = (report.epoch > 1 && seconds > 0.0).then(|| report.rows as f64 / seconds);
        self.rows_per_s = match (self.rows_per_s, rate) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
        let text = epoch_line(report, rate);
        match self.watch.step(report.epoch, report.epochs, &text) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    }

    fn rate_line(&self) -> Option<String> {
        let rate = self.rows_per_s?;
        Some(format!("{:.0} thousand rows a second", rate / 1e3))
    }
}

/// An epoch's losses, the bound, and how fast it went.
fn epoch_line(report: &EpochReport, rows_per_s: Option<f64>) -> String {
    let losses = report.validation.unwrap_or(report.losses);
    let terms = [
        losses.following_distance,
        losses.lane_change,
        losses.velocity,
        report.losses.aggression,
        losses.mutual_information,
    ];
    let rows = match report.validation {
        Some(_) => "epochs, kept-back rows:",
        None => "epochs:",
    };
    let terms = (1..).zip(terms);
    let terms = terms.filter_map(|(number, term)| Some(format!("L{number} {:.3}", term?)));
    let mut parts = vec![format!(
        "{rows} {}",
        terms.collect::<Vec<String>>().join(" ")
    )];
    let bound = losses.mutual_information_bound;
    parts.extend(bound.map(|bound| format!("I >= {bound:.2} nats")));
    parts.extend(rows_per_s.map(|rate| format!("{:.0}k rows/s", rate / 1e3)));
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_model::LossTerms;

    #[test]
    fn an_epochs_line_names_every_loss_that_there_is() {
        let losses = LossTerms {
            velocity: Some(0.25),
            mutual_information_bound: Some(1.5),
            ..LossTerms::default()
        };
        let report = EpochReport {
            epoch: 2,
            epochs: 3,
            rows: 1000,
            losses,
            total: 0.25,
            validation: None,
            validation_total: None,
            learning_rate: 1e-3,
            gradient_norm: 1.0,
        };
        assert_eq!(
            epoch_line(&report, Some(812_345.0)),
            "epochs: L3 0.250, I >= 1.50 nats, 812k rows/s"
        );
    }

    #[test]
    fn a_missing_checkpoint_is_said_and_a_broken_one_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = checkpoint_path(&folder.path().join("model.maveric"));
        let (state, said) = read_checkpoint(&path).unwrap();
        assert!(state.is_none() && said[0].contains("from the beginning"));
        std::fs::write(&path, "nothing of the kind").unwrap();
        let error = read_checkpoint(&path).unwrap_err();
        assert!(
            error.to_string().contains("model_checkpoint.maveric"),
            "{error}"
        );
        assert!(error.suggestion().unwrap().contains("--resume"));
    }
}
