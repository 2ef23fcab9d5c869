//! Training linear heads on drives: the events, the fit, S, and how good it all is on driving kept back.

use super::{
    fit::{DriveEvents, fit},
    kept_back::kept_back,
    learned_from::{length_s, posted},
    list::{HEADS, events_of},
    report::HeadReport,
    style::{ScoredStyle, StyleHead},
    support::Population,
};
use crate::{
    epochs::{TrainingDrive, check_drivers},
    error::{ModelError, ModelWarning},
    model::{Heads, LinearHeads, Model, ModelParts, TrainingEmbedding},
    on_range::range_of,
    params::TrainSettings,
    training_report::{Trained, TrainingReport},
};
use maveric_domain::{Embedding, ParticipantId, StyleScore};
use std::collections::BTreeSet;

/// Learns the linear heads, S, and where the drives lie in style space by their driving alone.
pub(crate) fn train_heads(
    given: &[TrainingDrive<'_>],
    settings: &TrainSettings,
    seed: u64,
) -> Result<Trained, ModelError> {
    let (d, score_range) = (settings.embedding_size, range_of(given)?);
    let posted = posted(given, settings.free_speed)?;
    let mut warnings = Vec::new();
    let mut used: Vec<&TrainingDrive<'_>> = Vec::new();
    let mut events: Vec<DriveEvents> = Vec::new();
    for drive in given {
        let until_s = length_s(drive.drive, settings.fit_fraction);
        let shown = events_of(drive.drive, until_s, Some(&posted));
        if shown.iter().all(Vec::is_empty) {
            warnings.push(ModelWarning::NoHabits { drive: drive.drive.meta().drive.clone() });
        } else {
            used.push(drive);
            events.push(shown);
        }
    }
    check_drivers(&used, given.len(), &mut warnings)?;
    let participants = || used.iter().map(|t| &t.drive.meta().participant);
    let fitted = fit(&HEADS.map(|h| h.shape()), &events, d);
    let scored: Vec<ScoredStyle> = used
        .iter()
        .zip(&fitted.latents)
        .filter_map(|(t, latent)| {
            Some(ScoredStyle {
                participant: t.drive.meta().participant.clone(),
                style: latent.style(d),
                points: t.adb.map(StyleScore::points)?,
            })
        })
        .collect();
    let style = StyleHead::fit(&scored, d, seed);
    let people = participants().collect::<BTreeSet<_>>().len();
    let population = Population::learn(&fitted.heads, &events, people);
    let owners: Vec<&str> = participants().map(ParticipantId::as_str).collect();
    let kept_back = kept_back(&events, &owners, d);
    let reports = fitted.heads.iter().zip(kept_back).enumerate();
    let heads: Vec<HeadReport> =
        reports.map(|(k, (head, kept))| HeadReport::new(head, k, kept)).collect();
    let mut training = Vec::with_capacity(used.len());
    for (t, latent) in used.iter().zip(&fitted.latents) {
        let speeds = &t.drive.rows().ego_speed_mps;
        training.push(TrainingEmbedding {
            drive: t.drive.meta().drive.clone(),
            embedding: Embedding::new(latent.w(d).to_vec())?,
            mean_speed_mps: speeds.iter().sum::<f64>() / speeds.len() as f64,
        });
    }
    let model = Model::try_from(ModelParts {
        embedding_size: d,
        score_range,
        population,
        posted,
        training,
        days: None,
        heads: Heads::Linear(LinearHeads { heads: fitted.heads, style: style.clone() }),
    })?;
    let embeddings = model.training().iter();
    Ok(Trained {
        embeddings: embeddings.map(|t| (t.drive.clone(), t.embedding.clone())).collect(),
        report: TrainingReport {
            warnings,
            drives: used.len(),
            drives_with_adb: scored.len(),
            heads,
            style,
            networks: None,
        },
        model,
    })
}
