//! Drives in the seat, and the same drives again from their written lines.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod support;

use maveric_domain::{BeyondWhy, DrivenBy, Embedding, MetresPerSecond, Recording, Seconds};
use maveric_model::Model;
use maveric_seat_page::{
    Driven, Frames, Input, Keyboard, Keys, Practised, Record, RideStyle, Rider, SeatDrive,
    SeatPageError, Signal, fit, replay,
};
use maveric_simulator::Scenario;
use std::rc::Rc;
use support::model;

fn scenario(seconds: f64) -> Scenario {
    Scenario::paper().with_duration(Seconds(seconds)).unwrap()
}

/// The seat's own road, which bends all the way.
fn bending(seconds: f64) -> Scenario {
    let text = include_str!("../../../study_data/scenarios/seat.toml");
    let scenario: Scenario = toml::from_str(text).unwrap();
    scenario.with_duration(Seconds(seconds)).unwrap()
}

/// Keys as somebody presses them who keeps to the middle of `lane` at `speed`.
fn pressed(drive: &SeatDrive<'_>, lane: f64, speed: f64) -> Keys {
    let car = drive.session().car();
    let off_m = car.y_m - lane * 3.66 + 1.2 * car.heading_rad * car.speed_mps;
    Keys {
        left: off_m < -0.25,
        right: off_m > 0.25,
        faster: car.speed_mps < speed - 0.5,
        slower: car.speed_mps > speed + 0.5,
        emergency: false,
    }
}

/// Drives by keys, changing to the left lane after 8 s and back after 16, with pieces sent each second.
fn by_keys(scenario: &Scenario, seed: u64) -> (Record, Driven) {
    let mut drive = SeatDrive::by_hand(scenario, seed, DrivenBy::Scripted).unwrap();
    let mut keyboard = Keyboard::new(scenario);
    let mut record = drive.begun();
    loop {
        let seconds = drive.ticks() as f64 * 0.01;
        let lane = f64::from(u8::from((8.0..16.0).contains(&seconds)));
        let keys = pressed(&drive, lane, 27.0);
        let speed_mps = drive.session().car().speed_mps;
        let signal = if lane > 0.5 { Signal::Left } else { Signal::Off };
        let goes_on = drive.tick(keyboard.input(keys, signal, speed_mps));
        if !goes_on || drive.ticks().is_multiple_of(100) {
            record.chunks.push(drive.chunk(Frames::default()));
        }
        if !goes_on {
            break;
        }
    }
    let driven = drive.finish().unwrap();
    record.end = Some(driven.end.clone());
    (record, driven)
}

fn a_ride(scenario: &Scenario, seed: u64) -> Record {
    let settings = &scenario.settings().controllers;
    let own = Embedding::new(vec![0.2]).unwrap();
    let mut rider = Rider::new(Rc::new(model()), own, (RideStyle::Own, 0.0), settings).unwrap();
    let (dial, controllers) = (rider.dial(), rider.controllers());
    let mut drive = SeatDrive::ride(scenario, seed, &mut rider, &controllers).unwrap();
    let mut record = drive.begun();
    while drive.tick(Input::default()) {
        if drive.ticks() == 1_503 {
            dial.set(8.0);
            drive.note("dial", Some(8.0));
        }
        if drive.ticks().is_multiple_of(100) {
            record.chunks.push(drive.chunk(Frames::default()));
        }
    }
    record.end = Some(drive.finish().unwrap().end);
    record
}

#[test]
fn a_lane_is_kept_and_changed_with_keys_alone() {
    let scenario = scenario(30.0);
    let (_, driven) = by_keys(&scenario, 3);
    let ego = driven.rollout.recording.ego();
    let at = |seconds: f64| ego.y_m[(seconds * 20.0) as usize];
    assert!(at(7.9).abs() < 0.6, "{}", at(7.9));
    assert!((at(15.9) - 3.66).abs() < 0.6, "{}", at(15.9));
    assert!(at(29.0).abs() < 0.6, "{}", at(29.0));
    assert!((ego.speed_mps[500] - 27.0).abs() < 1.5);
    assert_eq!(driven.rollout.report.barrier_touches, 0);
}

