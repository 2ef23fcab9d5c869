//! `stats study`: every analysis that a study's design asks for, over the results of a run (method section 9).

use crate::{
    atomic_write::write_json,
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    stages::score::read_scales,
    tables::{
        Table,
        conditions::read_conditions,
        drives::kept_out,
        embeddings::read_embeddings,
        measurements::{one_drive_a_condition, read_measurements},
        surveys::read_answers,
        surveys::read_scores,
    },
};
use maveric_analysis::{Analysis, Driven, Friedman, Person, StudyData, Tables};
use maveric_domain::{Answer, DriveId, design::Software};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

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
    warnings.extend(
        analysis
            .exclusions
            .iter()
            .map(|e| format!("{}: left out of {}: {}", e.who, e.what, e.why)),
    );
    let summary = vec![format!(
        "{} of {} participants analysed: {}",
        flow.analysed,
        flow.recruited,
        options.out.display()
    )];
    Ok(Outcome {
        value: analysis,
        summary,
        warnings,
    })
}

/// Reads the tables that a pipeline left in a folder; `participants` as in [`AnalyseOptions`].
///
/// # Errors
/// [`StudyError`] if one cannot be read, or as [`StudyData::new`].
pub(crate) fn read_study(
    folder: &Path,
    study: &DesignFile,
    participants: Option<&Path>,
) -> Result<StudyData, StudyError> {
    let people = study.people_of(folder, participants)?.enrolled;
    let design = &study.design;
    let steered = design.conditions().iter().any(|c| c.car.is_some());
    let embedded = design.style().is_some() || design.needs_a_model();
    let in_folder = |name: &str| folder.join(name);
    // What no stage of this design makes need not be there; what one makes has to be.
    let made = |name: &str, is_made: bool| is_made || in_folder(name).is_file();
    let measurements = in_folder("measurements.parquet");
    let measured = read_measurements(&measurements)?;
    let of_design = measured.iter().filter(|d| design.knows(d.meta.condition));
    one_drive_a_condition(&measurements, of_design)?;
    let tables = Tables {
        people: people
            .into_iter()
            .map(|p| Person {
                id: p.id,
                learned: p.learned_from,
                tested: p.tested,
                columns: p.cells,
            })
            .collect(),
        measurements: measured,
        embeddings: if made("embeddings.csv", embedded) {
            read_embeddings(&in_folder("embeddings.csv"))?
        } else {
            Vec::new()
        },
        conditions: if made("conditions.csv", steered) {
            read_conditions(&in_folder("conditions.csv"))?
        } else {
            Vec::new()
        },
        pre: if made("scores.csv", design.style().is_some()) {
            read_scores(&in_folder("scores.csv"))?
        } else {
            Vec::new()
        },
        post: if made("rating_scores.csv", false) {
            read_scores(&in_folder("rating_scores.csv"))?
        } else {
            Vec::new()
        },
        scales: read_scales(&study.resolve(&design.files().scales))?,
        answers: answers(folder, study)?,
        durations_s: durations(folder)?,
        kept_out: drives_kept_out(folder)?,
    };
    Ok(StudyData::new(design, tables)?)
}

/// Answers by which the design's rules judge sheets: those among the results, and the design's own table of them.
fn answers(folder: &Path, study: &DesignFile) -> Result<Vec<Answer>, StudyError> {
    let mut found = Vec::new();
    if !study.design.exclude().straight_lined {
        return Ok(found);
    }
    let files = study.design.files();
    let own = study.resolve(&files.answers);
    if files.software == Software::Table && own.is_file() {
        found.extend(read_answers(&own)?);
    }
    for name in ["surveys.csv", "answers.csv", "ratings.csv"] {
        let path = folder.join(name);
        if path.is_file() {
            found.extend(read_answers(&path)?);
        }
    }
    Ok(found)
}

/// What the design keeps out, from beside every list of drives among the results.
fn drives_kept_out(folder: &Path) -> Result<Vec<Driven>, StudyError> {
    let mut found = Vec::new();
    for list in lists(folder) {
        let drives = kept_out(list.parent().unwrap_or(folder))?;
        found.extend(drives.into_iter().map(|(_, driven)| driven));
    }
    Ok(found)
}

/// How long each drive took, from the lists of drives among the results.
pub(crate) fn durations(folder: &Path) -> Result<BTreeMap<DriveId, f64>, StudyError> {
    let mut found = BTreeMap::new();
    for path in lists(folder) {
        let table = Table::read(&path)?;
        let drives: Vec<DriveId> = table.ids("drive")?;
        found.extend(drives.into_iter().zip(table.all_numbers("duration_s")?));
    }
    Ok(found)
}

/// Every list of drives among the results, in order.
pub(crate) fn lists(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.join("drives"), folder.join("av")];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        for path in entries.map(|e| e.path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().is_some_and(|n| n == "drives.csv") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
