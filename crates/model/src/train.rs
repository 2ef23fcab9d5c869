//! Training: all weights and one embedding per drive, together.

use crate::{
    dataset::Data,
    error::{ModelError, ModelWarning},
    losses::{Loss, LossTerms},
    model::{Model, ModelParts, TrainingEmbedding},
    network::Networks,
    params::{TrainParams, TrainSettings},
    trainer::Trainer,
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
    /// The losses while it ran, means over its batches.
    pub losses: LossTerms,
    /// Their weighted sum.
    pub total: f64,
    /// Rate of the weights at its end.
    pub learning_rate: f64,
    /// Mean norm of the gradient before clipping.
    pub gradient_norm: f64,
}

/// How training went.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrainingReport {
    /// Every epoch, in order.
    pub epochs: Vec<EpochReport>,
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

/// Learns networks and embeddings from `drives`.
///
/// `seed` fixes every draw; the result does not depend on the number of threads. After each epoch `observe`
/// is told how it went, and may stop the training.
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
    let settings = params.settings();
    let data = Data::new(drives, settings)?;
    let networks = Networks::new(settings.architecture());
    let mut trainer = Trainer::new(&data, settings, &networks, seed);
    let mut epochs = Vec::with_capacity(settings.epochs);
    for epoch in 1..=settings.epochs {
        let report = trainer.epoch(epoch);
        if !report.total.is_finite() || !report.gradient_norm.is_finite() {
            return Err(ModelError::Diverged { epoch });
        }
        epochs.push(report);
        if observe(&report).is_break() {
            return Err(ModelError::Cancelled { epoch });
        }
    }
    let (parameters, embeddings) = (trainer.parameters, trainer.embeddings);
    let model = finish(&data, settings, &networks, parameters, &embeddings)?;
    let trained = model.training().iter();
    let embeddings = trained.map(|t| (t.drive.clone(), t.embedding.clone()));
    Ok(Trained {
        embeddings: embeddings.collect(),
        report: data.report(epochs, networks.parameters),
        model,
    })
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
mod tests {
    use super::*;
    use crate::{
        checkpoint,
        params::PersonalizeParams,
        personalize::{Fit, Frozen, personalize},
        rows::rows_of,
        style_space::{AggressionAxis, PerpendicularEllipse, share_outside_training},
        test_drives::{Habits, drive, drivers},
    };