#[test]
fn the_same_inputs_and_seed_give_the_same_drive_to_the_byte() {
    let scenario = scenario(40.0);
    let (record, driven) = by_keys(&scenario, 11);
    let lines = record.to_lines().unwrap();
    let read = Record::from_lines(&lines).unwrap();
    assert_eq!(read, record);
    let again = replay(&read).unwrap();
    assert!(again.same());
    assert_eq!(again.rollout.recording, driven.rollout.recording);
    // One step's steering by a thirty-thousandth is another drive.
    let mut other = record.clone();
    other.chunks[4].held[0].input.steering += 1;
    assert!(!replay(&other).unwrap().same());
    let mut other = record;
    other.header.seed += 1;
    assert!(!replay(&other).unwrap().same());
}

#[test]
fn a_ride_is_repeated_from_what_was_asked_without_its_model() {
    let record = a_ride(&scenario(40.0), 5);
    assert!(record.chunks.iter().any(|c| !c.events.is_empty()));
    let read = Record::from_lines(&record.to_lines().unwrap()).unwrap();
    assert!(replay(&read).unwrap().same());
    // The dial made it faster: what was asked did not stay.
    let asked: Vec<f64> =
        read.chunks.iter().flat_map(|c| c.asked.iter().map(|a| a.setpoints.speed_mps)).collect();
    assert!(asked.last().unwrap() > &(asked[0] + 0.5), "{asked:?}");
}

#[test]
fn a_drive_cut_short_drives_again_as_far_as_it_was_kept() {
    let (record, driven) = by_keys(&scenario(20.0), 2);
    let lines = record.to_lines().unwrap();
    // The last whole second, and half a line of the next.
    let cut: Vec<&str> = lines.split_inclusive('\n').collect();
    let text = cut[..12].concat() + &cut[12][..cut[12].len() / 2];
    let read = Record::from_lines(&text).unwrap();
    assert_eq!((read.ticks(), &read.end), (1_100, &None));
    let again = replay(&read).unwrap();
    let rows = again.rollout.recording.rows();
    assert_eq!(rows, 220);
    assert_eq!(again.rollout.recording.ego().y_m, driven.rollout.recording.ego().y_m[..rows]);
}

#[test]
fn records_that_cannot_be_are_refused_with_the_line() {
    let (record, _) = by_keys(&scenario(5.0), 2);
    let lines = record.to_lines().unwrap();
    let cut: Vec<&str> = lines.split_inclusive('\n').collect();
    let said = |text: &str| match Record::from_lines(text) {
        Err(error) => error.to_string(),
        Ok(record) => replay(&record).unwrap_err().to_string(),
    };
    let missing = [cut[0], cut[2]].concat();
    assert!(
        said(&missing).starts_with("line 2: begins at step 100, expected 0"),
        "{}",
        said(&missing)
    );
    let twice = [cut[0], cut[1], cut[1]].concat();
    assert!(said(&twice).starts_with("line 3: begins at step 0, expected 100"));
    let wild = cut[0].to_owned() + "{\"from_tick\":0,\"ticks\":1,\"held\":[[1,32000,0,0,0]]}\n";
    assert!(said(&wild).contains("expected -30000 to 30000"), "{}", said(&wild));
    let few = cut[0].to_owned() + "{\"from_tick\":0,\"ticks\":9,\"held\":[[1,0,0,0,0]]}\n";
    assert!(said(&few).contains("inputs for 1 steps, expected 9"));
    let long = cut[0].to_owned() + "{\"from_tick\":0,\"ticks\":900,\"held\":[[900,0,0,0,0]]}\n";
    assert!(said(&long).contains("after step 500"), "{}", said(&long));
    assert!(said("").contains("line 1: empty"));
    assert!(said("{}\n").starts_with("line 1: not the head of a drive"));
    let mut ride = a_ride(&scenario(5.0), 1);
    ride.chunks.truncate(3);
    ride.chunks[2].asked.clear();
    ride.end = None;
    assert!(matches!(replay(&ride), Err(SeatPageError::Record { .. })));
}

