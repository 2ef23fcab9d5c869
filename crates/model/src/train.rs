//! Training: all weights and one embedding per drive, together.

use crate::{
    dataset::{Data, RowSet},
    error::{ModelError, ModelWarning},
    heads::{HeadReport, StyleHead, train_heads},
    losses::{Loss, LossTerms},
    model::{Heads, HeadsKind, Model, ModelParts, TrainingEmbedding},
    network::Networks,
    paper::{PaperNetworks, PaperParts},
    params::{TrainParams, TrainSettings},
    quality::{Quality, RowsOf},
    trainer::{Trainer, Weights},
    whitening::Whitening,
};
use maveric_domain::{AdbScore, Drive, DriveId, Embedding};
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
    /// The losses on rows kept back, at its end, L4 left out; only in the run that keeps some back.
    #[serde(default)]
    pub validation: Option<LossTerms>,
    /// Their weighted sum.
    #[serde(default)]
    pub validation_total: Option<f64>,
    /// Rate of the weights at its end.
    pub learning_rate: f64,
    /// Mean norm of the gradient before clipping.
    pub gradient_norm: f64,
}

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
    /// The run that kept the last rows of every drive back, unless there was none.
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

/// The run that kept the last rows of every drive back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Selection {
    /// Its epochs, with the losses on both parts.
    pub epochs: Vec<EpochReport>,
    /// The epoch that counted, from 1.
    pub kept_epoch: usize,
    /// Whether it stopped before the last epoch asked for.
    pub stopped_early: bool,
    /// Rows learned from.
    pub training_rows: usize,
    /// Rows kept back.
    pub validation_rows: usize,
    /// How good its predictions are on the rows kept back.
    pub quality: Quality,
}

