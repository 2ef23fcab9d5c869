//! `personalize`: an embedding for each drive, the networks frozen.

use crate::{
    error::StudyError,
    outcome::{Outcome, Watch, for_each_on},
    stages::train::{adb_of, read_model},
    tables::{
        drives::read_drives,
        embeddings::{EmbeddingRow, write_embeddings},
        surveys::read_scores,
    },
};
use maveric_domain::{AdbScore, Drive};
use maveric_model::{Model, PersonalizeParams, PersonalizeSettings, style_space::AggressionAxis};
use serde::Serialize;
use std::path::PathBuf;

/// What to fit.
#[derive(Debug, Clone)]
pub struct PersonalizeOptions {
    /// Trained model.
    pub model: PathBuf,
    /// Folder of drives.
    pub drives: PathBuf,
    /// Questionnaire scores.
    pub scores: Option<PathBuf>,
    /// Embeddings to write.
    pub out: PathBuf,
    /// Share of each drive, from its start, that may be learned from.
    pub fit_fraction: f64,
    /// Root of every random choice.
    pub seed: u64,
    /// Threads.
    pub jobs: usize,
}

/// What was fitted.
#[derive(Debug, Clone, Serialize)]
pub struct PersonalizedDrives {
    /// Drives.
    pub drives: usize,
    /// Largest spread between starts, in SDs of the training embeddings.
    pub largest_start_spread: f64,
    /// The embeddings.
    pub embeddings: Vec<EmbeddingRow>,
}

/// Fits an embedding to every drive of a folder: with its ADB score where there is one, and always without.
///
/// # Errors
/// [`StudyError`] if model, drives or scores cannot be read, or a drive is shorter than a window.
pub fn personalize(
    options: &PersonalizeOptions,
    watch: Watch<'_>,
) -> Result<Outcome<PersonalizedDrives>, StudyError> {
    let model = read_model(&options.model)?;
    let drives = read_drives(&options.drives)?;
    let scores = options
        .scores
        .as_deref()
        .map(read_scores)
        .transpose()?
        .unwrap_or_default();
    let mut fits: Vec<(&Drive, Option<AdbScore>, bool)> = Vec::new();
    for drive in &drives {
        let adb = adb_of(drive, &scores)?;
        if adb.is_some() && model.learned().aggression {
            fits.push((drive, adb, true));
        }
        fits.push((drive, adb, false));
    }
    let fitted = for_each_on(
        options.jobs,
        &fits,
        watch,
        "embeddings",
        |&(drive, adb, use_adb)| fit(&model, drive, adb, use_adb, options),
    )?;
    let mut warnings: Vec<String> = Vec::new();
    let mut rows = Vec::new();
    for (row, said) in fitted {
        warnings.extend(said);
        rows.push(row);
    }
    warnings.sort();
    warnings.dedup();
    if options.scores.is_some() {
        for drive in &drives {
            if adb_of(drive, &scores)?.is_none() {
                warnings.push(format!(
                    "drive {}: no ADB score, so fitted without",
                    drive.meta().drive
                ));
            }
        }
    }
    write_embeddings(&options.out, &rows)?;
    let largest = rows
        .iter()
        .filter_map(|r| r.start_spread)
        .fold(0.0, f64::max);
    let summary = vec![format!(
        "{} drives personalised, starts agree within {largest:.3} SD: {}",
        drives.len(),
        options.out.display()
    )];
    let value = PersonalizedDrives {
        drives: drives.len(),
        largest_start_spread: largest,
        embeddings: rows,
    };
    Ok(Outcome {
        value,
        summary,
        warnings,
    })
}

fn fit(
    model: &Model,
    drive: &Drive,
    adb: Option<AdbScore>,
    use_adb: bool,
    options: &PersonalizeOptions,
) -> Result<(EmbeddingRow, Vec<String>), StudyError> {
    let settings = PersonalizeSettings {
        use_adb,
        fit_fraction: options.fit_fraction,
        ..PersonalizeSettings::default()
    };
    let found = maveric_model::personalize(
        model,
        drive,
        adb,
        &PersonalizeParams::new(settings)?,
        options.seed,
    )?;
    let axis = AggressionAxis::of(model).ok();
    let meta = drive.meta();
    let row = EmbeddingRow {
        drive: meta.drive.clone(),
        participant: meta.participant.clone(),
        study: meta.study,
        condition: meta.condition,
        adb_used: found.used_adb,
        adb: adb.map(AdbScore::points),
        adb_hat: found.aggression_hat,
        line_position: axis.map(|a| a.position(&found.embedding)).transpose()?,
        start_spread: Some(found.start_spread),
        rows: Some(found.rows),
        embedding: found.embedding,
    };
    Ok((
        row,
        found.warnings.iter().map(ToString::to_string).collect(),
    ))
}
