//! The models that learned from somebody.

use crate::{
    atomic_write::if_there, deciding::hash_of_file, design::DesignFile, error::StudyError,
    run_folder::embeddings_path, tables::embeddings::read_embeddings,
};
use maveric_domain::ParticipantId;
use std::{collections::BTreeSet, path::Path};

/// From whom a model learned, as the table of training embeddings beside it says; nobody where there is none.
pub fn learned_from(model: &Path) -> Result<BTreeSet<ParticipantId>, StudyError> {
    let rows = if_there(&embeddings_path(model), read_embeddings)?;
    Ok(rows.into_iter().map(|row| row.participant).collect())
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
    let refused = |who: &ParticipantId, why: &str| {
        StudyError::file(model, format!("learned from {who}, {why}")).with_help(format!(
            "train it anew: `maveric run train` in the folder of {}",
            study.name()
        ))
    };
    if let Some(who) = forgotten.learned(&hash_of_file(model)?) {
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
