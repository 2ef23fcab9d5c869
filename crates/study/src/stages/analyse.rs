//! `stats paper`: every analysis of the paper over the results of a run (method section 9).

pub use maveric_analysis::Family;

use crate::{
    atomic_write::write_json,
    error::StudyError,
    outcome::{Outcome, Watch},
    tables::{
        conditions::read_conditions, embeddings::read_embeddings, measurements::read_measurements,
        surveys::read_scores,
    },
};
use maveric_analysis::{Analysis, Friedman, StudyData, Tables};
use std::path::{Path, PathBuf};

/// What to analyse.
#[derive(Debug, Clone)]
pub struct AnalyseOptions {
    /// Folder of results, as the pipeline leaves it.
    pub results: PathBuf,
    /// Analysis to write (JSON).
    pub out: PathBuf,
    /// The factors of the homophily tests.
    pub family: Family,
}

/// Runs every analysis of the paper and writes the results.
///
/// # Errors
/// [`StudyError`] if a table is missing, or holds fewer than three participants of Study 2.
///
/// # Source
/// Method section 9.
pub fn analyse(
    options: &AnalyseOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Analysis>, StudyError> {
    let data = read_study(&options.results)?;
    watch.step(0, 1, "analyses")?;
    let analysis = maveric_analysis::analyse(&data, &options.family, Friedman::Exact)?;
    watch.step(1, 1, "analyses")?;
    write_json(&options.out, &analysis)?;
    let warnings = analysis
        .exclusions
        .iter()
        .map(|e| format!("{}: left out of {}: {}", e.who, e.what, e.why))
        .collect();
    let summary = vec![format!(
        "{} participants analysed: {}",
        analysis.participants,
        options.out.display()
    )];
    Ok(Outcome {
        value: analysis,
        summary,
        warnings,
    })
}

/// Reads the tables that a pipeline left in a folder.
///
/// # Errors
/// [`StudyError`] if one cannot be read, or there are too few people.
pub(crate) fn read_study(folder: &Path) -> Result<StudyData, StudyError> {
    Ok(StudyData::new(Tables {
        measurements: read_measurements(&folder.join("measurements.parquet"))?,
        embeddings: read_embeddings(&folder.join("embeddings.csv"))?,
        conditions: read_conditions(&folder.join("conditions.csv"))?,
        pre: read_scores(&folder.join("scores.csv"))?,
        post: read_scores(&folder.join("rating_scores.csv"))?,
    })?)
}
