use super::*;
use crate::{epochs::EpochReport, error::ModelWarning, losses::Loss};
use crate::{
    losses::MutualInformationLoss,
    model_file,
    personalize::personalize,
    style_space::{LinearHead, PerpendicularEllipse, share_outside_training},
    test_drives::{Habits, drive, drivers, drivers_apart},
};
use maveric_domain::{
    Drive, DriveMeta, DrivenBy, EgoTrack, Embedding, Recording, Road, ScoreRange, Sees, StyleScore,
};
use std::ops::ControlFlow;

fn training(drives: &[(Drive, StyleScore)]) -> Vec<TrainingDrive<'_>> {
    drives.iter().map(TrainingDrive::from).collect()
}

fn quick(change: impl Fn(&mut TrainSettings)) -> TrainSettings {
    let mut settings = TrainSettings {
        heads: HeadsKind::Paper,
        epochs: 25,
        batch_size: 128,
        validation_fraction: 0.0,
        ..TrainSettings::default()
    };
    change(&mut settings);
    settings
}

fn run(drives: &[TrainingDrive<'_>], settings: &TrainSettings) -> Result<Trained, ModelError> {
    train(drives, settings, 1, &mut |_| ControlFlow::Continue(()))
}

/// The model that is learned from drives with their scores.
pub(crate) fn trained(drives: &[(Drive, StyleScore)], settings: &TrainSettings) -> Model {
    run(&training(drives), settings).unwrap().model
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

fn assert_left_out(report: &NetworkReport, expected: &[Loss]) {
    let losses = report.left_out.iter().map(|l| l.split_once(": ").unwrap().0);
    assert!(losses.eq(expected.iter().map(ToString::to_string)), "{:?}", report.left_out);
}

#[test]
fn losses_fall_and_drivers_are_ordered_by_their_style() {
    let drives = drivers(8, 240.0);
    let trained = run(&training(&drives), &quick(|_| {})).unwrap();
    let epochs = &networks(&trained).epochs;
    let [first, last] = [epochs[0], epochs[epochs.len() - 1]];
    assert!(last.total < 0.5 * first.total, "{first:?} {last:?}");
    assert!(networks(&trained).left_out.is_empty());
    let axis = LinearHead::aggression(&trained.model).unwrap();
    let positions: Vec<f64> =
        trained.embeddings.iter().map(|(_, w)| axis.position(w).unwrap()).collect();
    assert!(ordered(&positions) > 0.9, "{positions:?}");

    // New drivers between the old ones, fitted without their scores, fall between them.
    let new: Vec<f64> = (0..5)
        .map(|i| {
            let a = 0.1 + 0.2 * f64::from(i);
            let habits =
                Habits { speed_mps: 26.0 + 8.0 * a, time_gap_s: 2.2 - 1.2 * a, passes: true };
            let drive = drive(&format!("N{i}"), &habits, 200.0);
            let fit = personalize(&trained.model, &drive, None).unwrap();
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
        let read = |w| axis.read(w).unwrap();
        assert!((read(&moved.embedding) - read(w)).abs() < 1e-5);
    }
    let far = Embedding::new(vec![50.0; 3]).unwrap();
    let three = [w.clone(), w.clone(), far];
    let share = share_outside_training(&trained.model, &three).unwrap();
    assert!((share.unwrap() - 1.0 / 3.0).abs() < 1e-12);
    assert_eq!(share_outside_training(&trained.model, &[]).unwrap(), None);
}

#[test]
fn linear_heads_drive_alike_at_every_seed_and_those_of_other_people_do_not() {
    let people = drivers_apart(6, 240.0);
    let learned = |people: &[(Drive, StyleScore)], seed| {
        let settings = TrainSettings::default();
        let trained = train(&training(people), &settings, seed, &mut |_| ControlFlow::Continue(()));
        trained.unwrap().model
    };
    let (one, two) = (learned(&people, 1), learned(&people, 2));
    assert_ne!(one, two, "how sure S is was drawn anew");
    assert!(one.drives_as(&two));
    assert!(!one.drives_as(&learned(&people[..5], 1)));
}

#[test]
fn one_seed_gives_the_same_bytes_for_one_and_two_threads() {
    let drives = drivers(3, 60.0);
    let params = quick(|s| s.epochs = 2);
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let trained = run(&training(&drives), &params).unwrap();
            let fit = personalize(&trained.model, &drives[0].0, Some(drives[0].1));
            (model_file::to_bytes(&trained.model).unwrap(), fit.unwrap())
        })
    };
    assert!(bytes(1) == bytes(2));
}

