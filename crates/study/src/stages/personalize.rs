//! `personalize`: an embedding for each drive, the heads as they are.

mod learning_curve;

pub use learning_curve::{CurveRow, MeanWithInterval};
use path_slash::PathExt as _;

use crate::{
    beyond,
    design::{DesignFile, drives_of},
    error::StudyError,
    forget::refuse_learned_from_gone,
    off_the_scale::{self, OffTheScale},
    once::told_once,
    outcome::{Outcome, Watch, for_each_on},
    run_folder::read_model,
    stage::{Files, Stage},
    style_scores::StyleScores,
    tables::{
        embeddings::{EmbeddingRow, write_embeddings},
        surveys::read_scores,
    },
};
use maveric_domain::{Drive, StyleScore};
use maveric_model::{ModelError, Personalizer, Support, TrainSettings, style_space::LinearHead};
use maveric_participants::Part;
use serde::Serialize;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Fit an embedding to each drive, the networks frozen
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric personalize --model model.maveric --drives drives/study2 --scores scores.csv --out embeddings.csv"
)]
pub struct Personalize {
    /// Design of the study (TOML); study.toml of the current directory when not given. Without either every drive counts
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Who takes part; the design's table when not given
    #[arg(long)]
    pub participants: Option<PathBuf>,
    /// Trained model
    #[arg(long)]
    pub model: PathBuf,
    /// Folder of drives
    #[arg(long)]
    pub drives: PathBuf,
    /// Questionnaire scores; each drive is then fitted both with and without its score of the style
    #[arg(long)]
    pub scores: Option<PathBuf>,
    /// Embeddings to write
    #[arg(long)]
    pub out: PathBuf,
    /// Write how good embeddings are after 1, 2, 5 and 10 minutes, judged on each drive's last fifth (CSV or JSON by name)
    #[arg(long, value_name = "FILE")]
    pub learning_curve: Option<PathBuf>,
    /// Share of each drive, from its start, that may be learned from
    #[arg(long, default_value_t = TrainSettings::default().fit_fraction)]
    pub fit_fraction: f64,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
}

#[derive(Debug, Clone, Serialize)]
pub struct PersonalizedDrives {
    /// Drives whose style was fitted.
    pub drives: usize,
    /// Drives left out: too short.
    pub left_out: usize,
    /// Drives that show no habit: nothing is known of their drivers but what is known of everybody.
    pub without_habits: usize,
    /// Scored participants of whom no drive is here.
    pub scored_without_drive: usize,
    /// Median standard error over drives and coordinates; none where no drive is long enough to tell.
    pub median_standard_error: Option<f64>,
    /// How good an embedding is after some minutes; empty unless asked for.
    pub learning_curve: Vec<CurveRow>,
    /// Drives that read as no score of the scale, with what was read.
    pub off_the_scale: Vec<OffTheScale>,
    /// Drives beyond what the model has learned from: those, and drives that the people learned from do not explain.
    pub beyond: usize,
    pub people_learned_from: usize,
    /// One row for each of these drives.
    pub embeddings: Vec<EmbeddingRow>,
}

/// One fit to make: a drive, and its score where that is to be fitted too.
struct Task<'a> {
    drive: &'a Drive,
    adb: Option<StyleScore>,
    use_adb: bool,
}

/// What is fitted, and which drives have no score, with what is said of it.
type Tasks<'a> = (Vec<Task<'a>>, Vec<(String, String)>);