/// A drive of five minutes by hand in the right lane, long enough for a block of free road before the first vehicle ahead.
fn driven_at(speed_mps: f64) -> Recording {
    let scenario = scenario(300.0);
    let mut drive = SeatDrive::by_hand(&scenario, 9, DrivenBy::Human).unwrap();
    let mut keyboard = Keyboard::new(&scenario);
    loop {
        let keys = pressed(&drive, 0.0, speed_mps);
        let now = drive.session().car().speed_mps;
        if !drive.tick(keyboard.input(keys, Signal::Off, now)) {
            return drive.finish().unwrap().rollout.recording;
        }
    }
}

#[test]
fn a_fast_hand_is_learned_as_faster_than_a_slow_one() {
    let model = model();
    let [slow, fast] =
        [22.0, 33.0].map(|speed| fit(&model, &driven_at(speed), DrivenBy::Human).unwrap());
    assert!(slow.readings > 0 && fast.readings > 0);
    assert!(fast.embedding[0] > slow.embedding[0] + 0.5, "{slow:?} {fast:?}");
}

#[test]
fn a_style_that_reads_as_no_score_of_the_scale_has_none_and_is_beyond() {
    let driven = driven_at(27.0);
    let read = |offset: f64| {
        let mut parts = serde_json::to_value(model()).unwrap();
        parts["heads"]["linear"]["style"]["offset"] = offset.into();
        let model: Model = serde_json::from_value(parts).unwrap();
        let fit = fit(&model, &driven, DrivenBy::Human).unwrap();
        (fit.score.is_some(), fit.beyond)
    };
    assert_eq!(read(30.0), (true, None));
    for none in [-60.0, 120.0] {
        assert_eq!(read(none), (false, Some(BeyondWhy::Scale)));
    }
}

#[test]
fn a_car_off_the_road_slides_along_the_barrier_and_is_counted_once() {
    let scenario = scenario(10.0);
    let mut drive = SeatDrive::by_hand(&scenario, 1, DrivenBy::Scripted).unwrap();
    let mut keyboard = Keyboard::new(&scenario);
    let keys = Keys { right: true, ..Keys::default() };
    loop {
        let now = drive.session().car().speed_mps;
        if !drive.tick(keyboard.input(keys, Signal::Off, now)) {
            break;
        }
    }
    let driven = drive.finish().unwrap();
    let lowest = driven.rollout.recording.ego().y_m.iter().copied().fold(0.0, f64::min);
    // Half a lane and a shoulder of 3 m, less half a car.
    assert!((lowest + 3.88).abs() < 0.01, "{lowest}");
    assert!(driven.rollout.report.barrier_touches >= 1);
    let slowed = driven.rollout.recording.ego().speed_mps.last().unwrap();
    assert!(*slowed < MetresPerSecond::from_mph(50.0).0);
}

