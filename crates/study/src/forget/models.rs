//! The models that learned from somebody.

use crate::{
    design::DesignFile, error::StudyError, run_folder::embeddings_path,
    tables::embeddings::read_embeddings,
};
use maveric_domain::ParticipantId;
use std::{collections::BTreeSet, path::Path};

/// BLAKE3 of a file, in hexadecimal.
pub(super) fn hash_of(path: &Path) -> Result<String, StudyError> {
    let bytes = std::fs::read(path).map_err(StudyError::read(path))?;
    Ok(blake3::hash(&bytes).to_hex().to_string())
}

/// From whom a model learned, as the table of training embeddings beside it says; nobody where there is none.
///
/// # Errors
/// As [`read_embeddings`].
pub fn learned_from(model: &Path) -> Result<BTreeSet<ParticipantId>, StudyError> {
    let beside = embeddings_path(model);
    if !beside.is_file() {
        return Ok(BTreeSet::new());
    }
    let rows = read_embeddings(&beside)?.into_iter();
    Ok(rows.map(|row| row.participant).collect())
}

/// Refuses a model of this study that learned from somebody who was forgotten, or whom `[exclude]` leaves out. One that `[model]` names
/// was learned elsewhere and is not asked.
///
/// # Errors
/// [`StudyError::BadFile`] naming the model, the person and what to do; [`StudyError::Io`].
pub fn refuse_learned_from_gone(study: &DesignFile, model: &Path) -> Result<(), StudyError> {
    if study.design.model().is_some() || !model.is_file() {
        return Ok(());
    }
    let forgotten = study.forgotten()?;
    let excluded = study.design.exclude();
    if forgotten.ids().next().is_none() && excluded.people.is_empty() {
        return Ok(());
    }
    let refused = |who: &ParticipantId, why: &str| StudyError::BadFile {
        path: model.to_owned(),
        problem: format!("learned from {who}, {why}"),
        help: Some(format!(
            "train it anew: `maveric run train` in the folder of {}",
            study.name()
        )),
    };
    if let Some(who) = forgotten.learned(&hash_of(model)?) {
        return Err(refused(who, "who was forgotten"));
    }
    for who in learned_from(model)? {
        if forgotten.has(&who) {
            return Err(refused(&who, "who was forgotten"));
        }
        if let Some(why) = excluded.person(&who) {
            let why = format!("whom [exclude] of {} leaves out: {why}", study.name());
            return Err(refused(&who, &why));
        }
    }
    Ok(())
}