impl Stage for Personalize {
    const NAME: &'static str = "personalize";
    const FAILURE: &'static str = "could not personalize";
    type Result = PersonalizedDrives;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let design = self.design.as_deref();
        let study = DesignFile::below(root, design);
        Ok(Files::default()
            .reads([&self.model, &self.drives])
            .reads(&self.scores)
            .reads_people(root, design, self.participants.as_deref())
            .reads_style(study.as_ref())
            .writes([&self.out])
            .writes(&self.learning_curve))
    }

    /// Fits an embedding to every drive of a folder: with its score where there is one, and always without.
    ///
    /// A drive that is too short is left out with a warning; one that shows no habit says nothing, with a warning.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<PersonalizedDrives>, StudyError> {
        let design = self.design.as_deref();
        let study = DesignFile::find(design)?;
        refuse_learned_from_gone(&study, &self.model)?;
        let model = read_model(&self.model)?;
        let baseline = study.design.baseline_id();
        let drives = drives_of(&self.drives, design, self.participants.as_deref(), Part::Test)?;
        let (scores, scored_without_drive) = self.scores_of(&drives)?;
        let model = model.on_range(scores.range);
        let personalizer = Personalizer::of_first(&model, self.fit_fraction)?;
        let mut warnings = Vec::new();
        let (tasks, unscored) = self.tasks(&drives, |drive| {
            let score = scores.of_drive(drive, None, baseline)?;
            Ok((score, score.is_some() && model.knows_aggression()))
        })?;
        warnings.extend(told_once("drive", unscored));
        let fitted = for_each_on(self.jobs, &tasks, watch, "embeddings", |task| {
            match fit(&personalizer, task) {
                Err(StudyError::Model(short @ ModelError::DriveTooShort { .. })) => Ok(Err(short)),
                other => other.map(Ok),
            }
        })?;
        let (mut rows, mut short) = (Vec::new(), BTreeSet::new());
        for result in fitted {
            match result {
                Ok(row) => rows.push(row),
                Err(error) => {
                    short.insert(format!("{error}; left out"));
                }
            }
        }
        if rows.is_empty() {
            return Err(self.shows_nothing(drives.len()));
        }
        let left_out = short.len();
        warnings.extend(short);
        let (without_habits, blank) = without_habits(&rows);
        warnings.extend(blank);
        let mut summary = Vec::new();
        let learning_curve = match &self.learning_curve {
            Some(path) => {
                let curve = learning_curve::of_drives(&personalizer, &drives, (self, path), watch)?;
                warnings.extend(curve.warnings);
                summary.push(format!(
                    "learning curve of {} drives: {}",
                    curve.value.drives,
                    path.to_slash_lossy()
                ));
                summary.extend(curve.summary);
                curve.value.rows
            }
            None => Vec::new(),
        };
        let off_the_scale = off_the_scale::taken_out(model.score_range(), &mut rows);
        warnings.extend(off_the_scale::warnings(model.score_range(), &off_the_scale));
        warnings.extend(beyond::warnings(&model, &rows));
        let strangers = rows.iter().filter(|row| row.beyond() == Some(true));
        let strangers: BTreeSet<&str> = strangers.map(|row| row.drive.as_str()).collect();
        write_embeddings(&self.out, &rows)?;
        let median_standard_error = median_standard_error(&rows);
        let error = median_standard_error.map(|e| format!(", standard error {e:.2} (median)"));
        let line = format!(
            "{} drives personalised{}: {}",
            drives.len() - left_out,
            error.unwrap_or_default(),
            self.out.to_slash_lossy()
        );
        summary.insert(0, line);
        let value = PersonalizedDrives {
            drives: drives.len() - left_out,
            left_out,
            without_habits,
            scored_without_drive,
            median_standard_error,
            learning_curve,
            off_the_scale,
            beyond: strangers.len(),
            people_learned_from: model.people(),
            embeddings: rows,
        };
        Ok(Outcome::new(value, summary, warnings))
    }
}

impl Personalize {
    /// What people scored, and how many who have a score do not drive here.
    fn scores_of(&self, drives: &[Drive]) -> Result<(StyleScores, usize), StudyError> {
        let study = DesignFile::here(self.design.as_deref())?;
        let Some(path) = &self.scores else {
            return Ok((StyleScores::of(Vec::new(), study.as_ref())?, 0));
        };
        let scores = StyleScores::of(read_scores(path)?, study.as_ref())?;
        let without_drive = scored_without_drive(&scores, drives, path)?;
        Ok((scores, without_drive))
    }

