//! `train`: the networks and the training drivers' embeddings.

use crate::{
    atomic_write::{atomic_write_bytes, write_json},
    error::StudyError,
    outcome::{Outcome, Watch},
    tables::{
        drives::read_drives,
        embeddings::{EmbeddingRow, write_embeddings},
        surveys::read_scores,
    },
};
use maveric_domain::{AdbScore, Condition, Drive, Moment, Score};
use maveric_model::{
    EpochReport, Model, ModelError, TrainParams, TrainSettings, TrainingDrive, checkpoint,
    style_space::AggressionAxis,
};
use serde::{Deserialize, Serialize};
use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
};

/// What to train on, and how.
#[derive(Debug, Clone)]
pub struct TrainOptions {
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
    /// Every epoch.
    pub epochs: Vec<EpochReport>,
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
    let moment = if meta.condition == Condition::Own {
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
    let drives = read_drives(&options.drives)?;
    let scores = options
        .scores
        .as_deref()
        .map(read_scores)
        .transpose()?
        .unwrap_or_default();
    let settings = TrainSettings {
        embedding_size: options.embedding_size,
        epochs: options.epochs,
        fit_fraction: options.fit_fraction,
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
    let mut observe = |report: &EpochReport| match watch.step(report.epoch, report.epochs, "epochs")
    {
        Ok(()) => ControlFlow::Continue(()),
        Err(_) => ControlFlow::Break(()),
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.jobs)
        .build();
    let pool = pool.map_err(|e| StudyError::NotPossible {
        problem: format!("cannot start {} threads: {e}", options.jobs),
        help: None,
    })?;
    let trained =
        pool.install(|| maveric_model::train(&training, &params, options.seed, &mut observe));
    let trained = match trained {
        Err(ModelError::Cancelled { .. }) => return Err(StudyError::Interrupted),
        other => other?,
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
            study: meta.study,
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
    write_embeddings(&embeddings_path(&options.out), &rows)?;
    let warnings = summary.warnings.clone();
    let lines = vec![format!(
        "{} parameters trained on {} drives, {} rows: {}",
        summary.parameters,
        summary.drives,
        summary.rows,
        options.out.display()
    )];
    Ok(Outcome {
        value: summary,
        summary: lines,
        warnings,
    })
}
