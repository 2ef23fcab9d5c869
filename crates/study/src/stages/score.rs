//! `score`: questionnaire answers to scores and reliabilities.

use crate::{
    atomic_write::read_text,
    error::StudyError,
    outcome::{Outcome, Watch},
    tables::{
        Table, TableBuilder,
        surveys::{read_answers, write_scores},
    },
};
use maveric_domain::{Answer, Moment, ParticipantId, Scale};
use maveric_measures::{ItemMatrix, ScoreWarning, parse_scale};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What to score.
#[derive(Debug, Clone)]
pub struct ScoreOptions {
    /// Files of answers.
    pub surveys: Vec<PathBuf>,
    /// Who should have answered: whoever of them did not is listed, and strangers are left out.
    pub participants: Option<PathBuf>,
    /// Folder of questionnaire definitions.
    pub scales: PathBuf,
    /// Scores to write.
    pub out: PathBuf,
}

/// Reliability of one subscale.
#[derive(Debug, Clone, Serialize)]
pub struct Reliability {
    /// Code name of the scale.
    pub scale: String,
    /// Code name of the subscale.
    pub subscale: String,
    /// Items.
    pub items: usize,
    /// Respondents without a missing item.
    pub n: usize,
    /// Respondents left out for a missing item.
    pub dropped: usize,
    /// Cronbach's alpha; `None` where it does not exist.
    pub alpha: Option<f64>,
    /// Lower end of its 95 % interval (Feldt).
    pub ci_low: Option<f64>,
    /// Upper end.
    pub ci_high: Option<f64>,
}

/// What was scored.
#[derive(Debug, Clone, Serialize)]
pub struct ScoredSurveys {
    /// Number of scores.
    pub scores: usize,
    /// Scores that are missing.
    pub missing: usize,
    /// Reliability of each subscale.
    pub reliabilities: Vec<Reliability>,
}

/// Reads every scale definition of a folder, ordered by file name.
///
/// # Errors
/// [`StudyError`] if there is none, or naming the file that does not define a scale.
pub fn read_scales(folder: &Path) -> Result<Vec<Scale>, StudyError> {
    let entries = std::fs::read_dir(folder).map_err(StudyError::read(folder))?;
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry.map_err(StudyError::read(folder))?.path();
        if path.extension().is_some_and(|e| e == "toml") {
            paths.push(path);
        }
    }
    paths.sort();
    if paths.is_empty() {
        return Err(StudyError::file(
            folder,
            "holds no questionnaire definitions (*.toml)",
        ));
    }
    let read = |path: &PathBuf| {
        parse_scale(&read_text(path)?).map_err(|e| StudyError::file(path, e.to_string()))
    };
    paths.iter().map(read).collect()
}

/// The file beside `out` that holds the reliabilities.
pub fn reliabilities_path(out: &Path) -> PathBuf {
    beside(out, "_reliabilities.csv")
}

/// The file beside `out` that lists what was left out: who, what, why.
pub fn exclusions_path(out: &Path) -> PathBuf {
    beside(out, "_exclusions.csv")
}

fn beside(out: &Path, suffix: &str) -> PathBuf {
    let stem = out.file_stem().unwrap_or_default().to_string_lossy();
    out.with_file_name(format!("{stem}{suffix}"))
}

/// Whom a warning is about.
fn who(warning: &ScoreWarning) -> String {
    match warning {
        ScoreWarning::NoAnswers { participant }
        | ScoreWarning::Unanswered { participant, .. }
        | ScoreWarning::TooFewAnswers { participant, .. }
        | ScoreWarning::UnknownParticipant { participant, .. } => participant.to_string(),
        _ => String::new(),
    }
}

