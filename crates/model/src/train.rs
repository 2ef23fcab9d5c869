//! Training: all weights and one embedding per drive, together.

use crate::{
    dataset::{Data, RowSet},
    error::{ModelError, ModelWarning},
    losses::{Loss, LossTerms},
    model::{Model, ModelParts, TrainingEmbedding},
    network::Networks,
    params::{TrainParams, TrainSettings},
    quality::{Quality, RowsOf},
    trainer::Trainer,
    training_state::{Best, Selection, TrainingState, bad},
    whitening::Whitening,
};
use maveric_domain::{AdbScore, Drive, DriveId, Embedding};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

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
    /// Every epoch of the run that made the model, in order.
    pub epochs: Vec<EpochReport>,
    /// The run that kept the last rows of every drive back, unless there was none.
    pub selection: Option<Selection>,
    /// How good the model's predictions are: for the rows kept back if they were not learned from afterwards.
    pub quality: Quality,
    /// Losses without data, and why.
    pub left_out: Vec<(Loss, &'static str)>,
    /// Drives and losses left out.
    pub warnings: Vec<ModelWarning>,
    /// Drives learned from.
    pub drives: usize,
    /// Drives among them with an ADB score.
    pub drives_with_adb: usize,
    /// Rows learned from.
    pub rows: usize,
    /// Rows among them at which ego follows.
    pub following_rows: usize,
    /// Rows among them at which a lane change is being started.
    pub lane_change_rows: usize,
    /// Weights and biases.
    pub parameters: usize,
}

/// Where a training goes on from, and who keeps its states.
pub struct Checkpoints<'a> {
    /// The state to go on from; `None` starts from the beginning.
    pub resume: Option<TrainingState>,
    /// A state is given to `save` after every so many epochs, and when `observe` stops the training; 0: only then.
    pub every: usize,
    /// Keeps a state; may stop the training.
    pub save: &'a mut (dyn FnMut(&TrainingState) -> ControlFlow<()> + Send),
}

impl std::fmt::Debug for Checkpoints<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Checkpoints")
            .field("every", &self.every)
            .finish_non_exhaustive()
    }
}

