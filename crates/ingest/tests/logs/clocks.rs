//! Clocks that run backwards, differ, stand still or start anew.

use super::{
    ROWS, bytes_of,
    damage::read,
    mapped::{read_named, shipped},
    recording,
};
use maveric_domain::Recording;
use maveric_ingest::{Ingested, WarningKind};
use mcap::WriteOptions;
use std::{collections::BTreeSet, fmt::Write as _};

const MINUTE: u64 = 60_000_000_000;
const SECOND: u64 = 1_000_000_000;

/// Time of receipt and stamp of a message, from its time and whether it is ego's.
type Clock<'a> = &'a dyn Fn(u64, bool) -> (u64, u64);

fn with(bytes: &[u8], time: Clock<'_>) -> Vec<u8> {
    super::rewritten(bytes, WriteOptions::new(), |mut message| {
        let ego = message.channel.topic.ends_with("odometry");
        let (log, stamp) = time(message.log_time, ego);
        message.log_time = log;
        let data = message.data.to_mut();
        data[4..8].copy_from_slice(&((stamp / SECOND) as u32).to_le_bytes());
        data[8..12].copy_from_slice(&((stamp % SECOND) as u32).to_le_bytes());
        Some(message)
    })
}

fn kinds(found: &Ingested) -> Vec<WarningKind> {
    found.warnings.iter().map(|w| w.kind).collect()
}

/// Ego's positions and speeds, to the bit.
fn samples(recording: &Recording) -> BTreeSet<[u64; 3]> {
    let ego = recording.ego();
    let of = |i: usize| [ego.x_m[i], ego.y_m[i], ego.speed_mps[i]].map(f64::to_bits);
    (0..recording.rows()).map(of).collect()
}

#[test]
fn clocks_that_run_backwards_differ_or_stand_still_make_no_false_drive() {
    let bytes = bytes_of(&recording(false));
    let whole = read(&bytes, false).unwrap().recording;
    let with = |time: Clock<'_>| with(&bytes, time);
    // The file is written backwards: sorted.
    let found = read(&with(&|t, _| (MINUTE - t, MINUTE - t)), false).unwrap();
    assert!(kinds(&found).contains(&WarningKind::OutOfOrder));
    assert_eq!(found.recording.rows(), ROWS);
    // The clock of the stamps is set back half way, and receipt goes on.
    let found = read(&with(&|t, _| (t, t % (MINUTE / 2))), false).unwrap();
    assert!(kinds(&found).contains(&WarningKind::ReceiveTime), "{:?}", found.warnings);
    assert_eq!(samples(&found.recording), samples(&whole));
    // Ego by simulated time, the others by the wall clock.
    let wall = 1_700_000_000_000_000_000;
    let found = read(&with(&|t, ego| (wall + t, if ego { t } else { wall + t })), false).unwrap();
    assert!(kinds(&found).contains(&WarningKind::ReceiveTime), "{:?}", found.warnings);
    assert_eq!(found.recording.others().len(), whole.others().len());
    // No stamps at all.
    let found = read(&with(&|t, _| (t, 0)), false).unwrap();
    assert!(kinds(&found).contains(&WarningKind::ReceiveTime));
    assert_eq!(found.recording.rows(), ROWS);
}

/// Every row of the second piece is one of the whole's, at its distance from the piece's start.
fn two_pieces(found: &Ingested, second: usize) {
    assert!(kinds(found).contains(&WarningKind::ClockRestart), "{:?}", found.warnings);
    let whole = recording(false);
    let recording = &found.recording;
    assert_eq!(recording.rows(), ROWS);
    let segments = recording.segment();
    let begins = segments.iter().position(|s| *s == 1).unwrap();
    assert_eq!(begins, second);
    assert!(segments[begins..].iter().all(|s| *s == 1));
    // In order, to the bit, and nothing between the pieces.
    let (ego, of_whole) = (recording.ego(), whole.ego());
    assert!((0..ROWS).all(|i| ego.speed_mps[i].to_bits() == of_whole.speed_mps[i].to_bits()));
    let time = recording.time_s();
    assert!(time[begins] - time[begins - 1] > 0.5);
    assert!((time[ROWS - 1] - time[begins] - 0.05 * (ROWS - 1 - second) as f64).abs() < 1e-6);
    // The others stay beside the ego that they were seen with.
    for track in recording.others() {
        let rows = track.first_row..track.first_row + track.x_m.len();
        assert!(rows.end <= begins || rows.start >= begins, "{rows:?}");
        for (x_m, row) in track.x_m.iter().zip(rows) {
            let seen = whole.others().iter().any(|t| {
                t.id == track.id
                    && row.checked_sub(t.first_row).and_then(|i| t.x_m.get(i)) == Some(x_m)
            });
            assert!(seen, "row {row}: {x_m}");
        }
    }
}

