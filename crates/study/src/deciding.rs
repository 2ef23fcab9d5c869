//! Every file of a study that decides a number, and its hash: what a frozen design vouches for.

use crate::{design::DesignFile, error::StudyError};
use maveric_domain::design::{Car, Mappings};
use path_slash::PathExt as _;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

/// A pipeline that the study's own takes the place of.
const PIPELINE: &str = "pipelines/study.toml";

/// The BLAKE3 of every file beside the design that decides a number, by its path from the study's folder: questionnaires, mappings,
/// scenario, columns, claims, effects, a model and styles from elsewhere, the study's own pipeline. Of a folder each file below it. A file that is
/// not there decides nothing.
pub(crate) fn deciding_files(study: &DesignFile) -> Result<BTreeMap<String, String>, StudyError> {
    let (design, files) = (&study.design, study.design.files());
    let mut paths: Vec<PathBuf> = vec![files.scales.clone(), PIPELINE.into()];
    match &files.mapping {
        Mappings::One(file) => paths.push(file.clone()),
        Mappings::Rigs(rigs) => paths.extend(rigs.iter().filter_map(|rig| rig.file.clone())),
    }
    paths.push(files.scenario.clone());
    let named = [&files.columns, &files.claims, &files.effects];
    paths.extend(named.into_iter().flatten().cloned());
    paths.extend(design.model().map(|model| model.file.clone()));
    paths.extend(design.conditions().iter().filter_map(|c| match &c.car {
        Some(Car::Embedding(file)) => Some(file.clone()),
        _ => None,
    }));
    let mut hashes = BTreeMap::new();
    for path in paths {
        add(study, &path, &mut hashes)?;
    }
    Ok(hashes)
}

fn add(
    study: &DesignFile,
    path: &Path,
    hashes: &mut BTreeMap<String, String>,
) -> Result<(), StudyError> {
    let full = study.resolve(path);
    if full.is_dir() {
        for entry in fs::read_dir(&full).map_err(StudyError::read(&full))? {
            let name = entry.map_err(StudyError::read(&full))?.file_name();
            add(study, &path.join(name), hashes)?;
        }
    } else if full.is_file() {
        hashes.insert(path.to_slash_lossy().into_owned(), hash_of_file(&full)?);
    }
    Ok(())
}

/// BLAKE3 of a file, in hexadecimal.
pub(crate) fn hash_of_file(path: &Path) -> Result<String, StudyError> {
    let bytes = fs::read(path).map_err(StudyError::read(path))?;
    Ok(hash_of(&bytes))
}

/// BLAKE3 of bytes, in hexadecimal.
pub(crate) fn hash_of(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}