/// Learns networks and embeddings from `drives`.
///
/// `seed` fixes every draw; the result does not depend on the number of threads. After each epoch `observe`
/// is told how it went, and may stop the training.
///
/// With [`TrainSettings::validation_fraction`] a run of its own keeps the last rows of every drive back and measures
/// the losses on them; with [`TrainSettings::refit`] the model is then trained on all rows.
///
/// # Errors
/// [`ModelError::NoDrives`], [`ModelError::DuplicateDrive`], [`ModelError::Diverged`], or
/// [`ModelError::Cancelled`] where `observe` broke off. A drive shorter than a window is left out with a warning.
///
/// # Source
/// Paper, "Training"; method section 3; rates, weights, noise and rows from calibration section 3.
pub fn train(
    drives: &[TrainingDrive<'_>],
    params: &TrainParams,
    seed: u64,
    observe: &mut dyn FnMut(&EpochReport) -> ControlFlow<()>,
) -> Result<Trained, ModelError> {
    let checkpoints = Checkpoints {
        resume: None,
        every: 0,
        save: &mut |_| ControlFlow::Continue(()),
    };
    train_resumable(drives, params, seed, checkpoints, observe)
}

/// As [`train()`], with states kept on the way: going on from one gives the bytes of a training never stopped.
///
/// # Errors
/// As [`train()`]; [`ModelError::BadCheckpoint`] if the state is of other drives, settings or another seed.
pub fn train_resumable(
    drives: &[TrainingDrive<'_>],
    params: &TrainParams,
    seed: u64,
    checkpoints: Checkpoints<'_>,
    observe: &mut dyn FnMut(&EpochReport) -> ControlFlow<()>,
) -> Result<Trained, ModelError> {
    let settings = params.settings();
    let networks = Networks::new(settings.architecture());
    let kept_back = settings.validation_fraction;
    let mut data = Data::new(drives, settings, kept_back)?;
    let mut session = Session {
        fingerprint: data.fingerprint(settings, seed),
        resume: None,
        every: checkpoints.every,
        save: checkpoints.save,
        observe,
        selection: None,
    };
    if let Some(state) = checkpoints.resume {
        session.resume(state)?;
    }
    let mut made = None;
    if kept_back > 0.0 && session.selection.is_none() {
        let mut trainer = Trainer::new(&data, settings, &networks, seed, settings.epochs);
        let run = session.run(&mut trainer, Some(&data.validation), settings.patience)?;
        let (kept_epoch, total_epochs) = match &run.best {
            Some(best) => {
                trainer.set_weights(&best.weights)?;
                (best.epoch, run.epochs.len())
            }
            None => (run.epochs.len(), run.epochs.len()),
        };
        session.selection = Some(Selection {
            kept_epoch,
            stopped_early: total_epochs < settings.epochs,
            training_rows: data.training.len(),
            validation_rows: data.validation.len(),
            quality: quality(&mut trainer, &data, &data.validation, RowsOf::Validation),
            epochs: run.epochs.clone(),
        });
        made = Some((run, trainer.parameters(), trainer.embeddings));
    }
    let refit = kept_back <= 0.0 || settings.refit;
    let (run, parameters, embeddings, quality) = match made {
        Some((run, parameters, embeddings)) if !refit => {
            let quality = session.selection.as_ref().map(|s| s.quality.clone());
            let quality = quality.ok_or(ModelError::Cancelled { epoch: 0 })?;
            (run, parameters, embeddings, quality)
        }
        _ => {
            if kept_back > 0.0 {
                data = Data::new(drives, settings, 0.0)?;
            }
            let epochs = session.selection.as_ref().map(|s| s.kept_epoch);
            let epochs = epochs.unwrap_or(settings.epochs);
            let mut trainer = Trainer::new(&data, settings, &networks, seed, epochs);
            let run = session.run(&mut trainer, None, 0)?;
            let quality = quality(&mut trainer, &data, &data.training, RowsOf::Training);
            (run, trainer.parameters(), trainer.embeddings, quality)
        }
    };
    let model = finish(&data, settings, &networks, parameters, &embeddings)?;
    let trained = model.training().iter();
    let embeddings = trained.map(|t| (t.drive.clone(), t.embedding.clone()));
    Ok(Trained {
        embeddings: embeddings.collect(),
        report: data.report(run, session.selection, quality, networks.parameters),
        model,
    })
}

fn quality(trainer: &mut Trainer<'_>, data: &Data, rows: &RowSet, on: RowsOf) -> Quality {
    let (_, _, predicted) = trainer.predict(rows);
    Quality::of(on, rows, &predicted, &data.scaling, &data.row_weights)
}

/// Epochs one after the other.
pub(crate) struct Run {
    pub(crate) epochs: Vec<EpochReport>,
    /// Where stopping early was asked for.
    best: Option<Best>,
}

/// What a training keeps from run to run.
struct Session<'a> {
    fingerprint: u64,
    resume: Option<TrainingState>,
    every: usize,
    save: &'a mut (dyn FnMut(&TrainingState) -> ControlFlow<()> + Send),
    observe: &'a mut dyn FnMut(&EpochReport) -> ControlFlow<()>,
    selection: Option<Selection>,
}

impl Session<'_> {
    fn resume(&mut self, state: TrainingState) -> Result<(), ModelError> {
        if state.fingerprint != self.fingerprint {
            return Err(bad(
                "it was made from other drives, scores, settings or another seed".to_owned(),
            ));
        }
        self.selection.clone_from(&state.selection);
        self.resume = Some(state);
        Ok(())
    }

    /// All epochs of `trainer`, or fewer if the loss on rows kept back does not fall for `patience` epochs.
    fn run(
        &mut self,
        trainer: &mut Trainer<'_>,
        validation: Option<&RowSet>,
        patience: usize,
    ) -> Result<Run, ModelError> {
        let mut run = Run {
            epochs: Vec::new(),
            best: None,
        };
        if let Some(state) = self.resume.take() {
            trainer.set_weights(&state.weights)?;
            trainer.set_moments(&state.moments)?;
            run.epochs = state.epochs;
            run.best = state.best;
        }
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
            let stop = (self.observe)(&report).is_break();
            let due = self.every > 0 && epoch.is_multiple_of(self.every);
            if stop || due {
                let state = TrainingState {
                    fingerprint: self.fingerprint,
                    selection: self.selection.clone(),
                    weights: trainer.weights(),
                    moments: trainer.moments(),
                    epochs: run.epochs.clone(),
                    best: run.best.clone(),
                };
                if (self.save)(&state).is_break() || stop {
                    return Err(ModelError::Cancelled { epoch });
                }
            }
        }
        Ok(run)
    }
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
    Model::from_parts(ModelParts {
        settings: settings.clone(),
        architecture: networks.architecture,
        scaling: data.scaling,
        row_weights: data.row_weights,
        learned: data.learned,
        speed_range_mps: data.speed_range_mps,
        whitening,
        training,
        parameters,
    })
}

#[cfg(test)]
mod tests;
