//! The people whom networks learn from: their driving parameters and the posted speeds.

use super::{
    fit::{DriveEvents, fit},
    fitted::FittedHead,
    list::{HEADS, events_of},
    support::Population,
};
use crate::{
    epochs::TrainingDrive,
    error::ModelError,
    params::TrainSettings,
    posted::{FreeSpeed, Posted},
};
use maveric_domain::Drive;
use std::collections::BTreeSet;

/// Length of the first share of a drive's rows, in s.
pub(crate) fn length_s(drive: &Drive, fraction: f64) -> f64 {
    let time = &drive.rows().time_s;
    let whole = time[time.len() - 1] - time[0] + 1.0 / drive.rate_hz();
    fraction * whole
}

/// Those whom networks learn from.
#[derive(Debug, Clone)]
pub(crate) struct LearnedFrom {
    /// Linear heads for their habits.
    pub(crate) habits: Vec<FittedHead>,
    /// How their habits differ.
    pub(crate) population: Population,
    /// What was posted where they drove.
    pub(crate) posted: Posted,
}

/// Those whom networks learn from; the networks read speeds in m/s.
///
/// # Errors
/// [`ModelError::NoDrives`] without a drive.
pub(crate) fn learned_from(
    given: &[TrainingDrive<'_>],
    settings: &TrainSettings,
) -> Result<LearnedFrom, ModelError> {
    let posted = posted(given, FreeSpeed::Absolute)?;
    let shown = |t: &TrainingDrive<'_>| {
        let events = events_of(t.drive, length_s(t.drive, settings.fit_fraction), None);
        let owner = t.drive.meta().participant.as_str();
        let shows = events.iter().any(|e| !e.is_empty());
        shows.then(|| (owner.to_owned(), events))
    };
    let (owners, events): (Vec<String>, Vec<DriveEvents>) = given.iter().filter_map(shown).unzip();
    let fitted = fit(&HEADS.map(|h| h.shape()), &events, settings.embedding_size);
    let people = owners.iter().collect::<BTreeSet<_>>().len();
    Ok(LearnedFrom {
        population: Population::learn(&fitted.heads, &events, people),
        habits: fitted.heads,
        posted,
    })
}

pub(super) fn posted(
    given: &[TrainingDrive<'_>],
    free_speed: FreeSpeed,
) -> Result<Posted, ModelError> {
    let no_drives = ModelError::NoDrives { given: given.len(), excluded: 0 };
    Posted::learn(given.iter().map(|t| t.drive), free_speed).ok_or(no_drives)
}
