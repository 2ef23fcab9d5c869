//! `evaluate`: how well each driver's unseen last third is predicted in closed loop.

mod compare;
pub(crate) mod findings;
pub(crate) mod tables;
mod text;

use crate::{
    atomic_write::write_json,
    error::StudyError,
    judged::Judged,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    run_folder::read_model,
    tables::{drives::read_drives, embeddings::read_embeddings},
};
use maveric_following::{
    DistanceLaw, Distances, FollowingEvaluation, FollowingRun, FollowingSettings,
    evaluate as evaluate_following,
};
use maveric_model::Predictor;
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// What to evaluate.
#[derive(Debug, Clone)]
pub struct EvaluateOptions {
    /// Folder of the drives that are judged.
    pub drives: PathBuf,
    /// Folder of the drives whose people are learned from; without it those who are judged, each from the others.
    pub learn: Option<PathBuf>,
    /// A trained model, and embeddings fitted to the first two thirds of the drives; without them F is left out.
    pub model: Option<(PathBuf, PathBuf)>,
    /// Results to write.
    pub out: PathBuf,
    /// Root of every random choice.
    pub seed: u64,
    /// Ego speed above which a row has a time gap, in m/s.
    pub moving_above_mps: f64,
    /// From how many seeds to train the network in closed loop; 0 leaves it out.
    pub closed_loop_seeds: usize,
}

/// Simulates every driver's last third behind the recorded leader: by a network that is trained here through its own simulated
/// following, by laws that are fitted here, and by F of a model.
///
/// # Errors
/// [`StudyError`] if an input cannot be read, a drive has no embedding, or has rows without a lead vehicle.
pub fn evaluate(
    options: &EvaluateOptions,
    watch: Watch<'_>,
) -> Result<Outcome<FollowingEvaluation>, StudyError> {
    let model = options
        .model
        .iter()
        .flat_map(|(model, embeddings)| [&**model, embeddings]);
    let folders = [&*options.drives]
        .into_iter()
        .chain(options.learn.as_deref());
    spare_inputs(folders.chain(model), [&*options.out])?;
    watch.step(0, 2, "laws and networks")?;
    let judged = read_runs(&options.drives)?;
    let learned = match &options.learn {
        Some(folder) => read_runs(folder)?,
        None => judged.clone(),
    };
    let settings = FollowingSettings {
        seed: options.seed,
        moving_above_mps: options.moving_above_mps,
        closed_loop_seeds: options.closed_loop_seeds,
        ..FollowingSettings::default()
    };
    let model = options.model.as_ref();
    let f = model
        .map(|(model, embeddings)| read_distances(model, embeddings, &judged))
        .transpose()?;
    let mut found = evaluate_following(&judged, &learned, f.as_ref(), &settings)?;
    watch.step(1, 2, "comparing")?;
    found.compared = compare::pairs(&found, options.seed)?;
    let with_findings = Judged {
        findings: &findings::findings(&found),
        result: &found,
    };
    write_json(&options.out, &with_findings)?;
    watch.step(2, 2, "comparing")?;
    let mut summary = vec![format!(
        "{} drivers, last third of each drive, closed loop; learned from {} people: {}",
        judged.len(),
        learned.len(),
        options.out.to_slash_lossy()
    )];
    summary.extend(text::lines(&found));
    Ok(Outcome {
        value: found,
        summary,
        warnings: Vec::new(),
    })
}

fn read_runs(folder: &Path) -> Result<Vec<FollowingRun>, StudyError> {
    let drives = read_drives(folder)?;
    let runs = drives.iter().map(FollowingRun::from_drive);
    Ok(runs.collect::<Result<_, _>>()?)
}

/// F of each driver with the own and with the mean embedding.
fn read_distances(
    model_file: &Path,
    embeddings_file: &Path,
    judged: &[FollowingRun],
) -> Result<Distances<'static>, StudyError> {
    let model = read_model(model_file)?;
    if !model.paper()?.learned().following_distance {
        return Err(StudyError::file(
            model_file,
            "learned no following distance: its drives had no following rows",
        ));
    }
    let embeddings = read_embeddings(embeddings_file)?;
    let by = |predictor: Predictor| -> DistanceLaw<'static> {
        Box::new(move |speed| predictor.following_distance(speed))
    };
    let mean = Predictor::new(&model, model.mean_embedding())?;
    let own = judged
        .iter()
        .map(|run| {
            let id = run.driver();
            let row = embeddings.iter().find(|e| e.drive.as_str() == id);
            let row = row.ok_or_else(|| {
                StudyError::file(embeddings_file, format!("has no embedding of drive `{id}`"))
            })?;
            Ok(by(Predictor::new(&model, &row.embedding)?))
        })
        .collect::<Result<_, StudyError>>()?;
    Ok(Distances {
        own,
        mean: judged.iter().map(|_| by(mean.clone())).collect(),
    })
}