/// Alpha over one sheet a person: those from before the drives where there are any. After the conditions a person
/// answers once a condition, and all sheets count, as the paper's scales were used.
fn reliability(matrix: &ItemMatrix) -> Reliability {
    let names: Vec<String> = matrix
        .items
        .iter()
        .map(|item| format!("item {item}"))
        .collect();
    let before = matrix
        .respondents
        .iter()
        .any(|(_, moment)| *moment == Moment::Pre);
    let asked = |moment: Moment| !before || moment == Moment::Pre;
    let sheets: Vec<&Vec<Option<f64>>> = matrix
        .respondents
        .iter()
        .zip(&matrix.answers)
        .filter(|((_, m), _)| asked(*m))
        .map(|(_, row)| row)
        .collect();
    let columns: Vec<Vec<Option<f64>>> = (0..names.len())
        .map(|i| sheets.iter().map(|row| row[i]).collect())
        .collect();
    let items: Vec<(&str, &[Option<f64>])> = names
        .iter()
        .zip(&columns)
        .map(|(name, column)| (name.as_str(), column.as_slice()))
        .collect();
    let found = maveric_stats::alpha(&items).ok();
    let alpha = found.as_ref().map(|a| &a.alpha);
    Reliability {
        scale: matrix.scale.clone(),
        subscale: matrix.subscale.clone(),
        items: matrix.items.len(),
        n: found.as_ref().map_or(0, |a| a.n),
        dropped: found.as_ref().map_or(sheets.len(), |a| a.missing),
        alpha: alpha.and_then(|a| a.raw),
        ci_low: alpha.and_then(|a| a.ci_low),
        ci_high: alpha.and_then(|a| a.ci_high),
    }
}

/// Scores answers by the scales of a folder and writes scores and reliabilities.
///
/// # Errors
/// [`StudyError`] naming file and row, or participant, scale and item.
pub fn score(
    options: &ScoreOptions,
    watch: Watch<'_>,
) -> Result<Outcome<ScoredSurveys>, StudyError> {
    let scales = read_scales(&options.scales)?;
    let mut answers: Vec<Answer> = Vec::new();
    for path in &options.surveys {
        answers.extend(read_answers(path)?);
    }
    watch.check()?;
    if answers.is_empty() {
        return Err(StudyError::NotPossible {
            problem: "the surveys hold no answers".to_owned(),
            help: None,
        });
    }
    let participants: Option<Vec<ParticipantId>> = options
        .participants
        .as_deref()
        .map(|path| Table::read(path)?.ids("participant"))
        .transpose()?;
    let scored = maveric_measures::score(&scales, &answers, participants.as_deref())?;
    let reliabilities: Vec<Reliability> = scored.matrices.iter().map(reliability).collect();
    write_scores(&options.out, &scored.scores)?;
    TableBuilder::default()
        .text("scale", reliabilities.iter().map(|r| r.scale.as_str()))
        .text(
            "subscale",
            reliabilities.iter().map(|r| r.subscale.as_str()),
        )
        .integers(
            "items",
            reliabilities.iter().map(|r| i64::try_from(r.items).ok()),
        )
        .integers("n", reliabilities.iter().map(|r| i64::try_from(r.n).ok()))
        .integers(
            "dropped",
            reliabilities.iter().map(|r| i64::try_from(r.dropped).ok()),
        )
        .numbers("alpha", reliabilities.iter().map(|r| r.alpha))
        .numbers("ci_low", reliabilities.iter().map(|r| r.ci_low))
        .numbers("ci_high", reliabilities.iter().map(|r| r.ci_high))
        .write(&reliabilities_path(&options.out))?;
    TableBuilder::default()
        .text("who", scored.warnings.iter().map(who))
        .text("what", scored.warnings.iter().map(|_| "questionnaires"))
        .text("why", scored.warnings.iter().map(ToString::to_string))
        .write(&exclusions_path(&options.out))?;
    let missing = scored.scores.iter().filter(|s| s.value.is_none()).count();
    let summary = vec![format!(
        "{} scores ({missing} missing): {}",
        scored.scores.len(),
        options.out.display()
    )];
    let warnings = scored.warnings.iter().map(ToString::to_string).collect();
    Ok(Outcome {
        value: ScoredSurveys {
            scores: scored.scores.len(),
            missing,
            reliabilities,
        },
        summary,
        warnings,
    })
}
