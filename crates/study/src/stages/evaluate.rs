//! `evaluate`: how well each driver's unseen last third is predicted in closed loop.

use crate::{
    atomic_write::write_json,
    error::StudyError,
    outcome::{Outcome, Watch},
    stages::train::read_model,
    tables::{drives::read_drives, embeddings::read_embeddings},
};
use maveric_model::{
    Predictor,
    following::{
        DistanceLaw, FollowingEvaluation, FollowingRun, FollowingSettings,
        evaluate as evaluate_following,
    },
};
use std::path::PathBuf;

/// What to evaluate.
#[derive(Debug, Clone)]
pub struct EvaluateOptions {
    /// Trained model.
    pub model: PathBuf,
    /// Embeddings fitted to the first two thirds.
    pub embeddings: PathBuf,
    /// Folder of drives.
    pub drives: PathBuf,
    /// Results to write.
    pub out: PathBuf,
    /// Root of every random choice.
    pub seed: u64,
}

/// Simulates every driver's last third behind the recorded leader: with the driver's own embedding, with the mean
/// embedding, and with the baselines.
///
/// # Errors
/// [`StudyError`] if an input cannot be read, a drive has no embedding, or has rows without a lead vehicle.
pub fn evaluate(
    options: &EvaluateOptions,
    watch: Watch<'_>,
) -> Result<Outcome<FollowingEvaluation>, StudyError> {
    let model = read_model(&options.model)?;
    if !model.learned().following_distance {
        return Err(StudyError::file(
            &options.model,
            "learned no following distance: its drives had no following rows",
        ));
    }
    let embeddings = read_embeddings(&options.embeddings)?;
    let mut runs = Vec::new();
    let mut own: Vec<DistanceLaw<'_>> = Vec::new();
    let mut mean: Vec<DistanceLaw<'_>> = Vec::new();
    for drive in read_drives(&options.drives)? {
        let id = drive.meta().drive.clone();
        let Some(row) = embeddings.iter().find(|e| e.drive == id) else {
            return Err(StudyError::file(
                &options.embeddings,
                format!("has no embedding of drive `{id}`"),
            ));
        };
        runs.push(FollowingRun::from_drive(&drive)?);
        let of_own = Predictor::new(&model, &row.embedding)?;
        let of_mean = Predictor::new(&model, model.mean_embedding())?;
        own.push(Box::new(move |speed| of_own.following_distance(speed)));
        mean.push(Box::new(move |speed| of_mean.following_distance(speed)));
    }
    watch.step(0, 1, "baselines")?;
    let settings = FollowingSettings {
        seed: options.seed,
        ..FollowingSettings::default()
    };
    let found = evaluate_following(&runs, &own, &mean, &settings)?;
    watch.step(1, 1, "baselines")?;
    write_json(&options.out, &found)?;
    let mut summary = vec![format!(
        "{} drivers, last third of each drive, closed loop: {}",
        runs.len(),
        options.out.display()
    )];
    for row in &found.means {
        summary.push(format!(
            "{:32} gap {:6.2} m   speed {:5.2} m/s   reached 0: {} of {}",
            row.method.label(),
            row.gap_rmse_m,
            row.speed_rmse_mps,
            row.reached_zero,
            row.drivers
        ));
    }
    Ok(Outcome {
        value: found,
        summary,
        warnings: Vec::new(),
    })
}