/// Learns heads and embeddings from `drives`, of the kind that [`TrainSettings::heads`] names.
///
/// `seed` fixes every draw; the result does not depend on the number of threads. After each epoch of networks `observe`
/// is told how it went, and may stop the training.
///
/// # Errors
/// [`ModelError::NoDrives`], [`ModelError::DuplicateDrive`], [`ModelError::Diverged`], or
/// [`ModelError::Cancelled`] where `observe` broke off. A drive that shows nothing is left out with a warning.
///
/// # Source
/// Paper, "Training"; method section 3; rates, weights, noise and rows from calibration section 3. Linear heads are ours.
pub fn train(
    drives: &[TrainingDrive<'_>],
    params: &TrainParams,
    seed: u64,
    observe: &mut dyn FnMut(&EpochReport) -> ControlFlow<()>,
) -> Result<Trained, ModelError> {
    let mut seen = BTreeSet::new();
    for drive in drives.iter().map(|d| &d.drive.meta().drive) {
        if !seen.insert(drive) {
            return Err(ModelError::DuplicateDrive {
                drive: drive.clone(),
            });
        }
    }
    match params.settings().heads {
        HeadsKind::Linear => train_heads(drives, params.settings(), seed),
        HeadsKind::Paper => train_networks(drives, params.settings(), seed, observe),
    }
}

/// Trains the paper's networks. With [`TrainSettings::validation_fraction`] a run of its own keeps the last rows of every drive
/// back and measures the losses on them; with [`TrainSettings::refit`] the model is then trained on all rows.
fn train_networks(
    drives: &[TrainingDrive<'_>],
    settings: &TrainSettings,
    seed: u64,
    observe: &mut dyn FnMut(&EpochReport) -> ControlFlow<()>,
) -> Result<Trained, ModelError> {
    let networks = Networks::new(settings.architecture());
    let kept_back = settings.validation_fraction;
    let mut data = Data::new(drives, settings, kept_back)?;
    let mut selection = None;
    let mut made = None;
    if kept_back > 0.0 {
        let mut trainer = Trainer::new(&data, settings, &networks, seed, settings.epochs);
        let patience = settings.patience;
        let run = run(&mut trainer, Some(&data.validation), patience, observe)?;
        let kept_epoch = run.best.as_ref().map_or(run.epochs.len(), |b| b.epoch);
        if let Some(best) = &run.best {
            trainer.set_weights(&best.weights);
        }
        selection = Some(Selection {
            kept_epoch,
            stopped_early: run.epochs.len() < settings.epochs,
            training_rows: data.training.len(),
            validation_rows: data.validation.len(),
            quality: quality(&mut trainer, &data, &data.validation, RowsOf::Validation),
            epochs: run.epochs.clone(),
        });
        let on_training = quality(&mut trainer, &data, &data.training, RowsOf::Training);
        made = Some((run, trainer.parameters(), trainer.embeddings, on_training));
    }
    let (run, parameters, embeddings, quality) = match made {
        Some(made) if !settings.refit => made,
        _ => {
            if kept_back > 0.0 {
                data = Data::new(drives, settings, 0.0)?;
            }
            let epochs = selection.as_ref().map_or(settings.epochs, |s| s.kept_epoch);
            let mut trainer = Trainer::new(&data, settings, &networks, seed, epochs);
            let run = run(&mut trainer, None, 0, observe)?;
            let quality = quality(&mut trainer, &data, &data.training, RowsOf::Training);
            (run, trainer.parameters(), trainer.embeddings, quality)
        }
    };
    let model = finish(&data, settings, &networks, parameters, &embeddings)?;
    let trained = model.training().iter();
    let embeddings = trained.map(|t| (t.drive.clone(), t.embedding.clone()));
    Ok(Trained {
        embeddings: embeddings.collect(),
        report: TrainingReport {
            warnings: data.warnings,
            drives: data.drives.len(),
            drives_with_adb: data.adb.iter().flatten().count(),
            heads: Vec::new(),
            style: None,
            networks: Some(NetworkReport {
                epochs: run.epochs,
                selection,
                quality,
                left_out: data.left_out,
                rows: data.training.len(),
                following_rows: data.following_rows,
                lane_change_rows: data.lane_change_rows,
            }),
        },
        model,
    })
}

fn quality(trainer: &mut Trainer<'_>, data: &Data, rows: &RowSet, on: RowsOf) -> Quality {
    let (_, _, predicted) = trainer.predict(rows);
    Quality::of(on, rows, &predicted, &data.scaling, &data.row_weights)
}

/// Epochs one after the other.
struct Run {
    epochs: Vec<EpochReport>,
    /// Where stopping early was asked for.
    best: Option<Best>,
}

/// The epoch with the lowest loss on rows kept back.
struct Best {
    epoch: usize,
    total: f64,
    weights: Weights,
}

/// All epochs of `trainer`, or fewer if the loss on rows kept back does not fall for `patience` epochs.
fn run(
    trainer: &mut Trainer<'_>,
    validation: Option<&RowSet>,
    patience: usize,
    observe: &mut dyn FnMut(&EpochReport) -> ControlFlow<()>,
) -> Result<Run, ModelError> {
    let mut run = Run {
        epochs: Vec::new(),
        best: None,
    };
    while run.epochs.len() < trainer.epochs() {
        let epoch = run.epochs.len() + 1;
        let waited = run.best.as_ref().map_or(0, |best| epoch - 1 - best.epoch);
        if patience > 0 && waited >= patience {
            break;
        }
        let mut report = trainer.epoch(epoch);
        if !report.total.is_finite() || !report.gradient_norm.is_finite() {
            return Err(ModelError::Diverged { epoch });
        }
        if let Some(rows) = validation {
            let (losses, total, _) = trainer.predict(rows);
            report.validation = Some(losses);
            report.validation_total = Some(total);
            if patience > 0 && run.best.as_ref().is_none_or(|best| total < best.total) {
                run.best = Some(Best {
                    epoch,
                    total,
                    weights: trainer.weights(),
                });
            }
        }
        run.epochs.push(report);
        if observe(&report).is_break() {
            return Err(ModelError::Cancelled { epoch });
        }
    }
    Ok(run)
}

/// Whitens, folds and packs.
fn finish(
    data: &Data,
    settings: &TrainSettings,
    networks: &Networks,
    mut parameters: Vec<f32>,
    embeddings: &[f32],
) -> Result<Model, ModelError> {
    let d = settings.embedding_size;
    let raw: Vec<Vec<f64>> = embeddings
        .chunks_exact(d)
        .map(|w| w.iter().map(|&x| f64::from(x)).collect())
        .collect();
    let whitening = if settings.whiten {
        let points: Vec<&[f64]> = raw.iter().map(Vec::as_slice).collect();
        let whitening = Whitening::of(&points, d);
        whitening.fold(networks, &mut parameters);
        whitening
    } else {
        Whitening::identity(d)
    };
    let mut training = Vec::with_capacity(raw.len());
    for ((drive, raw), &mean_speed_mps) in data.drives.iter().zip(&raw).zip(&data.mean_speed_mps) {
        training.push(TrainingEmbedding {
            drive: drive.clone(),
            embedding: Embedding::new(whitening.apply(raw))?,
            mean_speed_mps,
        });
    }
    let paper = PaperNetworks::try_from(PaperParts {
        architecture: networks.architecture,
        windows: settings.windows(),
        row_rate_hz: settings.row_rate_hz,
        loss_weights: settings.loss_weights,
        scaling: data.scaling,
        row_weights: data.row_weights,
        learned: data.learned,
        speed_range_mps: data.speed_range_mps,
        whitening,
        parameters,
    })?;
    Model::try_from(ModelParts {
        embedding_size: d,
        training,
        heads: Heads::Paper(Box::new(paper)),
    })
}

#[cfg(test)]
mod tests;
