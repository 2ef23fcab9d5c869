use super::*;
use crate::{
    checkpoint,
    losses::MutualInformationLoss,
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
        validation_fraction: 0.0,
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
            let (sums, l4) = Fit::new(&frozen, &rows, Some(*adb)).sums(&w);
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
    assert_eq!(trained.report.warnings.len(), 3);
    assert!(matches!(
        AggressionAxis::of(&trained.model),
        Err(ModelError::NoAggressionAxis)
    ));
}

#[test]
fn a_drive_that_never_meets_anyone_teaches_speed_alone() {
    let habits = Habits {
        speed_mps: 30.0,
        time_gap_s: 1.5,
        passes: true,
    };
    // The first lead comes after ten seconds.
    let alone = drive("P1", &habits, 9.0);
    let given = [TrainingDrive {
        drive: &alone,
        adb: Some(AdbScore::new(30.0).unwrap()),
    }];
    let report = run(&given, &quick(|s| s.epochs = 2)).unwrap().report;
    let left_out: Vec<Loss> = report.left_out.iter().map(|(l, _)| *l).collect();
    // One score orders nobody.
    let expected = [Loss::FollowingDistance, Loss::LaneChange, Loss::Aggression];
    assert_eq!(left_out, expected);
    assert!(matches!(report.warnings[0], ModelWarning::OneDriver { .. }));
    assert_eq!(report.quality.lane_change, None);
    assert_eq!(report.quality.following_distance_m, None);
    assert!(report.quality.speed_mps.unwrap().rmse.is_finite());
}

#[test]
fn rows_kept_back_are_measured_and_then_learned_from() {
    let drives = drivers(4, 120.0);
    let with = |change: &dyn Fn(&mut TrainSettings)| {
        run(
            &training(&drives),
            &quick(|s| {
                s.epochs = 8;
                s.validation_fraction = 0.2;
                change(s);
            }),
        )
        .unwrap()
    };
    let refitted = with(&|_| {});
    let selection = refitted.report.selection.clone().unwrap();
    assert_eq!(selection.kept_epoch, 8);
    assert!(!selection.stopped_early);
    let rows = selection.training_rows + selection.validation_rows;
    assert_eq!(rows, refitted.report.rows);
    let share = selection.validation_rows as f64 / rows as f64;
    assert!((share - 0.2).abs() < 0.01, "{share}");
    assert!(selection.epochs.iter().all(|e| e.validation.is_some()));
    assert_eq!(selection.quality.on, RowsOf::Validation);
    assert_eq!(selection.quality.rows, selection.validation_rows);
    assert_eq!(refitted.report.quality.on, RowsOf::Training);
    let calibration = refitted.report.quality.lane_change.as_ref().unwrap();
    assert!((0.0..0.2).contains(&calibration.expected_calibration_error));

    // Measuring does not change the model.
    let plain = with(&|s| s.validation_fraction = 0.0);
    let numbers = |t: &Trained| t.embeddings.clone();
    assert_eq!(numbers(&plain), numbers(&refitted));
    // The model of the run itself is another one, and is judged by the rows it has not seen.
    let kept = with(&|s| s.refit = false);
    assert_eq!(kept.report.quality.on, RowsOf::Validation);
    assert_eq!(kept.report.rows, selection.training_rows);
    assert_ne!(numbers(&kept), numbers(&refitted));
}

#[test]
fn a_loss_that_rises_stops_the_run_and_the_best_epoch_counts() {
    let drives = drivers(3, 90.0);
    // A rate so high that the loss on new rows soon rises.
    let params = quick(|s| {
        s.epochs = 60;
        s.validation_fraction = 0.3;
        s.patience = 2;
        s.learning_rate = 0.02;
        s.refit = false;
    });
    let report = run(&training(&drives), &params).unwrap().report;
    let selection = report.selection.unwrap();
    assert!(selection.stopped_early);
    let totals = selection.epochs.iter().map(|e| e.validation_total.unwrap());
    let totals: Vec<f64> = totals.collect();
    let best = (0..totals.len()).min_by(|&a, &b| totals[a].total_cmp(&totals[b]));
    assert_eq!(best.unwrap() + 1, selection.kept_epoch);
    assert_eq!(totals.len(), selection.kept_epoch + 2);
}

#[test]
fn a_training_that_goes_on_gives_the_bytes_of_one_never_stopped() {
    let drives = drivers(3, 60.0);
    let params = quick(|s| {
        s.epochs = 5;
        s.validation_fraction = 0.2;
        s.patience = 3;
    });
    let given = training(&drives);
    let whole = run(&given, &params).unwrap();
    // Stopped in the run with validation, and in the one after it.
    for stop_after in [2, 7] {
        let mut seen = 0;
        let mut kept = Vec::new();
        let checkpoints = Checkpoints {
            resume: None,
            every: 2,
            save: &mut |state| {
                kept.push(state.to_bytes().unwrap());
                ControlFlow::Continue(())
            },
        };
        let stopped = train_resumable(&given, &params, 1, checkpoints, &mut |_| {
            seen += 1;
            if seen == stop_after {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        assert!(matches!(stopped, Err(ModelError::Cancelled { .. })));
        for bytes in &kept {
            let mut saved = 0;
            let checkpoints = Checkpoints {
                resume: Some(TrainingState::from_bytes(bytes).unwrap()),
                every: 1,
                save: &mut |_| {
                    saved += 1;
                    ControlFlow::Continue(())
                },
            };
            let go_on = &mut |_: &_| ControlFlow::Continue(());
            let resumed = train_resumable(&given, &params, 1, checkpoints, go_on).unwrap();
            assert!(saved > 0);
            assert_eq!(resumed.report, whole.report);
            assert!(
                checkpoint::to_bytes(&resumed.model).unwrap()
                    == checkpoint::to_bytes(&whole.model).unwrap()
            );
        }
        // Another seed is another training; damage of any kind is noticed.
        let last = kept.last().unwrap();
        let checkpoints = Checkpoints {
            resume: Some(TrainingState::from_bytes(last).unwrap()),
            every: 0,
            save: &mut |_| ControlFlow::Continue(()),
        };
        let other = train_resumable(&given, &params, 2, checkpoints, &mut |_| {
            ControlFlow::Continue(())
        });
        assert!(matches!(other, Err(ModelError::BadCheckpoint { .. })));
        for at in (0..last.len()).step_by(last.len() / 40).chain(0..20) {
            let mut bad = last.clone();
            bad[at] ^= 0x04;
            let error = TrainingState::from_bytes(&bad).unwrap_err();
            assert!(error.suggestion().unwrap().contains("--resume"), "{at}");
            assert!(TrainingState::from_bytes(&last[..at]).is_err());
        }
    }
}

#[test]
fn the_bound_says_something_under_both_readings_of_m() {
    let drives = drivers(6, 120.0);
    let bound = |loss| {
        let params = quick(|s| {
            s.mutual_information_loss = loss;
            s.batch_size = 64;
        });
        let epochs = run(&training(&drives), &params).unwrap().report.epochs;
        let of = |e: &EpochReport| e.losses.mutual_information_bound.unwrap();
        (of(&epochs[0]), of(&epochs[epochs.len() - 1]))
    };
    for loss in [
        MutualInformationLoss::MeanSquared,
        MutualInformationLoss::GaussianLikelihood,
    ] {
        let (first, last) = bound(loss);
        // It grows from about nothing to what tells drivers apart.
        assert!(first < last && last > 0.3, "{loss:?}: {first} {last}");
        assert!(last < 12.0, "{loss:?}: {last}");
    }
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
