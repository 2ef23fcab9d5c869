//! What is learned from, and how a pass over it went.

use crate::{
    error::{ModelError, ModelWarning},
    losses::LossTerms,
};
use maveric_domain::{Drive, ParticipantId, StyleScore, stream_seed};
use rand::{SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeSet, ops::ControlFlow};

/// A drive to learn from, and its driver's score where there is one.
#[derive(Debug, Clone, Copy)]
pub struct TrainingDrive<'a> {
    /// The recording that style is learned from.
    pub drive: &'a Drive,
    /// The score; L4 is taken over the drives that have one.
    pub adb: Option<StyleScore>,
}

impl<'a> From<&'a (Drive, StyleScore)> for TrainingDrive<'a> {
    fn from((drive, adb): &'a (Drive, StyleScore)) -> Self {
        Self { drive, adb: Some(*adb) }
    }
}

/// Refuses drives of which none can be used, and warns where one person drove all that can.
pub(crate) fn check_drivers(
    used: &[&TrainingDrive<'_>],
    given: usize,
    warnings: &mut Vec<ModelWarning>,
) -> Result<(), ModelError> {
    let mut participants = used.iter().map(|d| &d.drive.meta().participant);
    let Some(participant) = participants.next() else {
        return Err(ModelError::NoDrives { given, excluded: warnings.len() });
    };
    if participants.all(|p| p == participant) {
        warnings.push(ModelWarning::OneDriver { participant: participant.clone() });
    }
    Ok(())
}

/// The drivers of some drives, in an order that the seed and the stream decide.
pub(crate) fn shuffled_drivers<'a>(
    drives: &[TrainingDrive<'a>],
    seed: u64,
    stream: &[&str],
) -> Vec<&'a ParticipantId> {
    let drivers = drives.iter().map(|d| &d.drive.meta().participant);
    let drivers: BTreeSet<&ParticipantId> = drivers.collect();
    let mut drivers: Vec<&ParticipantId> = drivers.into_iter().collect();
    drivers.shuffle(&mut Pcg64Mcg::seed_from_u64(stream_seed(seed, stream)));
    drivers
}

/// One pass over the rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EpochReport {
    /// Which, from 1.
    pub epoch: usize,
    /// Of how many.
    pub epochs: usize,
    /// Rows learned from.
    pub rows: usize,
    /// The losses while it ran, means over its batches.
    pub losses: LossTerms,
    /// Their weighted sum.
    pub total: f64,
    /// The losses on people kept back, at its end, L4 left out; only in the run that keeps some back.
    pub validation: Option<LossTerms>,
    /// Their weighted sum.
    pub validation_total: Option<f64>,
}

/// Is told how an epoch went, and may stop the training.
pub(crate) type Observe<'o> = dyn FnMut(&EpochReport) -> ControlFlow<()> + 'o;

/// Tells how an epoch went.
pub(crate) fn tell(observe: &mut Observe<'_>, report: &EpochReport) -> Result<(), ModelError> {
    if observe(report).is_break() {
        return Err(ModelError::Cancelled { epoch: report.epoch });
    }
    Ok(())
}
