//! Whole logs in, recordings out: our own and damaged copies of them.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod clocks;
mod damage;
mod decisions;
mod fuzz;
mod lanes;
mod layouts;
mod mapped;
mod other_files;
mod others;
mod proposals;
mod rig_tables;
mod rigs;
mod round_trip;
mod simulators;
mod split;
mod tables;
mod unknown_leaders;
mod unseen;

use maveric_domain::{DriveMeta, DrivenBy, EgoTrack, ObjectTrack, Recording, Road, VehicleId};
use maveric_ingest::write_mcap;
use mcap::{Message, MessageStream, WriteOptions, read::LinearReader, records::Record};
use std::io::Cursor;

/// Rows of a minute at 20 Hz.
const ROWS: usize = 1200;

fn meta() -> DriveMeta {
    DriveMeta::named("S2P07-mimic", "S2P07", "mimic", DrivenBy::Automated).unwrap()
}

/// A minute with a lane change, standstill, a lead vehicle that leaves and returns, and a hole in time.
fn recording(hole: bool) -> Recording {
    let shift = |row: usize| if hole && row >= 700 { 2.0 } else { 0.0 };
    let time_s: Vec<f64> = (0..ROWS).map(|i| i as f64 / 20.0 + shift(i)).collect();
    let speed = |t: f64| (25.0 - 0.5 * t).max(0.0) + 0.1 * (7.0 * t).sin().abs();
    let way = |t: f64| {
        let braking = t.min(50.0);
        25.0 * braking - 0.25 * braking * braking + 0.06 * t
    };
    let ego = EgoTrack {
        length_m: 4.83,
        x_m: time_s.iter().map(|&t| way(t)).collect(),
        y_m: time_s.iter().map(|t| 3.66 / (1.0 + (20.0 - t).exp())).collect(),
        speed_mps: time_s.iter().map(|&t| speed(t)).collect(),
    };
    let track = |id, first_row: usize, last_row: usize| {
        let t = &time_s[first_row..last_row];
        ObjectTrack {
            id: VehicleId(id),
            length_m: 4.5 + f64::from(id),
            first_row,
            x_m: t.iter().map(|t| 60.0 + 23.1 * t).collect(),
            y_m: t.iter().map(|t| 0.01 * t.cos()).collect(),
            speed_mps: t.iter().map(|t| 23.1 + 0.2 * t.sin()).collect(),
        }
    };
    let others = vec![track(3, 0, 300), track(8, 100, ROWS), track(3, 500, 650)];
    let segment = (0..ROWS).map(|i| u32::from(hole && i >= 700)).collect();
    let others = if hole { others[..1].to_vec() } else { others };
    Recording::new(Road::PAPER, 20.0, time_s, segment, ego, others).unwrap()
}

fn bytes_of(recording: &Recording) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    write_mcap(recording, &meta(), &mut out).unwrap();
    out.into_inner()
}

/// The first rows of a recording, without the others.
fn first_rows(rows: usize) -> Recording {
    let whole = recording(false);
    let head = |values: &[f64]| values[..rows].to_vec();
    let ego = EgoTrack {
        length_m: whole.ego().length_m,
        x_m: head(&whole.ego().x_m),
        y_m: head(&whole.ego().y_m),
        speed_mps: head(&whole.ego().speed_mps),
    };
    let lead = ObjectTrack {
        id: VehicleId(3),
        length_m: 4.5,
        first_row: 0,
        x_m: head(&whole.others()[0].x_m),
        y_m: head(&whole.others()[0].y_m),
        speed_mps: head(&whole.others()[0].speed_mps),
    };
    let time_s = head(whole.time_s());
    Recording::new(Road::PAPER, 20.0, time_s, vec![0; rows], ego, vec![lead]).unwrap()
}

/// The log of a recording, written with other options.
fn repacked(recording: &Recording, options: WriteOptions) -> Vec<u8> {
    rewritten(&bytes_of(recording), options, Some)
}

/// A log written anew: each message as `change` leaves it, or not at all.
fn rewritten<'a>(
    log: &'a [u8],
    options: WriteOptions,
    mut change: impl FnMut(Message<'a>) -> Option<Message<'a>>,
) -> Vec<u8> {
    let mut out = options.create(Cursor::new(Vec::new())).unwrap();
    for record in LinearReader::new(log).unwrap() {
        if let Record::Metadata(metadata) = record.unwrap() {
            out.write_metadata(&metadata).unwrap();
        }
    }
    for message in MessageStream::new(log).unwrap() {
        if let Some(message) = change(message.unwrap()) {
            out.write(&message).unwrap();
        }
    }
    out.finish().unwrap();
    out.into_inner().into_inner()
}
