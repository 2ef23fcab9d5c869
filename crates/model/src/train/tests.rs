use super::*;
use crate::{
    losses::MutualInformationLoss,
    model_file,
    params::PersonalizeParams,
    personalize::{NetworkRows, personalize},
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
        heads: HeadsKind::Paper,
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

fn networks(trained: &Trained) -> &NetworkReport {
    trained.report.networks.as_ref().unwrap()
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
    let epochs = &networks(&trained).epochs;
    let [first, last] = [epochs[0], epochs[epochs.len() - 1]];
    assert!(last.total < 0.5 * first.total, "{first:?} {last:?}");
    assert!(networks(&trained).left_out.is_empty());
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
            let fit = personalize(&trained.model, &drive, None, &params).unwrap();
            assert!(!fit.used_adb && fit.standard_error().unwrap().iter().all(|e| *e > 0.0));
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
            );
            (model_file::to_bytes(&trained.model).unwrap(), fit.unwrap())
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
        let losses = |model: &Model| {
            let paper = model.paper().unwrap();
            let rows = rows_of(drive, &paper.row_settings(), 1.0).unwrap();
            let w = model.training()[index].embedding.coordinates().to_vec();
            let rows = NetworkRows::new(paper, &rows, Some(adb.points()));
            let mut all = rows.losses(&w).map(|l| l.unwrap_or(0.0)).to_vec();
            all.push(rows.objective(&w));
            all
        };
        for (a, b) in losses(&raw).iter().zip(losses(&white)) {
            assert!((a - b).abs() < 1e-4 * (1.0 + a.abs()), "{a} {b}");
        }
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
    let left_out: Vec<Loss> = networks(&trained)
        .left_out
        .iter()
        .map(|(l, _)| *l)
        .collect();
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
    let networks = report.networks.unwrap();
    let left_out: Vec<Loss> = networks.left_out.iter().map(|(l, _)| *l).collect();
    // One score orders nobody.
    let expected = [Loss::FollowingDistance, Loss::LaneChange, Loss::Aggression];
    assert_eq!(left_out, expected);
    assert!(matches!(report.warnings[0], ModelWarning::OneDriver { .. }));
    assert_eq!(networks.quality.lane_change, None);
    assert_eq!(networks.quality.following_distance_m, None);
    assert!(networks.quality.speed_mps.unwrap().rmse.is_finite());
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
    let selection = networks(&refitted).selection.clone().unwrap();
    assert_eq!(selection.kept_epoch, 8);
    assert!(!selection.stopped_early);
    let rows = selection.training_rows + selection.validation_rows;
    assert_eq!(rows, networks(&refitted).rows);
    let share = selection.validation_rows as f64 / rows as f64;
    assert!((share - 0.2).abs() < 0.01, "{share}");
    assert!(selection.epochs.iter().all(|e| e.validation.is_some()));
    assert_eq!(selection.quality.on, RowsOf::Validation);
    assert_eq!(selection.quality.rows, selection.validation_rows);
    assert_eq!(networks(&refitted).quality.on, RowsOf::Training);
    let calibration = networks(&refitted).quality.lane_change.as_ref().unwrap();
    assert!((0.0..0.2).contains(&calibration.expected_calibration_error));

    // Measuring does not change the model.
    let plain = with(&|s| s.validation_fraction = 0.0);
    let numbers = |t: &Trained| t.embeddings.clone();
    assert_eq!(numbers(&plain), numbers(&refitted));
    // The model of the run itself is another one; what is said of it is said of the one that drives.
    let kept = with(&|s| s.refit = false);
    assert_eq!(networks(&kept).quality.on, RowsOf::Training);
    assert_eq!(networks(&kept).quality.rows, selection.training_rows);
    assert_eq!(networks(&kept).rows, selection.training_rows);
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
    let selection = report.networks.unwrap().selection.unwrap();
    assert!(selection.stopped_early);
    let totals = selection.epochs.iter().map(|e| e.validation_total.unwrap());
    let totals: Vec<f64> = totals.collect();
    let best = (0..totals.len()).min_by(|&a, &b| totals[a].total_cmp(&totals[b]));
    assert_eq!(best.unwrap() + 1, selection.kept_epoch);
    assert_eq!(totals.len(), selection.kept_epoch + 2);
}

#[test]
fn the_bound_says_something_under_both_readings_of_m() {
    let drives = drivers(6, 120.0);
    let bound = |loss| {
        let params = quick(|s| {
            s.mutual_information_loss = loss;
            s.batch_size = 64;
        });
        let trained = run(&training(&drives), &params).unwrap();
        let epochs = &networks(&trained).epochs;
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
