//! Training: all weights and one embedding per drive, together.

use crate::{
    dataset::Data,
    error::{ModelError, ModelWarning},
    heads::{HeadReport, StyleHead, train_heads},
    losses::{Loss, LossTerms},
    model::{Heads, HeadsKind, Model, ModelParts, TrainingEmbedding},
    paper::PaperNetworks,
    params::TrainSettings,
    personalize::NetworkRows,
    quality::Quality,
    selection::{Selection, select},
    trainer::Trainer,
    whitening::Whitening,
};
use maveric_domain::{AdbScore, Drive, DriveId, Embedding};
use nalgebra::DVector;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeSet, ops::ControlFlow};

/// A drive to learn from, and its driver's ADB score where there is one.
#[derive(Debug, Clone, Copy)]
pub struct TrainingDrive<'a> {
    /// The drive.
    pub drive: &'a Drive,
    /// The score; L4 is taken over the drives that have one.
    pub adb: Option<AdbScore>,
}

/// What training makes.
#[derive(Debug, Clone, PartialEq)]
pub struct Trained {
    /// The model.
    pub model: Model,
    /// The training drives' embeddings, in the order the drives were given, those left out left out.
    pub embeddings: Vec<(DriveId, Embedding)>,
    /// How it went.
    pub report: TrainingReport,
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
    #[serde(default)]
    pub validation: Option<LossTerms>,
    /// Their weighted sum.
    #[serde(default)]
    pub validation_total: Option<f64>,
}

/// Is told how an epoch went, and may stop the training.
pub(crate) type Observe<'o> = dyn FnMut(&EpochReport) -> ControlFlow<()> + 'o;

/// How training went.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrainingReport {
    /// Drives and losses left out.
    pub warnings: Vec<ModelWarning>,
    /// Drives learned from.
    pub drives: usize,
    /// Drives among them with an ADB score.
    pub drives_with_adb: usize,
    /// The linear heads: what each learned from and how well it does on driving kept back; empty for the paper's networks.
    pub heads: Vec<HeadReport>,
    /// S of the linear heads.
    pub style: Option<StyleHead>,
    /// The paper's networks; none for linear heads.
    pub networks: Option<NetworkReport>,
}

/// How the paper's networks were trained.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NetworkReport {
    /// Every epoch of the run that made the model, in order.
    pub epochs: Vec<EpochReport>,
    /// The run that kept people back, unless there was none.
    pub selection: Option<Selection>,
    /// How good the predictions of the networks that drive are, on the rows that they learned from.
    pub quality: Quality,
    /// Losses without data, and why.
    pub left_out: Vec<(Loss, &'static str)>,
    /// Rows learned from.
    pub rows: usize,
    /// Rows among them at which ego follows.
    pub following_rows: usize,
    /// Rows among them at which a lane change is being started.
    pub lane_change_rows: usize,
}

/// Learns heads and embeddings from `drives`, of the kind that [`TrainSettings::heads`] names.
///
/// `seed` fixes every draw; the result does not depend on the number of threads. After each epoch of networks `observe`
/// is told how it went, and may stop the training.
///
/// # Errors
/// [`ModelError::BadSetting`], [`ModelError::NoDrives`], [`ModelError::DuplicateDrive`], [`ModelError::Diverged`], or
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
            return Err(ModelError::DuplicateDrive {
                drive: drive.clone(),
            });
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
    let selection = select(drives, settings, seed, observe)?;
    let data = Data::new(drives, settings)?;
    let last = selection.as_ref().map_or(settings.epochs, |s| s.kept_epoch);
    let mut trainer = Trainer::new(&data, settings, seed, last);
    let mut epochs = Vec::with_capacity(last);
    for number in 1..=last {
        epochs.push(epoch(&mut trainer, number)?);
        tell(observe, &epochs[number - 1])?;
    }
    let model = finish(&data, settings, &trainer)?;
    let quality = quality(&model, &data)?;
    let trained = model.training().iter();
    let embeddings = trained.map(|t| (t.drive.clone(), t.embedding.clone()));
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
                left_out: data.left_out,
            }),
            warnings: data.warnings,
        },
        model,
    })
}

/// One epoch of `trainer`, if it stays among numbers.
pub(crate) fn epoch(trainer: &mut Trainer<'_>, epoch: usize) -> Result<EpochReport, ModelError> {
    let report = trainer.epoch(epoch);
    if report.total.is_finite() && trainer.parameters().iter().all(|p| p.is_finite()) {
        Ok(report)
    } else {
        Err(ModelError::Diverged { epoch })
    }
}

/// Tells how an epoch went.
pub(crate) fn tell(observe: &mut Observe<'_>, report: &EpochReport) -> Result<(), ModelError> {
    if observe(report).is_break() {
        return Err(ModelError::Cancelled {
            epoch: report.epoch,
        });
    }
    Ok(())
}

/// The predictions of networks for the rows that they learned from, each by its drive's embedding.
fn quality(model: &Model, data: &Data) -> Result<Quality, ModelError> {
    let paper = model.paper()?;
    let each = model.training().par_iter().zip(&data.rows_of_each);
    let said = each.map(|(t, rows)| {
        NetworkRows::new(paper, rows, None)
            .say(t.embedding.coordinates())
            .1
    });
    let said: Vec<Vec<_>> = said.collect();
    let said: Vec<_> = said
        .into_iter()
        .flatten()
        .zip(data.rows_of_each.iter().flatten())
        .collect();
    Ok(Quality::of(&said, &data.row_weights))
}

/// Whitens and packs.
pub(crate) fn finish(
    data: &Data,
    settings: &TrainSettings,
    trainer: &Trainer<'_>,
) -> Result<Model, ModelError> {
    let d = settings.embedding_size;
    let raw = trainer.embeddings.chunks_exact(d);
    let raw: Vec<DVector<f64>> = raw
        .map(|w| DVector::from_iterator(d, w.iter().map(|&x| f64::from(x))))
        .collect();
    let (whitening, white) = Whitening::of(&raw, d);
    let mut training = Vec::with_capacity(white.len());
    for ((drive, w), &mean_speed_mps) in data.drives.iter().zip(&white).zip(&data.mean_speed_mps) {
        training.push(TrainingEmbedding {
            drive: drive.clone(),
            embedding: Embedding::new(w.iter().copied().collect())?,
            mean_speed_mps,
        });
    }
    Model::try_from(ModelParts {
        embedding_size: d,
        training,
        heads: Heads::Paper(Box::new(PaperNetworks {
            architecture: settings.architecture(),
            windows: settings.windows(),
            row_rate_hz: settings.row_rate_hz,
            loss_weights: data.active_weights(&settings.loss_weights),
            scaling: data.scaling,
            row_weights: data.row_weights,
            learned: data.learned,
            speed_range_mps: data.speed_range_mps,
            whitening,
            parameters: trainer.parameters(),
        })),
    })
}

#[cfg(test)]
mod tests;
