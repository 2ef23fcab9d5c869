//! `stats paper`: every analysis of the paper over the results of a run (method section 9).

pub use maveric_analysis::Family;

use crate::{
    atomic_write::write_json,
    design::{DesignFile, People},
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
    /// The study's design; `study.toml` of the folder one stands in without, else the paper's.
    pub design: Option<PathBuf>,
    /// Who took part; `participants.csv` among the results without, else the design's table.
    pub participants: Option<PathBuf>,
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
/// [`StudyError`] if a table is missing, or holds fewer than three people who are tested.
///
/// # Source
/// Method section 9.
pub fn analyse(
    options: &AnalyseOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Analysis>, StudyError> {
    let study = DesignFile::find(options.design.as_deref())?;
    let people = study.people_of(&options.results, options.participants.as_deref())?;
    let data = read_study(&options.results, &people)?;
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

/// Reads the tables that a pipeline left in a folder; `people` are those of the study.
///
/// # Errors
/// [`StudyError`] if one cannot be read, or there are too few people.
pub(crate) fn read_study(folder: &Path, people: &People) -> Result<StudyData, StudyError> {
    Ok(StudyData::new(Tables {
        learned_from: people.learned_from(),
        tested: people.tested(),
        measurements: read_measurements(&folder.join("measurements.parquet"))?,
        embeddings: read_embeddings(&folder.join("embeddings.csv"))?,
        conditions: read_conditions(&folder.join("conditions.csv"))?,
        pre: read_scores(&folder.join("scores.csv"))?,
        post: read_scores(&folder.join("rating_scores.csv"))?,
    })?)
}
