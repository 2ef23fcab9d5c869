//! Training: all weights and one embedding per drive, together.

use crate::{
    dataset::Data,
    epochs::{Observe, TrainingDrive, tell},
    error::ModelError,
    heads::{learned_from, train_heads},
    heads_kind::HeadsKind,
    model::Model,
    params::TrainSettings,
    personalize::NetworkRows,
    quality::Quality,
    selection::select,
    trainer::Trainer,
    training_report::{NetworkReport, Trained, TrainingReport},
};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Learns heads and embeddings from `drives`, of the kind that [`TrainSettings::heads`] names.
///
/// `seed` fixes every draw; the result does not depend on the number of threads. After each epoch of networks `observe`
/// is told how it went, and may stop the training.
///
/// # Errors
/// [`ModelError::BadSetting`], [`ModelError::NoDrives`], [`ModelError::DuplicateDrive`], [`ModelError::OtherScale`], [`ModelError::Diverged`], or
/// [`ModelError::Cancelled`] where `observe` broke off. A drive that shows nothing is left out with a warning.
///
/// # Source
/// Paper, "Training"; method section 3; rates, weights, noise and rows from calibration section 3. Linear heads are ours.
pub fn train(
    drives: &[TrainingDrive<'_>],
    settings: &TrainSettings,
    seed: u64,
    observe: &mut Observe<'_>,
) -> Result<Trained, ModelError> {
    settings.check()?;
    let mut seen = BTreeSet::new();
    for drive in drives.iter().map(|d| &d.drive.meta().drive) {
        if !seen.insert(drive) {
            return Err(ModelError::DuplicateDrive { drive: drive.clone() });
        }
    }
    match settings.heads {
        HeadsKind::Linear => train_heads(drives, settings, seed),
        HeadsKind::Paper => train_networks(drives, settings, seed, observe),
    }
}

/// Trains the paper's networks, for as many epochs as are best for people kept back.
fn train_networks(
    drives: &[TrainingDrive<'_>],
    settings: &TrainSettings,
    seed: u64,
    observe: &mut Observe<'_>,
) -> Result<Trained, ModelError> {
    let learned_from = learned_from(drives, settings)?;
    let selection = select(drives, &learned_from, settings, seed, observe)?;
    let data = Data::new(drives, settings)?;
    let last = selection.as_ref().map_or(settings.epochs, |s| s.kept_epoch);
    let mut trainer = Trainer::new(&data, settings, seed, last);
    let mut epochs = Vec::with_capacity(last);
    for number in 1..=last {
        epochs.push(trainer.epoch(number)?);
        tell(observe, &epochs[number - 1])?;
    }
    let model = trainer.model(&learned_from)?;
    let quality = quality(&model, &data)?;
    let trained = model.training().iter();
    let embeddings = trained.map(|t| (t.drive.clone(), t.embedding.clone()));
    let left_out = data.left_out.iter();
    let left_out = left_out.map(|(loss, why)| format!("{loss}: {why}"));
    Ok(Trained {
        embeddings: embeddings.collect(),
        report: TrainingReport {
            drives: data.drives.len(),
            drives_with_adb: data.adb.iter().flatten().count(),
            heads: Vec::new(),
            style: None,
            networks: Some(NetworkReport {
                epochs,
                selection,
                quality,
                rows: data.rows.len(),
                following_rows: data.count(|r| r.following_distance_m.is_some()),
                lane_change_rows: data.count(|r| r.lane_change == Some(true)),
                left_out: left_out.collect(),
            }),
            warnings: data.warnings,
        },
        model,
    })
}

/// The predictions of networks for the rows that they learned from, each by its drive's embedding.
fn quality(model: &Model, data: &Data) -> Result<Quality, ModelError> {
    let paper = model.paper()?;
    let each = model.training().par_iter().zip(&data.rows_of_each);
    let predictions =
        each.map(|(t, rows)| NetworkRows::new(paper, rows, None).say(t.embedding.coordinates()).1);
    let predictions: Vec<Vec<_>> = predictions.collect();
    let predictions: Vec<_> =
        predictions.into_iter().flatten().zip(data.rows_of_each.iter().flatten()).collect();
    Ok(Quality::from_predictions(&predictions, &data.row_weights))
}

#[cfg(test)]
pub(crate) mod tests;