#[test]
fn embeddings_are_whitened_over_the_training_drives() {
    let drives = drivers(4, 90.0);
    let model = run(&training(&drives), &quick(|s| s.epochs = 4)).unwrap().model;
    let (mean, covariance) = crate::linear_algebra::moments(&model.points(), 3);
    assert!(mean.norm() < 1e-6);
    assert!((covariance - nalgebra::DMatrix::identity(3, 3)).norm() < 1e-6);
}

#[test]
fn a_loss_without_data_is_left_out_and_reported() {
    let habits = Habits { speed_mps: 30.0, time_gap_s: 1.5, passes: false };
    let alone = drive("P1", &habits, 60.0);
    let given = [TrainingDrive { drive: &alone, adb: None }];
    let trained = run(&given, &quick(|s| s.epochs = 2)).unwrap();
    assert_left_out(networks(&trained), &[Loss::LaneChange, Loss::Aggression]);
    assert_eq!(trained.report.warnings.len(), 3);
    assert!(matches!(LinearHead::aggression(&trained.model), Err(ModelError::NoAggressionAxis)));
}

#[test]
fn a_drive_that_never_meets_anyone_teaches_speed_alone() {
    let habits = Habits { speed_mps: 30.0, time_gap_s: 1.5, passes: true };
    // The first lead comes after ten seconds.
    let alone = drive("P1", &habits, 9.0);
    let given = [TrainingDrive { drive: &alone, adb: Some(ScoreRange::ADB.score(30.0).unwrap()) }];
    let report = run(&given, &quick(|s| s.epochs = 2)).unwrap().report;
    let networks = report.networks.unwrap();
    // One score orders nobody.
    let expected = [Loss::FollowingDistance, Loss::LaneChange, Loss::Aggression];
    assert_left_out(&networks, &expected);
    assert!(matches!(report.warnings[0], ModelWarning::OneDriver { .. }));
    assert_eq!(networks.quality.lane_change, None);
    assert_eq!(networks.quality.following_distance_m, None);
    assert!(networks.quality.speed_mps.unwrap().rmse.is_finite());
}

#[test]
fn people_are_kept_back_and_the_networks_that_drive_learn_from_them_too() {
    let drives = drivers(6, 120.0);
    let with = |change: &dyn Fn(&mut TrainSettings)| {
        let settings = quick(|s| {
            s.epochs = 8;
            s.validation_fraction = 0.2;
            change(s);
        });
        run(&training(&drives), &settings).unwrap()
    };
    let found = with(&|_| {});
    let selection = networks(&found).selection.clone().unwrap();
    assert_eq!((selection.people, found.report.drives), (1, 6));
    let totals: Vec<f64> = selection.epochs.iter().map(|e| e.validation_total.unwrap()).collect();
    let best = (0..8).min_by(|&a, &b| totals[a].total_cmp(&totals[b])).unwrap();
    assert_eq!(selection.kept_epoch, best + 1);
    assert_eq!(networks(&found).epochs.len(), best + 1);
    // A third of one drive of two minutes.
    assert!((40..60).contains(&selection.quality.rows), "{}", selection.quality.rows);
    assert!(networks(&found).quality.rows == networks(&found).rows);
    let speed = [selection.networks, selection.own_means].map(|h| h.speed_mps.unwrap());
    assert!(speed.iter().all(|e| (0.0..20.0).contains(e)), "{speed:?}");
    let rmse = selection.quality.speed_mps.as_ref().unwrap().rmse;
    assert!((rmse - speed[0]).abs() < 1e-9);

    // The model is that of a run of as many epochs that keeps nobody back.
    let plain = with(&|s| {
        s.validation_fraction = 0.0;
        s.epochs = best + 1;
    });
    assert_eq!(plain.embeddings, found.embeddings);
    assert_eq!(networks(&plain).selection, None);
    // Nobody can be kept back of two.
    let two = run(&training(&drives[..2]), &quick(|s| s.validation_fraction = 0.5)).unwrap();
    assert_eq!(networks(&two).selection, None);
}

