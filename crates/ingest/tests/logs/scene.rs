//! What is written beside a recording, and that it leaves the recording alone.

use super::{ROWS, bytes_of, meta, recording};
use maveric_domain::{
    LaneActivity, LaneWish, Recording, Setpoints, TraceRow, When, drive::Direction,
};
use maveric_ingest::{
    Beside, Decision, DecisionKind, IngestError, IngestSettings, WarningKind, inspect,
    read_decisions, read_log, write_mcap_with,
};
use mcap::MessageStream;
use serde_json::Value;
use std::{collections::BTreeMap, io::Cursor};

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

fn written(recording: &Recording, trace: &[TraceRow], scene: bool) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    let beside = Beside {
        trace,
        scene,
        ..Beside::default()
    };
    write_mcap_with(recording, &meta(), &beside, &mut out).unwrap();
    out.into_inner()
}

fn on_disk(bytes: &[u8]) -> tempfile::NamedTempFile {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    file
}

/// JSON messages by topic, each with its time in s.
fn messages(bytes: &[u8]) -> BTreeMap<String, Vec<(f64, Value)>> {
    let mut out: BTreeMap<String, Vec<(f64, Value)>> = BTreeMap::new();
    for message in MessageStream::new(bytes).unwrap() {
        let message = message.unwrap();
        if message.channel.message_encoding == "json" {
            let schema = message.channel.schema.as_ref().unwrap();
            assert_eq!(schema.encoding, "jsonschema");
            let title = serde_json::from_slice::<Value>(&schema.data).unwrap();
            assert_eq!(title["title"], schema.name.as_str());
            let value = serde_json::from_slice(&message.data).unwrap();
            let list = out.entry(message.channel.topic.clone()).or_default();
            list.push((message.log_time as f64 / 1e9, value));
        }
    }
    out
}

#[test]
fn nothing_beside_gives_the_same_bytes_as_before() {
    let recording = recording(false);
    assert_eq!(written(&recording, &[], false), bytes_of(&recording));
}

#[test]
fn a_scene_changes_nothing_that_is_ingested() {
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
    let full = read(&written(&recording, &trace(), true));
    assert_eq!(plain, full);
}

#[test]
fn the_scene_shows_every_car_where_it_is() {
    let recording = recording(false);
    let found = messages(&written(&recording, &trace(), true));
    let cars = &found["/maveric/scene/cars"];
    assert_eq!(cars.len(), ROWS / 2);
    for (i, (time_s, update)) in cars.iter().enumerate() {
        let scene = recording.scene(2 * i).unwrap();
        assert!((scene.time_s - time_s).abs() < 1e-9);
        let cubes = update["entities"][0]["cubes"].as_array().unwrap();
        let near = |x_m: f64| (x_m - scene.ego.x_m).abs() < 250.0;
        let expected: Vec<_> = scene.vehicles.iter().filter(|v| near(v.x_m)).collect();
        assert_eq!(cubes.len(), expected.len());
        for (cube, vehicle) in cubes.iter().zip(expected) {
            let at = |key: &str| cube["pose"]["position"][key].as_f64().unwrap();
            assert!((at("x") - vehicle.x_m).abs() < 1e-4);
            assert!((at("y") - vehicle.y_m).abs() < 1e-4);
            let length = cube["size"]["x"].as_f64().unwrap();
            assert!((length - vehicle.length_m).abs() < 1e-4);
        }
    }
    let frames = &found["/maveric/frames"];
    assert_eq!(frames.len(), ROWS / 2);
    let (time_s, frame) = &frames[200];
    assert!((time_s - 20.0).abs() < 1e-9);
    let x = frame["translation"]["x"].as_f64().unwrap();
    assert!((x - recording.ego().x_m[400]).abs() < 1e-4);
    // At 20 s ego crosses the line: its frame is turned to the left.
    assert!(frame["rotation"]["z"].as_f64().unwrap() > 0.01);
}

#[test]
fn lanes_stand_once_and_the_plan_comes_and_goes() {
    let found = messages(&written(&recording(false), &trace(), true));
    let road = &found["/maveric/scene/road"];
    assert_eq!(road.len(), 1);
    let lanes = road[0].1["entities"][0]["lines"].as_array().unwrap();
    let y = |line: &Value| line["points"][0]["y"].as_f64().unwrap();
    assert_eq!(lanes.iter().map(y).collect::<Vec<_>>(), [-1.83, 1.83, 5.49]);
    let plan = &found["/maveric/scene/plan"];
    let times: Vec<f64> = plan.iter().map(|(time_s, _)| *time_s).collect();
    assert_eq!(times, [14.0, 15.0, 19.5, 25.0, 25.5]);
    let path = plan[1].1["entities"][0]["lines"][0]["points"]
        .as_array()
        .unwrap();
    assert_eq!(path.last().unwrap()["x"], 480.0);
    assert_eq!(plan[1].1["deletions"][0]["type"], 1);
    assert!(plan[2].1["entities"].as_array().unwrap().is_empty());
    assert_eq!(
        plan[3].1["entities"][0]["texts"][0]["text"],
        "safety layer brakes"
    );
}

#[test]
fn signals_leave_out_what_does_not_exist() {
    let recording = recording(false);
    let signals = |trace: &[TraceRow]| {
        let mut found = messages(&written(&recording, trace, true));
        found.remove("/maveric/signals").unwrap()
    };
    let asked = &signals(&trace())[0].1;
    assert_eq!(asked["asked_speed_mps"], 30.0);
    let gap_m = asked["gap_m"].as_f64().unwrap();
    assert!(
        (gap_m - (60.0 - 0.5 * (4.83 + 7.5))).abs() < 1e-9,
        "{gap_m}"
    );
    let by_hand = &signals(&[])[0].1;
    assert!(by_hand.get("asked_speed_mps").is_none() && by_hand.get("gap_m").is_some());
}

#[test]
fn decisions_come_back() {
    let file = on_disk(&written(&recording(false), &trace(), false));
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
        .map(|row| TraceRow {
            lane: LaneActivity::Keeping,
            braked: false,
            path_m: None,
            ..row
        })
        .collect();
    let file = on_disk(&written(&recording(false), &quiet, false));
    assert_eq!(read_decisions(file.path()).unwrap(), Some(Vec::new()));
}

#[test]
fn the_trace_of_another_drive_is_refused() {
    let beside = Beside {
        trace: &trace()[1..],
        ..Beside::default()
    };
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
