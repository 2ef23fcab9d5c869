//! The files that a report is made from: hashed, and those that hold parameters shown whole.

use super::DrawReport;
use crate::{
    atomic_write::read_text, deciding::hash_of_file, design::DesignFile, error::StudyError,
    run_folder::MODEL_FILE, stage::Files,
};
use maveric_report::html::{Input, ParameterFile};
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// What the page of a study is made from, beside the drives.
pub(super) const READ: [&str; 12] = [
    "analysis.json",
    "model_training.json",
    "model_embeddings.csv",
    "embeddings.csv",
    "conditions.csv",
    "measurements.parquet",
    "scores.csv",
    "scores_reliabilities.csv",
    "scores_exclusions.csv",
    "rating_scores_item_means.csv",
    "rating_scores_reliabilities.csv",
    "rating_scores_exclusions.csv",
];

/// The largest file of parameters that is shown whole, in bytes.
const MOST_BYTES: u64 = 100_000;

/// The files among `paths` that exist, in this order, each with the BLAKE3 hash of its content: what the ledger of a
/// pipeline writes beside a file.
pub(crate) fn hashed(paths: impl IntoIterator<Item = PathBuf>) -> Result<Vec<Input>, StudyError> {
    let mut inputs = Vec::new();
    for path in paths.into_iter().filter(|p| p.is_file()) {
        inputs.push(Input { path: path.to_slash_lossy().into_owned(), hash: hash_of_file(&path)? });
    }
    Ok(inputs)
}

/// The files among the parameters' values.
pub(super) fn parameter_files(parameters: &[(String, String)]) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        parameters.iter().map(|(_, value)| PathBuf::from(value)).collect();
    files.retain(|p| p.is_file());
    files.dedup();
    files
}

/// Those of them that are TOML, whole.
pub(super) fn shown_whole(files: &[PathBuf]) -> Result<Vec<ParameterFile>, StudyError> {
    let short = |path: &&PathBuf| {
        let size = std::fs::metadata(path).map_or(0, |m| m.len());
        path.extension().is_some_and(|e| e == "toml") && size <= MOST_BYTES
    };
    let whole = |path: &PathBuf| {
        Ok(ParameterFile { path: path.to_slash_lossy().into_owned(), text: read_text(path)? })
    };
    files.iter().filter(short).map(whole).collect()
}

/// What a page of these results may be drawn from.
pub(super) fn drawn_from(options: &DrawReport, root: &Path) -> Result<Files, StudyError> {
    let folder = &options.results;
    let others = [
        "following.json",
        "answers_exclusions.csv",
        "answers.csv",
        "surveys.csv",
        "ratings.csv",
        "participants.csv",
        "drives",
        "av",
        "logs",
    ];
    let is_file = |path: &PathBuf| root.join(path).is_file();
    let values = options.parameters.iter().map(|(_, value)| value.into());
    let study = DesignFile::below_or_paper(root, options.design.as_deref())?;
    let files = study.design.files();
    let measures = study.design.measures().first();
    let measures = measures.map(|_| study.resolve(&files.measures));
    let claims = files.claims.as_ref().filter(|_| options.claims.is_none());
    Ok(Files::default()
        .reads_design(options.design.as_deref())
        .reads(&options.participants)
        .reads(&options.claims)
        .reads(claims.map(|path| study.resolve(path)))
        .reads_if_there(in_folder(folder, &READ))
        .reads_if_there(in_folder(folder, &others))
        .reads_if_there([folder.join(MODEL_FILE), study.resolve(&files.scales)])
        .reads_if_there(measures)
        .reads_if_there(
            study.path.iter().flat_map(|_| [&files.logs, &files.answers].map(|p| study.resolve(p))),
        )
        .reads_if_there(values.filter(is_file)))
}

/// `folder` with each of these names.
pub(super) fn in_folder(folder: &Path, names: &[&str]) -> Vec<PathBuf> {
    names.iter().map(|name| folder.join(name)).collect()
}
