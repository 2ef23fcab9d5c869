//! `evaluate`: how well each driver's unseen last third is predicted in closed loop.

mod learned;
mod text;

use crate::{
    atomic_write::write_json,
    error::StudyError,
    outcome::{Outcome, Watch},
    stages::train::read_model,
    tables::{drives::read_drives, embeddings::read_embeddings},
};
use learned::Learned;
use maveric_following::{
    Baselines, ClosedLoopSettings, FollowingEvaluation, FollowingRun, FollowingSettings,
    closed_loop_network::study, evaluate_beside,
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
    /// Ego speed above which a row has a time gap, in m/s.
    pub moving_above_mps: f64,
    /// From how many seeds to train the network in closed loop; 0 leaves it out.
    pub closed_loop_seeds: usize,
}

/// Simulates every driver's last third behind the recorded leader: by F and V of the model, by a network that is
/// trained here through its own simulated following, and by the baselines.
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
    let (mut runs, mut own) = (Vec::new(), Vec::new());
    for drive in read_drives(&options.drives)? {
        let id = drive.meta().drive.clone();
        let Some(row) = embeddings.iter().find(|e| e.drive == id) else {
            return Err(StudyError::file(
                &options.embeddings,
                format!("has no embedding of drive `{id}`"),
            ));
        };
        runs.push(FollowingRun::from_drive(&drive)?);
        own.push(row.embedding.clone());
    }
    let settings = FollowingSettings {
        seed: options.seed,
        moving_above_mps: options.moving_above_mps,
        ..FollowingSettings::default()
    };
    let learned = Learned::new(&model, &own)?;
    watch.step(0, 3, "baselines")?;
    let baselines = Baselines::calibrate(&runs, &settings)?;
    watch.step(1, 3, "network in closed loop")?;
    let closed_loop = if options.closed_loop_seeds > 0 {
        let how = ClosedLoopSettings::default();
        Some(study(&runs, &how, &settings, options.closed_loop_seeds)?)
    } else {
        None
    };
    watch.step(2, 3, "driving")?;
    let mut others = learned.velocity(&runs, &baselines, &settings);
    if let Some(study) = &closed_loop {
        others.extend(learned::closed_loop(study));
    }
    let (own_f, mean_f) = learned.distances();
    let mut found = evaluate_beside(&runs, &baselines, &own_f, &mean_f, &others, &settings)?;
    found.open_loop = learned.open_loop(&runs, &baselines, &settings);
    drop(others);
    found.closed_loop = closed_loop;
    watch.step(3, 3, "driving")?;
    write_json(&options.out, &found)?;
    let mut summary = vec![format!(
        "{} drivers, last third of each drive, closed loop: {}",
        runs.len(),
        options.out.display()
    )];
    summary.extend(text::lines(&found));
    Ok(Outcome {
        value: found,
        summary,
        warnings: Vec::new(),
    })
}
