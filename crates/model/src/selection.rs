//! How long to train: people are kept back, and the epoch that is best for them counts.

use crate::{
    dataset::Data,
    epochs::{EpochReport, Observe, TrainingDrive, shuffled_drivers, tell},
    error::ModelError,
    heads::LearnedFrom,
    held_out::{HeldOut, Said, cut},
    losses::Sums,
    model::Model,
    own_means::OwnMeans,
    params::TrainSettings,
    personalize::NetworkRows,
    quality::Quality,
    rows::{Row, rows_of},
    trainer::Trainer,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Share of the drive of somebody kept back, from its start, that they are known by; the rest judges.
const KNOWN: f64 = 2.0 / 3.0;

/// The run that kept people back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Selection {
    /// Its epochs, with the losses on both parts.
    pub epochs: Vec<EpochReport>,
    /// The epoch that counted, from 1.
    pub kept_epoch: usize,
    /// Whether it stopped before the last epoch asked for.
    pub stopped_early: bool,
    /// People kept back.
    pub people: usize,
    /// Their drives that judge.
    pub drives: usize,
    /// How good the predictions at that epoch are on the last third of their drives, by embeddings fitted to the rest.
    pub quality: Quality,
    /// How far off they are there.
    pub networks: HeldOut,
    /// How far off those drivers' own means over the first two thirds are there.
    pub own_means: HeldOut,
}

/// Trains on some people and judges on others; `None` where nobody is, or can be, kept back.
pub(crate) fn select(
    drives: &[TrainingDrive<'_>],
    learned_from: &LearnedFrom,
    settings: &TrainSettings,
    seed: u64,
    observe: &mut Observe<'_>,
) -> Result<Option<Selection>, ModelError> {
    let mut people = shuffled_drivers(drives, seed, &["train", "people kept back"]);
    if settings.validation_fraction <= 0.0 || people.len() < 3 {
        return Ok(None);
    }
    let kept = (settings.validation_fraction * people.len() as f64).round() as usize;
    people.truncate(kept.max(1));
    let (kept, seen): (Vec<_>, Vec<_>) =
        drives.iter().partition(|d| people.contains(&&d.drive.meta().participant));
    let seen: Vec<TrainingDrive<'_>> = seen.into_iter().copied().collect();
    let rows = |d: &&TrainingDrive<'_>| {
        rows_of(d.drive, &settings.row_settings(), settings.fit_fraction).ok()
    };
    let rows_of_kept: Vec<Vec<Row>> = kept.iter().filter_map(rows).collect();
    let judged: Vec<_> = rows_of_kept.iter().filter_map(|rows| cut(rows, KNOWN)).collect();
    let data = match Data::new(&seen, settings) {
        Ok(data) if !judged.is_empty() => data,
        // Who is left is too short to learn from, or to be judged by.
        _ => return Ok(None),
    };
    let mut trainer = Trainer::new(&data, settings, seed, settings.epochs);
    let mut epochs = Vec::new();
    let (mut kept_epoch, mut least, mut best) = (0, f64::INFINITY, Vec::new());
    for number in 1..=settings.epochs {
        if settings.patience > 0 && number > kept_epoch + settings.patience {
            break;
        }
        let mut report = trainer.epoch(number)?;
        let (sums, predictions) = say(&trainer.model(learned_from)?, &judged)?;
        let losses = sums.terms(None, settings.embedding_size);
        let total = losses.total(&data.active_weights(&settings.loss_weights));
        report.validation = Some(losses);
        report.validation_total = Some(total);
        if total < least {
            (kept_epoch, least, best) = (number, total, predictions);
        }
        epochs.push(report);
        tell(observe, &report)?;
    }
    let unseen = || judged.iter().flat_map(|(_, unseen)| *unseen);
    let means = OwnMeans::learn(&data.rows_of_each, &data.row_weights);
    let predicted = judged.iter().flat_map(|(known, unseen)| vec![means.say(known); unseen.len()]);
    let weights = &data.row_weights;
    let own_means = HeldOut::from_predictions(predicted.zip(unseen()), weights);
    let best: Vec<(Said, &Row)> = best.into_iter().zip(unseen()).collect();
    Ok(Some(Selection {
        stopped_early: epochs.len() < settings.epochs,
        epochs,
        kept_epoch: kept_epoch.max(1),
        people: people.len(),
        drives: judged.len(),
        quality: Quality::from_predictions(&best, weights),
        networks: HeldOut::from_predictions(best, weights),
        own_means,
    }))
}

/// What a model says of the rows that judge, known by those before them.
fn say(model: &Model, judged: &[(&[Row], &[Row])]) -> Result<(Sums, Vec<Said>), ModelError> {
    let paper = model.paper()?;
    let mean = model.mean_embedding().coordinates();
    let one = |(known, unseen): &(&[Row], &[Row])| {
        let w = NetworkRows::new(paper, known, None).minimum(mean);
        NetworkRows::new(paper, unseen, None).say(w.as_slice())
    };
    let each: Vec<_> = judged.par_iter().map(one).collect();
    let (mut sums, mut predictions) = (Sums::default(), Vec::new());
    for (of_drive, of_rows) in each {
        sums.merge(&of_drive);
        predictions.extend(of_rows);
    }
    Ok((sums, predictions))
}