#[test]
fn a_clock_that_starts_anew_within_a_recording_makes_two_segments() {
    let bytes = bytes_of(&recording(false));
    // Simulated time begins again after 40 s, for stamps and receipt alike.
    let anew = |t: u64, _: bool| (t % (40 * SECOND), t % (40 * SECOND));
    two_pieces(&read(&with(&bytes, &anew), false).unwrap(), 800);
    // Receipt goes on, but the world began anew: ego is elsewhere.
    let elsewhere = super::rewritten(&bytes, WriteOptions::new(), |message| {
        let late = message.log_time >= 40 * SECOND;
        let keep = message.channel.topic.ends_with("odometry");
        let mut message = keep.then_some(message)?;
        if late {
            let data = message.data.to_mut();
            let stamp = message.log_time - 40 * SECOND;
            data[4..8].copy_from_slice(&((stamp / SECOND) as u32).to_le_bytes());
            data[8..12].copy_from_slice(&((stamp % SECOND) as u32).to_le_bytes());
            // Behind the encapsulation a stamp and two names come first, then the position, aligned.
            let x = data.len() - 2 * (36 * 8) - 6 * 8 - 7 * 8;
            data[x..x + 8].copy_from_slice(&(5000.0 + stamp as f64 / 1e8).to_le_bytes());
        }
        Some(message)
    });
    let found = read(&elsewhere, false).unwrap();
    assert!(kinds(&found).contains(&WarningKind::ClockRestart), "{:?}", found.warnings);
    let segments = found.recording.segment();
    assert_eq!(segments.iter().filter(|s| **s == 1).count(), 400);
}

#[test]
fn a_table_whose_time_starts_anew_makes_two_segments_and_is_not_shuffled() {
    let mut text = "t,x_follower,v_follower,v_leader,leader_length,spacing\n".to_owned();
    for i in 0..300 {
        let (t, v) = (f64::from(i % 200) / 10.0, if i < 200 { 20.0 } else { 5.0 });
        writeln!(text, "{t},{},{v},20,0,30", 2.0 * f64::from(i)).unwrap();
    }
    let found = read_named("oa_pair_r_f2_c.csv", &text, shipped("openacc.toml")).unwrap().remove(0);
    assert!(kinds(&found).contains(&WarningKind::ClockRestart));
    let (segments, ego) = (found.recording.segment(), found.recording.ego());
    let slow = segments.iter().filter(|s| **s == 1).count();
    assert_eq!(slow, 100);
    let fits = |(v, s): (&f64, &u32)| (v - if *s == 0 { 20.0 } else { 5.0 }).abs() < 1e-9;
    assert!(ego.speed_mps.iter().zip(segments).all(fits));
}

#[test]
fn message_with_an_unset_stamp_is_skipped_and_counted() {
    let bytes = bytes_of(&recording(false));
    let wall = 1_700_000_000_000_000_000;
    let minus_one = u64::from(u32::MAX) * SECOND;
    for (stamp, ego_only) in [(0, true), (minus_one, true), (0, false)] {
        for at in [0, 20 * SECOND, 59_950_000_000] {
            let bad = |t: u64, ego: bool| t == at && ego == ego_only;
            let time = |t: u64, ego: bool| (wall + t, if bad(t, ego) { stamp } else { wall + t });
            let found = read(&with(&bytes, &time), false).unwrap();
            let skipped =
                |w: &&maveric_ingest::Warning| w.what.contains("header stamp is more than a day");
            let count: Vec<usize> =
                found.warnings.iter().filter(skipped).map(|w| w.count).collect();
            assert_eq!(count, [1], "{stamp} {at}: {:?}", found.warnings);
            let lost = usize::from(at != 20 * SECOND);
            assert_eq!(found.recording.rows(), ROWS - lost, "{stamp} {at}");
            assert_eq!(found.recording.segment().last(), Some(&0));
        }
    }
}