    fn training(drives: &[(Drive, AdbScore)]) -> Vec<TrainingDrive<'_>> {
        let with_score = |(drive, adb)| TrainingDrive {
            drive,
            adb: Some(adb),
        };
        drives.iter().map(|(d, a)| with_score((d, *a))).collect()
    }

    fn quick(change: impl Fn(&mut TrainSettings)) -> TrainParams {
        let mut settings = TrainSettings {
            epochs: 25,
            batch_size: 128,
            ..TrainSettings::default()
        };
        change(&mut settings);
        TrainParams::new(settings).unwrap()
    }

    fn run(drives: &[TrainingDrive<'_>], params: &TrainParams) -> Result<Trained, ModelError> {
        train(drives, params, 1, &mut |_| ControlFlow::Continue(()))
    }

    /// Share of pairs that are in the order of their places.
    fn ordered(values: &[f64]) -> f64 {
        let n = values.len();
        let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (j, i)));
        let right = pairs.filter(|&(a, b)| values[a] < values[b]).count();
        right as f64 / (n * (n - 1) / 2) as f64
    }

    #[test]
    fn losses_fall_and_drivers_are_ordered_by_their_style() {
        let drives = drivers(8, 240.0);
        let trained = run(&training(&drives), &quick(|_| {})).unwrap();
        let epochs = &trained.report.epochs;
        let [first, last] = [epochs[0], epochs[epochs.len() - 1]];
        assert!(last.total < 0.5 * first.total, "{first:?} {last:?}");
        assert!(trained.report.left_out.is_empty());
        let axis = AggressionAxis::of(&trained.model).unwrap();
        let positions: Vec<f64> = trained
            .embeddings
            .iter()
            .map(|(_, w)| axis.position(w).unwrap())
            .collect();
        assert!(ordered(&positions) > 0.9, "{positions:?}");

        // New drivers between the old ones, fitted without their scores, fall between them.
        let new: Vec<f64> = (0..5)
            .map(|i| {
                let a = 0.1 + 0.2 * f64::from(i);
                let habits = Habits {
                    speed_mps: 26.0 + 8.0 * a,
                    time_gap_s: 2.2 - 1.2 * a,
                    passes: true,
                };
                let drive = drive(&format!("N{i}"), &habits, 200.0);
                let params = PersonalizeParams::default();
                let fit = personalize(&trained.model, &drive, None, &params, 3).unwrap();
                assert!(!fit.used_adb && fit.start_spread.is_finite());
                axis.position(&fit.embedding).unwrap()
            })
            .collect();
        assert!(ordered(&new) > 0.85, "{new:?}");

        // Moving across the axis changes S by nothing; moving far along it leaves the known range.
        let ellipse = PerpendicularEllipse::of(&trained.model).unwrap();
        let w = &trained.embeddings[2].1;
        for step in 0..8 {
            let moved = ellipse.at_angle(w, f64::from(step)).unwrap();
            let read = |w| axis.aggression_hat(w).unwrap();
            assert!((read(&moved.embedding) - read(w)).abs() < 1e-5);
        }
        let far = Embedding::new(vec![50.0; 3]).unwrap();
        let both = [w.clone(), far];
        let share = share_outside_training(&trained.model, &both).unwrap();
        assert!((share.unwrap() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn one_seed_gives_the_same_bytes_for_one_and_two_threads() {
        let drives = drivers(3, 60.0);
        let params = quick(|s| s.epochs = 2);
        let bytes = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                let trained = run(&training(&drives), &params).unwrap();
                let fit = personalize(
                    &trained.model,
                    &drives[0].0,
                    Some(drives[0].1),
                    &PersonalizeParams::default(),
                    5,
                );
                (checkpoint::to_bytes(&trained.model).unwrap(), fit.unwrap())
            })
        };
        assert!(bytes(1) == bytes(2));
    }

    #[test]
    fn whitening_leaves_every_loss_unchanged() {
        let drives = drivers(4, 90.0);
        let model = |whiten| {
            run(
                &training(&drives),
                &quick(|s| {
                    s.epochs = 4;
                    s.whiten = whiten;
                }),
            )
            .unwrap()
            .model
        };
        let (raw, white) = (model(false), model(true));
        for (index, (drive, adb)) in drives.iter().enumerate() {
            let terms = |model: &Model| {
                let rows = rows_of(drive, &model.row_settings(), 1.0).unwrap();
                let w = model.training()[index].embedding.coordinates().to_vec();
                let frozen = Frozen::of(model);
                let (sums, _, l4) = Fit::new(&frozen, &rows, Some(*adb)).sums(&w);
                sums.terms(l4, 3)
            };
            let (a, b) = (terms(&raw), terms(&white));
            let near = |a: Option<f64>, b: Option<f64>| {
                let (a, b) = (a.unwrap_or(0.0), b.unwrap_or(0.0));
                assert!((a - b).abs() < 1e-4 * (1.0 + a.abs()), "{a} {b}");
            };
            near(a.following_distance, b.following_distance);
            near(a.lane_change, b.lane_change);
            near(a.velocity, b.velocity);
            near(a.aggression, b.aggression);
            near(a.mutual_information, b.mutual_information);
        }
        let points: Vec<&[f64]> = white
            .training()
            .iter()
            .map(|t| t.embedding.coordinates())
            .collect();
        let (mean, covariance) = crate::linear_algebra::mean_and_covariance(&points, 3);
        assert!(mean.iter().all(|m| m.abs() < 1e-6));
        for i in 0..3 {
            for j in 0..3 {
                let expected = f64::from(u8::from(i == j));
                assert!((covariance[i * 3 + j] - expected).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_loss_without_data_is_left_out_and_reported() {
        let habits = Habits {
            speed_mps: 30.0,
            time_gap_s: 1.5,
            passes: false,
        };
        let alone = drive("P1", &habits, 60.0);
        let given = [TrainingDrive {
            drive: &alone,
            adb: None,
        }];
        let trained = run(&given, &quick(|s| s.epochs = 2)).unwrap();
        let left_out: Vec<Loss> = trained.report.left_out.iter().map(|(l, _)| *l).collect();
        assert_eq!(left_out, [Loss::LaneChange, Loss::Aggression]);
        assert_eq!(trained.report.warnings.len(), 2);
        assert!(matches!(
            AggressionAxis::of(&trained.model),
            Err(ModelError::NoAggressionAxis)
        ));
    }

    #[test]
    fn drives_that_cannot_be_used_are_refused_or_counted() {
        let drives = drivers(2, 60.0);
        let short = (drive_like(&drives[0].0, 20), drives[0].1);
        let params = quick(|s| s.epochs = 1);
        let mut given = training(&drives);
        given.push(given[0]);
        assert!(matches!(
            run(&given, &params),
            Err(ModelError::DuplicateDrive { .. })
        ));
        assert!(matches!(
            run(&[], &params),
            Err(ModelError::NoDrives { given: 0, .. })
        ));
        let trained = run(
            &[
                training(&drives)[1],
                training(std::slice::from_ref(&short))[0],
            ],
            &params,
        )
        .unwrap();
        assert_eq!(trained.report.drives, 1);
        assert!(matches!(
            trained.report.warnings[0],
            ModelWarning::DriveLeftOut { .. }
        ));
        let error = personalize(
            &trained.model,
            &short.0,
            None,
            &PersonalizeParams::default(),
            1,
        );
        assert!(matches!(error, Err(ModelError::DriveTooShort { .. })));
    }

    fn drive_like(drive: &Drive, rows: usize) -> Drive {
        drive.slice(0, rows).unwrap()
    }

    #[test]
    fn training_stops_when_asked_to() {
        let drives = drivers(2, 30.0);
        let mut seen = 0;
        let result = train(&training(&drives), &quick(|_| {}), 1, &mut |report| {
            seen = report.epoch;
            if report.epoch == 3 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        assert_eq!(result.unwrap_err(), ModelError::Cancelled { epoch: 3 });
        assert_eq!(seen, 3);
    }
}
