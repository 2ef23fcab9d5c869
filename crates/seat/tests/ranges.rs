//! A study whose score has another range than the one that its model has learned: the seat puts the model on it.

use crate::support::{
    STUDY, Server, folder_of, lab, learned_from, opened, read, script::Script, settings,
};
use maveric_domain::{Embedding, ScoreRange};
use maveric_model::{Model, model_file, style_space::LinearHead};
use maveric_seat::{Seat, SeatSettings};
use maveric_seat_page::Record;
use rusqlite::Connection;
use serde_json::{Value, json};
use std::{fs, path::Path, rc::Rc};

/// The study on a score from 1 to 6: a ride in another's style, and one .85 points up the dial.
fn study() -> String {
    let mut study = STUDY.to_owned();
    for (was, is) in [
        ("score = \"adb.total\"", "score = \"adb.total\"\nrange = [1, 6]"),
        ("id = \"calm\"", "id = \"other\""),
        ("{ dial = -8, recorded", "{ other = \"matched\", from = \"learned\", recorded"),
        ("{ dial = 8, recorded", "{ dial = 0.85, recorded"),
        ("code = \"C0DE\"", "debrief = \"debrief.md\""),
    ] {
        assert!(study.contains(was), "{was}");
        study = study.replace(was, is);
    }
    study
}

/// A model on the ADB's scale that learned from seven people of 35 points, who differ across the dial alone.
fn of_35_points(folder: &Path) -> Model {
    let names = ["S1", "S2", "S3", "S4", "S5", "S6", "S7"].map(|who| format!("{who}-own"));
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let model = model_file::from_bytes(&learned_from(folder, &names)).unwrap();
    let mut parts = serde_json::to_value(&model).unwrap();
    let drives = parts["training"].as_array_mut().unwrap().iter_mut();
    for (drive, across) in drives.zip([1.0, -1.0].iter().cycle()) {
        drive["embedding"] = json!([0.5, across]);
    }
    serde_json::from_value(parts).unwrap()
}

/// What the seat keeps of its only person: their style and their steps.
fn kept(folder: &Path) -> (Value, Value) {
    let state = Connection::open(folder.join("seat/seat.db")).unwrap();
    let row: (String, String) = state
        .query_row("SELECT fit, steps FROM person", [], |row| Ok((row.get(0)?, row.get(1)?)))
        .unwrap();
    let value = |text: &str| serde_json::from_str(text).unwrap();
    (value(&row.0), value(&row.1))
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
}

#[test]
fn a_model_learned_on_the_adbs_scale_is_served_reads_turns_and_lends_in_points_of_the_study_s() {
    let folder = folder_of(&study());
    fs::write(folder.path().join("debrief.md"), "It was another's.").unwrap();
    let learned = of_35_points(folder.path());
    let range = ScoreRange::new(1.0, 6.0).unwrap();
    let settings = SeatSettings {
        model: Some(model_file::to_bytes(&learned).unwrap()),
        range: Some(range),
        ..settings(folder.path())
    };
    let seat = Seat::open(&folder.path().join("seat/seat.db"), settings).unwrap();
    let server = Server::of(seat, |_| {});
    let token = opened(&server);
    let (status, reply) = server.ask("GET", &format!("/api/{token}/model"), "", &[]);
    assert_eq!(status, 200, "{reply}");
    let (_, bytes) = reply.split_once("\r\n\r\n").unwrap();
    let served = model_file::from_bytes(bytes.as_bytes()).unwrap();
    assert_eq!(served.score_range(), range);
    assert_eq!(serde_json::to_value(&served).unwrap()["score_range"], json!([1.0, 6.0]));
    let dial = LinearHead::aggression(&served).unwrap();
    let on_adb = LinearHead::aggression(&learned).unwrap();
    let person = Script { model: Rc::new(served), ..Script::default() };
    while person.go_on(&server, &token) {}

    let (fit, steps) = kept(folder.path());
    let own: Embedding = serde_json::from_value(fit["embedding"].clone()).unwrap();
    let score = fit["score"].as_f64().unwrap();
    assert!((1.0..=6.0).contains(&score), "{fit}");
    near(score, dial.read(&own).unwrap());
    near(score, 1.0 + (on_adb.read(&own).unwrap() - 11.0) * 5.0 / 44.0);
    let ridden = |condition: &str| {
        let lines = read(folder.path(), &format!("seat/P001-{condition}.jsonl"));
        let style = Record::from_lines(&lines).unwrap().header.style.unwrap();
        dial.read(&style).unwrap() - score
    };
    near(ridden("sporty"), 0.85);
    near(ridden("other"), 0.0);

    let mut steps = steps.as_array().unwrap().iter();
    let lent = steps.find(|step| step["lent"].is_object()).unwrap();
    let lent = &lent["lent"];
    let number = |name: &str| lent[name].as_f64().unwrap();
    let (shift, distance) = (number("donor_shift_points"), number("donor_distance_sd"));
    near(shift, score - (1.0 + (35.0 - 11.0) * 5.0 / 44.0));
    assert!(shift.abs() > 0.1, "{lent}");
    // Two elevenths of 5 points.
    let within = shift.abs() <= 10.0 / 11.0 && (0.7..=2.5).contains(&distance);
    assert_eq!(lent["donor_within_reach"], within, "{lent}");
    assert!(!lab(&server).contains("another style"));
}