    /// What is fitted: of each drive an embedding with its score, where that can be used, and one without; which drives have no score, where scores
    /// were given. `score` has that of a drive, and whether it can be used.
    fn tasks<'a>(
        &self,
        drives: &'a [Drive],
        score: impl Fn(&Drive) -> Result<(Option<StyleScore>, bool), StudyError>,
    ) -> Result<Tasks<'a>, StudyError> {
        let (mut tasks, mut unscored) = (Vec::new(), Vec::new());
        for drive in drives {
            let (adb, usable) = score(drive)?;
            let with = usable.then_some(true);
            tasks.extend(with.into_iter().chain([false]).map(|use_adb| Task {
                drive,
                adb,
                use_adb,
            }));
            if adb.is_none() && self.scores.is_some() {
                let why = "no score of the style, so fitted without";
                unscored.push((drive.meta().drive.to_string(), why.to_owned()));
            }
        }
        Ok((tasks, unscored))
    }

    fn shows_nothing(&self, drives: usize) -> StudyError {
        let problem = format!(
            "{}: none of {drives} drives shows how its driver drives",
            self.drives.to_slash_lossy()
        );
        StudyError::not_possible(problem).with_help("record longer drives")
    }
}

/// How many drives show no habit, and what is said of them.
fn without_habits(rows: &[EmbeddingRow]) -> (usize, Vec<String>) {
    let blank: BTreeSet<&str> =
        rows.iter().filter(|row| row.readings == Some(0)).map(|row| row.drive.as_str()).collect();
    let why = "shows no habit (no free road, nobody followed or passed), so its driver is taken as anybody";
    let reasons = blank.iter().map(|drive| ((*drive).to_owned(), why.to_owned()));
    (blank.len(), told_once("drive", reasons))
}

/// Counts the participants with a score and without a drive; if that is all of them, the files do not belong
/// together.
fn scored_without_drive(
    scores: &StyleScores,
    drives: &[Drive],
    path: &Path,
) -> Result<usize, StudyError> {
    let scored: BTreeSet<&str> = scores.rows.iter().map(|s| s.participant.as_str()).collect();
    let drive: BTreeSet<&str> = drives.iter().map(|d| d.meta().participant.as_str()).collect();
    let without = scored.difference(&drive).count();
    if !scored.is_empty() && without == scored.len() {
        let first =
            |names: &BTreeSet<&str>| names.iter().next().copied().unwrap_or("none").to_owned();
        let problem = format!(
            "none of its {without} scored participants (first: {}) drives here (first: {})",
            first(&scored),
            first(&drive)
        );
        let help = "give the scores of these drivers, or leave --scores out";
        return Err(StudyError::file(path, problem).with_help(help));
    }
    Ok(without)
}

fn median_standard_error(rows: &[EmbeddingRow]) -> Option<f64> {
    let standard_errors = |r: &EmbeddingRow| {
        let d = r.embedding.size();
        let covariance = r.covariance.clone().unwrap_or_default();
        covariance.into_iter().step_by(d + 1).map(f64::sqrt)
    };
    let mut errors: Vec<f64> = rows.iter().flat_map(standard_errors).collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied()
}

fn fit(personalizer: &Personalizer<'_>, task: &Task<'_>) -> Result<EmbeddingRow, StudyError> {
    let score = task.adb.filter(|_| task.use_adb);
    let fitted = personalizer.fit(task.drive, score)?;
    let axis = LinearHead::aggression(personalizer.model()).ok();
    let meta = task.drive.meta();
    Ok(EmbeddingRow {
        drive: meta.drive.clone(),
        participant: meta.participant.clone(),
        condition: meta.condition,
        session: meta.session,
        trial: meta.trial,
        adb_used: fitted.used_adb,
        adb: task.adb.map(StyleScore::points),
        adb_hat: fitted.aggression_hat,
        line_position: axis.as_ref().map(|a| a.position(&fitted.embedding)).transpose()?,
        readings: Some(fitted.readings),
        line_position_se: axis.and_then(|a| fitted.sd_along(a.gradient())),
        support_p: fitted.support.as_ref().and_then(|s| s.p),
        beyond_why: fitted.support.as_ref().and_then(Support::beyond),
        posted_unseen: Some(fitted.posted_unseen),
        covariance: fitted.covariance,
        embedding: fitted.embedding,
    })
}
