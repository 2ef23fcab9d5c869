//! Forgetting somebody: all that they gave goes, here and in the study's folder.

use crate::{error::SeatError, files::Files, seat::Seat, store::Store, words::in_english};
use maveric_domain::nearest;
use maveric_study::{DesignFile, forget};
use serde::Serialize;
use std::{collections::BTreeSet, path::Path};

/// What became of somebody who is forgotten.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Forgotten {
    /// Their id, which nobody is given again.
    pub participant: String,
    /// Whether they had taken part in the seat.
    pub in_seat: bool,
    /// What went from the study's folder; none where there is no study.
    pub study: Option<forget::Forgotten>,
    /// What cannot be called back.
    pub lasting: &'static str,
}

/// Forgets somebody of the study in a folder whose seat is closed; what the seat has is looked for in `state`.
///
/// # Errors
/// [`SeatError::Nobody`] for an id that neither the seat nor the study's table of people knows; [`SeatError::InUse`] while the seat is
/// open; [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be changed. Calling again ends what was begun.
pub fn forget(study: &DesignFile, state: &Path, participant: &str) -> Result<Forgotten, SeatError> {
    let records = state.parent().unwrap_or(state).to_owned();
    let files = Files::of(study, records);
    let store = state.is_file().then(|| Store::open(state)).transpose()?;
    let in_seat = match &store {
        Some(store) => take_out(store, &files, participant)?.is_some(),
        None => known(&[], &files, participant).map(|()| false)?,
    };
    let mut study = files.forget(participant)?;
    if let (Some(study), Some(store)) = (&mut study, store) {
        study.left.retain(|path| !store.has(path));
        store.sweep()?;
    }
    Ok(Forgotten {
        participant: participant.to_owned(),
        in_seat,
        study,
        lasting: in_english("lasting"),
    })
}

/// Refuses an id that nobody has or had.
fn known(in_store: &[String], files: &Files, participant: &str) -> Result<(), SeatError> {
    let elsewhere = files.people()?;
    let ids = || in_store.iter().chain(&elsewhere).map(String::as_str);
    if ids().any(|id| id == participant) {
        return Ok(());
    }
    Err(SeatError::Nobody {
        participant: participant.to_owned(),
        nearest: nearest(participant, ids()).map(str::to_owned),
    })
}

/// The ids of everybody who is or was in the seat's file.
fn ids_in(store: &Store) -> Result<Vec<String>, SeatError> {
    store.look(|b| {
        let people = b.ids()?.into_iter();
        Ok(people.chain(b.forgotten()?).collect())
    })
}

/// Takes somebody's rows out of the seat's file; their token, if they had one.
fn take_out(store: &Store, files: &Files, participant: &str) -> Result<Option<String>, SeatError> {
    known(&ids_in(store)?, files, participant)?;
    let (token, lent) =
        store.within(|b| Ok::<_, SeatError>((b.forget(participant)?, b.lent()?)))?;
    files.lent(&lent)?;
    Ok(token)
}

impl Seat {
    /// Refuses an id that nobody has or had.
    ///
    /// # Errors
    /// [`SeatError::Nobody`] with the nearest id.
    pub(crate) fn knows(&self, participant: &str) -> Result<(), SeatError> {
        known(&ids_in(&self.store)?, &self.settings.files, participant)
    }

    /// Takes away all that is kept of somebody but their id: rows, drives, logs, answers, style, events; then the bytes that they leave
    /// in the seat's file.
    ///
    /// # Errors
    /// As [`forget()`]. What was begun is ended when the seat is opened again.
    pub fn forget(&self, participant: &str) -> Result<Forgotten, SeatError> {
        let token = take_out(&self.store, &self.settings.files, participant)?;
        if let Some(token) = &token {
            self.forget_link(token);
        }
        let mut study = self.without_writing(|files| files.forget(participant))?;
        if let Some(study) = &mut study {
            study.left.retain(|path| !self.store.has(path));
            if !study.models.is_empty() {
                self.refuse_model();
            }
        }
        self.store.sweep()?;
        Ok(Forgotten {
            participant: participant.to_owned(),
            in_seat: token.is_some(),
            study,
            lasting: in_english("lasting"),
        })
    }

    /// Ends what was begun to be forgotten and was stopped on the way.
    pub(crate) fn forget_the_rest(&self) -> Result<(), SeatError> {
        let rest = self.store.look(|b| b.not_swept().map(BTreeSet::from_iter))?;
        for participant in &rest {
            self.without_writing(|files| files.forget(participant))?;
        }
        if rest.is_empty() {
            return Ok(());
        }
        self.store.sweep()
    }
}
