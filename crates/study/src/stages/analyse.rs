//! `stats study`: every analysis that a study's design asks for, over the results of a run (method section 9).

use crate::{
    atomic_write::write_json,
    design::DesignFile,
    error::StudyError,
    once::{count, names, together},
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    run_folder::read_study,
};
use maveric_analysis::{Analysis, Friedman};
use path_slash::PathExt as _;
use std::path::PathBuf;

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
}

/// Runs every analysis that the design asks for and writes the results.
///
/// # Errors
/// [`StudyError`] if a table is missing, holds fewer than three people who are tested, or lacks a condition of the design.
///
/// # Source
/// Method section 9.
pub fn analyse(
    options: &AnalyseOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Analysis>, StudyError> {
    let named = options
        .design
        .as_deref()
        .into_iter()
        .chain(options.participants.as_deref());
    spare_inputs(named, [&*options.out])?;
    let study = DesignFile::find(options.design.as_deref())?;
    let data = read_study(&options.results, &study, options.participants.as_deref())?;
    watch.step(0, 1, "analyses")?;
    let analysis = maveric_analysis::analyse(&data, Friedman::Exact)?;
    watch.step(1, 1, "analyses")?;
    write_json(&options.out, &analysis)?;
    let flow = &analysis.flow;
    let mut warnings: Vec<String> = flow
        .left_out
        .iter()
        .chain(&flow.drives)
        .map(|l| format!("left out, {}: {}", l.why, l.who.join(", ")))
        .collect();
    warnings.extend(analysis.notes.iter().cloned());
    let lacking = analysis.exclusions.iter();
    let lacking = lacking.map(|e| (e.who.clone(), format!("left out of {}: {}", e.what, e.why)));
    let lacking = together(lacking).into_iter();
    warnings.extend(lacking.map(|(who, what)| format!("{}: {what}", names(&who))));
    let summary = vec![format!(
        "{} of {} analysed: {}",
        flow.analysed,
        count(flow.recruited, "participant", "participants"),
        options.out.to_slash_lossy()
    )];
    Ok(Outcome {
        value: analysis,
        summary,
        warnings,
    })
}
