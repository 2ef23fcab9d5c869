//! What is written beside a recording, and that it leaves the recording alone.

use super::{ROWS, bytes_of, meta, recording};
use maveric_domain::{
    LaneActivity, LaneWish, Recording, Setpoints, TraceRow, When, drive::Direction,
};
use maveric_ingest::{
    Beside, Decision, DecisionKind, IngestError, IngestSettings, WarningKind, inspect,
    read_decisions, read_log, write_mcap_with,
};
use std::io::Cursor;

/// A change to the left from row 300 to 390, and the safety layer braking from row 500 to 510.
fn trace() -> Vec<TraceRow> {
    let row = |row: usize| TraceRow {
        time_s: row as f64 / 20.0,
        asked: Setpoints {
            speed_mps: 30.0,
            following_distance_m: 36.0,
            wish: LaneWish::MoveOut(When::Now),
        },
        acceleration_mps2: -0.5,
        braked: (500..510).contains(&row),
        lane: match row {
            280..300 => LaneActivity::Waiting,
            300..390 => LaneActivity::Changing,
            _ => LaneActivity::Keeping,
        },
        path_m: (300..390).contains(&row).then_some([
            (360.0, 0.0),
            (400.0, 0.0),
            (440.0, 3.66),
            (480.0, 3.66),
        ]),
    };
    (0..ROWS).map(row).collect()
}

fn written(recording: &Recording, trace: &[TraceRow]) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    let beside = Beside { trace, ..Beside::default() };
    write_mcap_with(recording, &meta(), &beside, &mut out).unwrap();
    out.into_inner()
}

fn on_disk(bytes: &[u8]) -> tempfile::NamedTempFile {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    file
}

#[test]
fn nothing_beside_gives_the_same_bytes_as_before() {
    let recording = recording(false);
    assert_eq!(written(&recording, &[]), bytes_of(&recording));
}

#[test]
fn decisions_change_nothing_that_is_ingested() {
    let recording = recording(true);
    // One path: warnings name the file.
    let file = on_disk(&[]);
    let read = |bytes: &[u8]| {
        std::fs::write(file.path(), bytes).unwrap();
        let mut found = read_log(file.path(), &IngestSettings::default()).unwrap();
        let first = found.remove(0);
        (first.meta, first.recording, first.warnings, found.len())
    };
    let plain = read(&bytes_of(&recording));
    let full = read(&written(&recording, &trace()));
    assert_eq!(plain, full);
}

#[test]
fn decisions_come_back() {
    let file = on_disk(&written(&recording(false), &trace()));
    let found = read_decisions(file.path()).unwrap().unwrap();
    let expected = [
        (14.0, DecisionKind::ChangeWaits),
        (15.0, DecisionKind::ChangeStarts(Direction::Left)),
        (19.5, DecisionKind::ChangeEnds),
        (25.0, DecisionKind::SafetyBrakes),
        (25.5, DecisionKind::SafetyReleases),
    ];
    let expected = expected.map(|(time_s, kind)| Decision { time_s, kind });
    assert_eq!(found, expected);
    let channels = inspect(file.path()).unwrap().channels;
    assert!(channels.iter().all(|c| c.decodable), "{channels:?}");
    let plain = on_disk(&bytes_of(&recording(false)));
    assert_eq!(read_decisions(plain.path()).unwrap(), None);
}

#[test]
fn a_car_that_decided_nothing_is_not_one_that_could_not() {
    let quiet: Vec<TraceRow> = trace()
        .into_iter()
        .map(|row| TraceRow { lane: LaneActivity::Keeping, braked: false, path_m: None, ..row })
        .collect();
    let file = on_disk(&written(&recording(false), &quiet));
    assert_eq!(read_decisions(file.path()).unwrap(), Some(Vec::new()));
}

#[test]
fn the_trace_of_another_drive_is_refused() {
    let beside = Beside { trace: &trace()[1..], ..Beside::default() };
    let out = Cursor::new(Vec::new());
    let error = write_mcap_with(&recording(false), &meta(), &beside, out).unwrap_err();
    assert!(matches!(error, IngestError::WriteDrive { .. }));
    assert!(error.to_string().contains("1199 rows"), "{error}");
}

#[test]
fn what_is_noted_of_a_recording_is_a_warning_and_what_is_attached_is_there() {
    let beside = Beside {
        attached: Some(("inputs.jsonl", b"{}\n")),
        note: Some("7 of 600 pictures came late"),
        ..Beside::default()
    };
    let mut out = Cursor::new(Vec::new());
    write_mcap_with(&recording(false), &meta(), &beside, &mut out).unwrap();
    let file = on_disk(&out.into_inner());
    let read = read_log(file.path(), &IngestSettings::default()).unwrap();
    let noted: Vec<&str> = (read[0].warnings.iter())
        .filter(|w| w.kind == WarningKind::Noted)
        .map(|w| w.what.as_str())
        .collect();
    assert_eq!(noted, ["7 of 600 pictures came late"]);
    let attached = maveric_bag::attachment(file.path(), "inputs.jsonl").unwrap();
    assert_eq!(attached.as_deref(), Some(&b"{}\n"[..]));
}