#[test]
fn a_loss_that_does_not_fall_for_people_kept_back_stops_the_run() {
    let drives = drivers(5, 90.0);
    // A rate so high that the loss on new people soon rises.
    let settings = quick(|s| {
        s.epochs = 60;
        s.validation_fraction = 0.3;
        s.patience = 2;
        s.learning_rate = 0.03;
    });
    let report = run(&training(&drives), &settings).unwrap().report;
    let selection = report.networks.unwrap().selection.unwrap();
    assert!(selection.stopped_early);
    assert_eq!(selection.epochs.len(), selection.kept_epoch + 2);
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
    for loss in [MutualInformationLoss::MeanSquared, MutualInformationLoss::GaussianLikelihood] {
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
    assert!(matches!(run(&given, &params), Err(ModelError::DuplicateDrive { .. })));
    assert!(matches!(run(&[], &params), Err(ModelError::NoDrives { given: 0, .. })));
    let trained =
        run(&[training(&drives)[1], training(std::slice::from_ref(&short))[0]], &params).unwrap();
    assert_eq!(trained.report.drives, 1);
    assert!(matches!(trained.report.warnings[0], ModelWarning::DriveLeftOut { .. }));
    let error = personalize(&trained.model, &short.0, None);
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
        if report.epoch == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(result.unwrap_err(), ModelError::Cancelled { epoch: 3 });
    assert_eq!(seen, 3);
}

/// A drive whose rig sees neither other vehicles nor lanes.
fn speed_alone(who: usize) -> (Drive, StyleScore) {
    let (rows, rate_hz) = (1200, 20.0);
    let mut ego = EgoTrack::default();
    let mut x = 0.0;
    for row in 0..rows {
        let v = 25.0 + who as f64 + (0.01 * row as f64 * (1.0 + who as f64)).sin();
        x += v / rate_hz;
        ego.x_m.push(x);
        ego.y_m.push(0.0);
        ego.speed_mps.push(v);
    }
    let time_s = (0..rows).map(|row| row as f64 / rate_hz).collect();
    let recording = Recording::new(Road::PAPER, rate_hz, time_s, vec![0; rows], ego, Vec::new());
    let name = format!("P{who}");
    let meta = DriveMeta::named(format!("{name}-own"), name, "own", DrivenBy::Human).unwrap();
    let drive = Drive::from_recording(meta, &recording.unwrap()).unwrap();
    let score = ScoreRange::ADB.score(20.0 + 5.0 * who as f64).unwrap();
    (drive.without_lateral().seen_by(Sees::NOTHING), score)
}

#[test]
fn networks_of_speed_alone_are_a_model_that_can_be_read() {
    let drives: Vec<_> = (0..4).map(speed_alone).collect();
    let trained = run(&training(&drives), &quick(|s| s.epochs = 2)).unwrap();
    let bytes = model_file::to_bytes(&trained.model).unwrap();
    assert_eq!(model_file::from_bytes(&bytes).unwrap(), trained.model);
    let known = personalize(&trained.model, &drives[0].0, None).unwrap();
    assert_eq!(known.support, None);
}