/// Drives to the end with the keys that `keys` gives; gives the longest time for which a lane was kept, the vehicles passed, and when
/// the first lane was left, in s.
fn practises(
    scenario: &Scenario,
    keys: impl Fn(&SeatDrive<'_>) -> Keys,
) -> (f64, u32, Option<f64>) {
    let mut drive = SeatDrive::by_hand(scenario, 4, DrivenBy::Scripted).unwrap();
    let mut keyboard = Keyboard::new(scenario);
    let mut practised = Practised::new(scenario);
    let (mut longest_s, mut left_s) = (0.0_f64, None);
    loop {
        let speed_mps = drive.session().car().speed_mps;
        if !drive.tick(keyboard.input(keys(&drive), Signal::Off, speed_mps)) {
            return (longest_s, practised.passes(), left_s);
        }
        practised.look(&drive);
        longest_s = longest_s.max(practised.kept_s());
        if drive.session().car().y_m.abs() > 0.88 {
            left_s.get_or_insert(drive.ticks() as f64 * 0.01);
        }
    }
}

#[test]
fn hands_off_the_car_leaves_its_lane_within_seconds_and_nothing_is_practised() {
    let nobody = |_: &SeatDrive<'_>| Keys::default();
    let (kept_s, _, left_s) = practises(&bending(300.0), nobody);
    let left_s = left_s.unwrap();
    // As docs/seat.md says.
    assert!((6.3..6.5).contains(&left_s), "{left_s}");
    assert!(kept_s.abs() < 1e-12, "{kept_s}");
    // A tap at the start, and then nothing, is no practice either.
    let taps = |drive: &SeatDrive<'_>| Keys { left: drive.ticks() < 10, ..Keys::default() };
    let (kept_s, _, _) = practises(&bending(300.0), taps);
    assert!((0.0..15.0).contains(&kept_s), "{kept_s}");
    // On a straight road the car stays where it is, and that is nobody's doing.
    let (kept_s, _, left_s) = practises(&scenario(60.0), nobody);
    assert!(kept_s.abs() < 1e-12 && left_s.is_none(), "{kept_s}");
}

#[test]
fn by_hands_a_lane_is_kept_in_the_bends_and_somebody_is_passed() {
    let keeps = |drive: &SeatDrive<'_>| pressed(drive, 0.0, 25.0);
    let (kept_s, _, left_s) = practises(&bending(120.0), keeps);
    assert!(kept_s > 60.0 && left_s.is_none(), "{kept_s} {left_s:?}");
    // In the left lane, faster than the first vehicle ahead.
    let passes = |drive: &SeatDrive<'_>| {
        let seconds = drive.ticks() as f64 * 0.01;
        pressed(drive, f64::from(u8::from(seconds > 35.0)), 27.0)
    };
    let (_, passed, _) = practises(&bending(300.0), passes);
    assert!(passed >= 1, "{passed}");
}

#[test]
fn somebody_is_about_from_the_first_second_on() {
    let near = |scenario: &Scenario| {
        let mut drive = SeatDrive::by_hand(scenario, 4, DrivenBy::Scripted).unwrap();
        for _ in 0..100 {
            assert!(drive.tick(Input::default()));
        }
        let scene = drive.session().scene();
        let near = |x_m: f64| (x_m - scene.ego.x_m).abs() < 100.0;
        scene.vehicles.iter().filter(|v| near(v.x_m)).count()
    };
    assert_eq!((near(&bending(60.0)), near(&scenario(60.0))), (2, 0));
}

#[test]
fn a_ride_keeps_its_lane_in_the_bends_and_both_drive_again_to_the_byte() {
    let scenario = bending(240.0);
    let ride = a_ride(&scenario, 5);
    let again = replay(&ride).unwrap();
    assert!(again.same());
    let ego = again.rollout.recording.ego();
    let beside = |y_m: f64| (y_m - 3.66 * (y_m / 3.66).round()).abs();
    let off_lane = ego.y_m.iter().filter(|y| beside(**y) > 0.15).count();
    // What is left is its changes of lane, a few seconds each.
    let changes = again.rollout.report.started_changes;
    assert!(off_lane <= 120 * changes as usize, "{off_lane} {changes}");
    assert_eq!(again.rollout.report.collisions, 0);
    let (record, driven) = by_keys(&bending(60.0), 11);
    let again = replay(&record).unwrap();
    assert!(again.same());
    assert_eq!(again.rollout.recording, driven.rollout.recording);
    // Another seed is other traffic on the same road.
    let (other, _) = by_keys(&bending(60.0), 12);
    assert_ne!(other.end, record.end);
}
