//! The committed page's WebAssembly in Node, where that is on the PATH, against the same drives here.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod support;
#[path = "../../../tests/support/where_there.rs"]
mod where_there;

use base64::prelude::{BASE64_STANDARD, Engine as _};
use maveric_domain::{DrivenBy, Embedding, Seconds};
use maveric_model::model_file;
use maveric_seat_page::{
    Fit, Frames, Input, Keyboard, Keys, Record, RideStyle, Rider, SeatDrive, Signal, fit, replay,
};
use maveric_simulator::Scenario;
use serde::Deserialize;
use std::{
    io::Write as _,
    path::Path,
    process::{Command, Stdio},
    rc::Rc,
};
use support::model;

/// Keys (bits as the page has them), signal, steps: out to the left, past somebody, back.
fn pressed() -> Vec<(u8, i8, u32)> {
    let mut pressed = vec![(4, 0, 700)];
    for _ in 0..3 {
        pressed.extend([(1, 1, 55), (0, 1, 120), (2, 0, 56), (0, 0, 800)]);
        pressed.extend([(2, -1, 55), (0, -1, 120), (1, 0, 56), (8, 0, 130), (4, 0, 700)]);
    }
    let driven: u32 = pressed.iter().map(|p| p.2).sum();
    pressed.push((0, 0, 9_001 - driven));
    pressed
}

fn here(scenario: &Scenario) -> (Record, Fit) {
    let mut drive = SeatDrive::by_hand(scenario, 41, DrivenBy::Scripted).unwrap();
    let mut keyboard = Keyboard::new(scenario);
    let mut record = drive.begun();
    for (down, signal, steps) in pressed() {
        let keys = Keys {
            left: down & 1 != 0,
            right: down & 2 != 0,
            faster: down & 4 != 0,
            slower: down & 8 != 0,
            emergency: false,
        };
        let signal = Signal::try_from(signal).unwrap();
        for _ in 0..steps {
            let speed_mps = drive.session().car().speed_mps;
            drive.tick(keyboard.input(keys, signal, speed_mps));
        }
        record.chunks.push(drive.chunk(Frames::default()));
    }
    let driven = drive.finish().unwrap();
    record.end = Some(driven.end);
    let fit = fit(&model(), &driven.rollout.recording, DrivenBy::Scripted).unwrap();
    (record, fit)
}

fn ride(scenario: &Scenario) -> Record {
    let own = Embedding::new(vec![0.4]).unwrap();
    let settings = &scenario.settings().controllers;
    let mut rider = Rider::new(Rc::new(model()), own, (RideStyle::Own, 5.0), settings).unwrap();
    let controllers = rider.controllers();
    let mut drive = SeatDrive::ride(scenario, 8, &mut rider, &controllers).unwrap();
    let mut record = drive.begun();
    while drive.tick(Input::default()) {}
    record.chunks.push(drive.chunk(Frames::default()));
    record.end = Some(drive.finish().unwrap().end);
    record
}

#[derive(Deserialize)]
struct InNode {
    record: String,
    fit: Fit,
    again: Vec<Again>,
}

#[derive(Deserialize)]
struct Again {
    same: bool,
    states: String,
}

fn in_node(told: &serde_json::Value) -> InNode {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/in_node.mjs");
    let mut node = Command::new("node")
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = node.stdin.take().unwrap();
    input.write_all(told.to_string().as_bytes()).unwrap();
    drop(input);
    let output = node.wait_with_output().unwrap();
    assert!(output.status.success(), "the script in Node failed");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn the_page_drives_the_same_states_to_the_byte_and_learns_the_same_style() {
    let paper = Scenario::paper().with_duration(Seconds(90.0)).unwrap();
    let curved =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/scenarios/curved.toml");
    let curved: Scenario = toml::from_str(&std::fs::read_to_string(curved).unwrap()).unwrap();
    let curved = curved.with_duration(Seconds(90.0)).unwrap();
    let ((record, fit), (on_bends, _)) = (here(&paper), here(&curved));
    let records = [&record, &on_bends, &ride(&paper), &ride(&curved)];
    let lines: Vec<String> = records.iter().map(|r| r.to_lines().unwrap()).collect();
    let node = in_node(&serde_json::json!({
        "scenario": serde_json::to_string(&paper).unwrap(),
        "seconds": 90.0,
        "seed": "41",
        "pressed": pressed(),
        "model": BASE64_STANDARD.encode(model_file::to_bytes(&model()).unwrap()),
        "records": lines,
    }));
    assert_eq!(node.record, record.to_lines().unwrap());
    for (record, again) in records.iter().zip(&node.again) {
        let here = replay(record).unwrap();
        assert!(again.same && here.same());
        assert_eq!(again.states, here.end.states);
    }
    // The model's sums differ in the last places between a page and a processor that fuses.
    assert_eq!(node.fit.readings, fit.readings);
    for (there, here) in node.fit.embedding.iter().zip(&fit.embedding) {
        assert!((there - here).abs() < 1e-5, "{there} {here}");
    }
}

fn main() {
    let name = "the_page_drives_the_same_states_to_the_byte_and_learns_the_same_style";
    let test = the_page_drives_the_same_states_to_the_byte_and_learns_the_same_style;
    let missing = where_there::runs("node").err();
    where_there::run(vec![where_there::trial(name, missing, test)]);
}
