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
    stage::{Files, Stage},
    tables::drives::read_drives,
};
use maveric_following::{
    FollowingEvaluation, FollowingRun, FollowingSettings, evaluate as evaluate_following,
};
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// Compare three fits of IDM on each drive's unseen last third
///
/// Fits the Intelligent Driver Model (IDM) to the first two thirds of drives: to the other people, with the driver's own time
/// gap, and with all parameters of the driver. Simulates the last third behind the recorded leader and prints the errors.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples: maveric evaluate --drives drives --out following.json
          \
                  maveric evaluate --drives drives --learn other_drives --out following.json")]
pub struct Evaluate {
    /// Folder of the drives that are judged
    #[arg(long)]
    pub drives: PathBuf,
    /// Folder of drives to learn from instead: their first two thirds; who is in both is judged by the others
    #[arg(long)]
    pub learn: Option<PathBuf>,
    /// Results to write (JSON)
    #[arg(long)]
    pub out: PathBuf,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Ego speed that a driver must exceed to have a time gap, in m/s (1 in dense traffic)
    #[arg(long, default_value_t = 2.0)]
    pub moving_above_mps: f64,
}

impl Stage for Evaluate {
    const NAME: &'static str = "evaluate";
    const FAILURE: &'static str = "could not evaluate";
    type Result = FollowingEvaluation;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        Ok(Files::default().reads([&self.drives]).reads(&self.learn).writes([&self.out]))
    }

    /// Fits the laws and simulates every driver's last third behind the recorded leader.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<FollowingEvaluation>, StudyError> {
        watch.step(0, 2, "laws")?;
        let judged = read_runs(&self.drives)?;
        let learned = match &self.learn {
            Some(folder) => read_runs(folder)?,
            None => judged.clone(),
        };
        let settings = FollowingSettings {
            seed: self.seed,
            moving_above_mps: self.moving_above_mps,
            ..FollowingSettings::default()
        };
        let mut evaluation = evaluate_following(&judged, &learned, &settings)?;
        watch.step(1, 2, "comparing")?;
        evaluation.compared = compare::pairs(&evaluation, self.seed)?;
        let with_findings =
            Judged { findings: &findings::findings(&evaluation), result: &evaluation };
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
