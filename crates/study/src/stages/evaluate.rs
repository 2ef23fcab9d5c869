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
    run_folder::read_model,
    stage::{Files, Stage},
    tables::{drives::read_drives, embeddings::read_embeddings},
};
use maveric_following::{
    DistanceLaw, Distances, FollowingEvaluation, FollowingRun, FollowingSettings,
    evaluate as evaluate_following,
};
use maveric_model::Predictor;
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// Predict each drive's unseen last third in closed loop, beside car-following models
///
/// Trains a network through its own simulated following, calibrates constant time gap, Newell, Helly, Gipps and IDM to the first
/// two thirds, drives by them and by F of a model, and prints the whole table.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Examples: maveric evaluate --drives drives --model model.maveric --embeddings embeddings.csv --out following.json\n          \
                  maveric evaluate --drives drives --learn other_drives --out following.json"
)]
pub struct Evaluate {
    /// Folder of the drives that are judged
    #[arg(long)]
    pub drives: PathBuf,
    /// Folder of drives to learn from instead: their first two thirds; who is in both is judged by the others
    #[arg(long)]
    pub learn: Option<PathBuf>,
    /// Trained model, for F; left out without it
    #[arg(long, requires = "embeddings")]
    pub model: Option<PathBuf>,
    /// Embeddings fitted to the first two thirds of the drives
    #[arg(long, requires = "model")]
    pub embeddings: Option<PathBuf>,
    /// Results to write (JSON)
    #[arg(long)]
    pub out: PathBuf,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Ego speed above which a row has a time gap, in m/s (1 in dense traffic)
    #[arg(long, default_value_t = 2.0)]
    pub moving_above_mps: f64,
    /// From how many seeds to train the network in closed loop; 0 leaves it out
    #[arg(long, default_value_t = 5)]
    pub closed_loop_seeds: usize,
}

impl Stage for Evaluate {
    const NAME: &'static str = "evaluate";
    const FAILURE: &'static str = "could not evaluate";
    type Result = FollowingEvaluation;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        Ok(Files::default()
            .reads([&self.drives])
            .reads(&self.learn)
            .reads(&self.model)
            .reads(&self.embeddings)
            .writes([&self.out]))
    }

    /// Simulates every driver's last third behind the recorded leader: by a network that is trained here through its own simulated
    /// following, by laws that are fitted here, and by F of a model.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<FollowingEvaluation>, StudyError> {
        watch.step(0, 2, "laws and networks")?;
        let judged = read_runs(&self.drives)?;
        let learned = match &self.learn {
            Some(folder) => read_runs(folder)?,
            None => judged.clone(),
        };
        let settings = FollowingSettings {
            seed: self.seed,
            moving_above_mps: self.moving_above_mps,
            closed_loop_seeds: self.closed_loop_seeds,
            ..FollowingSettings::default()
        };
        let model = self.model.as_ref().zip(self.embeddings.as_ref());
        let f = model
            .map(|(model, embeddings)| read_distances(model, embeddings, &judged))
            .transpose()?;
        let mut evaluation = evaluate_following(&judged, &learned, f.as_ref(), &settings)?;
        watch.step(1, 2, "comparing")?;
        evaluation.compared = compare::pairs(&evaluation, self.seed)?;
        let with_findings = Judged {
            findings: &findings::findings(&evaluation),
            result: &evaluation,
        };
        write_json(&self.out, &with_findings)?;
        watch.step(2, 2, "comparing")?;
        let counted = tables::texts(&evaluation, None)?.text("counted")?;
        let mut summary = vec![format!(
            "{counted}, last third of each drive, closed loop; learned from {} people: {}",
            evaluation.learned_from,
            self.out.to_slash_lossy()
        )];
        summary.extend(text::lines(&evaluation)?);
        Ok(Outcome::new(evaluation, summary, Vec::new()))
    }
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
    let own_laws = judged
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
        own: own_laws,
        mean: judged.iter().map(|_| by(mean.clone())).collect(),
    })
}
