//! Cross-validation by driver: how well unseen drivers are fitted with embeddings of several sizes.

use crate::{
    error::ModelError,
    losses::LossTerms,
    params::{PersonalizeParams, TrainParams, TrainSettings},
    personalize::personalize,
    train::{TrainingDrive, train},
};
use maveric_domain::{ParticipantId, stream_seed};
use rand::{SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeSet, ops::ControlFlow};

/// How well unseen drivers were fitted with embeddings of one size: means over drives of each drive's loss
/// after personalising; `None` where no drive had one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SizeResult {
    /// Numbers in an embedding.
    pub embedding_size: usize,
    /// L1.
    pub following_distance: Option<f64>,
    /// L2.
    pub lane_change: Option<f64>,
    /// L3.
    pub velocity: Option<f64>,
    /// Unseen drives fitted.
    pub drives: usize,
    /// The losses of each, drives in the order given.
    pub of_each: Vec<LossTerms>,
}

/// Trains without each fold of drivers in turn, personalises to the fold, and says how well it fits.
///
/// All drives of a participant are in one fold. Personalising does not use ADB. The folds are the same for every
/// size. `observe` is told the size and the fold (from 0) before each training, and may stop.
///
/// # Errors
/// [`ModelError::TooFewDrivers`] unless there are 2 folds or more and a driver for each;
/// [`ModelError::Cancelled`] where `observe` broke off; else whatever training or personalising says.
///
/// # Source
/// Method section 3, "Embedding size". Losses cannot choose the size alone: calibration section 3.
pub fn cross_validate(
    drives: &[TrainingDrive<'_>],
    sizes: &[usize],
    folds: usize,
    params: &TrainParams,
    personalizing: &PersonalizeParams,
    seed: u64,
    observe: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Vec<SizeResult>, ModelError> {
    let drivers: BTreeSet<&ParticipantId> =
        drives.iter().map(|d| &d.drive.meta().participant).collect();
    let mut drivers: Vec<&ParticipantId> = drivers.into_iter().collect();
    if folds < 2 || folds > drivers.len() {
        return Err(ModelError::TooFewDrivers {
            drivers: drivers.len(),
            folds,
        });
    }
    let shuffle = stream_seed(seed, &["cross-validate", "folds"]);
    drivers.shuffle(&mut Pcg64Mcg::seed_from_u64(shuffle));
    let fold_of = |drive: &TrainingDrive<'_>| {
        let participant = &drive.drive.meta().participant;
        drivers.iter().position(|d| *d == participant).unwrap_or(0) % folds
    };
    let mut results = Vec::with_capacity(sizes.len());
    for &embedding_size in sizes {
        let settings = TrainSettings {
            embedding_size,
            // A run that only measures would change nothing here.
            validation_fraction: match params.settings() {
                s if s.patience == 0 && s.refit => 0.0,
                s => s.validation_fraction,
            },
            ..params.settings().clone()
        };
        let params = TrainParams::new(settings)?;
        let mut of_each: Vec<Option<LossTerms>> = vec![None; drives.len()];
        for fold in 0..folds {
            if observe(embedding_size, fold).is_break() {
                return Err(ModelError::Cancelled { epoch: 0 });
            }
            let seen = drives.iter().filter(|d| fold_of(d) != fold);
            let seen: Vec<TrainingDrive<'_>> = seen.copied().collect();
            let model = train(&seen, &params, seed, &mut |_| ControlFlow::Continue(()))?.model;
            for (drive, terms) in drives.iter().zip(&mut of_each) {
                if fold_of(drive) != fold {
                    continue;
                }
                *terms = match personalize(&model, drive.drive, None, personalizing, seed) {
                    Ok(fit) => Some(fit.losses),
                    Err(ModelError::DriveTooShort { .. }) => None,
                    Err(other) => return Err(other),
                };
            }
        }
        let of_each: Vec<LossTerms> = of_each.into_iter().flatten().collect();
        let mean = |term: fn(&LossTerms) -> Option<f64>| {
            let values: Vec<f64> = of_each.iter().filter_map(term).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        results.push(SizeResult {
            embedding_size,
            following_distance: mean(|t| t.following_distance),
            lane_change: mean(|t| t.lane_change),
            velocity: mean(|t| t.velocity),
            drives: of_each.len(),
            of_each,
        });
    }
    Ok(results)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_drives::drivers;

    #[test]
    fn every_drive_is_unseen_once_for_every_size() {
        let drives = drivers(4, 60.0);
        let given: Vec<_> = drives
            .iter()
            .map(|(drive, adb)| TrainingDrive {
                drive,
                adb: Some(*adb),
            })
            .collect();
        let settings = TrainSettings {
            epochs: 2,
            ..TrainSettings::default()
        };
        let params = TrainParams::new(settings).unwrap();
        let personalizing = PersonalizeParams::default();
        let mut seen = Vec::new();
        let mut observe = |size, fold| {
            seen.push((size, fold));
            ControlFlow::Continue(())
        };
        let sizes = [1, 2];
        let run = |folds, observe: &mut dyn FnMut(usize, usize) -> ControlFlow<()>| {
            cross_validate(&given, &sizes, folds, &params, &personalizing, 1, observe)
        };
        let results = run(2, &mut observe).unwrap();
        assert_eq!(seen, [(1, 0), (1, 1), (2, 0), (2, 1)]);
        for result in results {
            assert_eq!(result.drives, 4);
            assert!(result.velocity.unwrap() > 0.0);
        }
        assert!(matches!(
            run(5, &mut |_, _| ControlFlow::Continue(())),
            Err(ModelError::TooFewDrivers { drivers: 4, .. })
        ));
    }
}
