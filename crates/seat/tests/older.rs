//! A study that an older version of the seat began.

use crate::support::{Server, folder, lab, open, script::finish, settings};
use maveric_domain::ScoreRange;
use maveric_seat::{Seat, SeatError, SeatSettings};
use rusqlite::Connection;
use serde_json::{Value, json};
use std::{fs, path::Path};

/// The tables of the first version.
const FIRST: &str = "
CREATE TABLE person (
    token TEXT PRIMARY KEY, participant TEXT NOT NULL UNIQUE, steps TEXT NOT NULL, at INTEGER NOT NULL DEFAULT 0,
    ended TEXT, fit TEXT, tab TEXT, made INTEGER NOT NULL) STRICT;
CREATE TABLE answer (
    participant TEXT NOT NULL, step INTEGER NOT NULL, body TEXT NOT NULL, given INTEGER NOT NULL,
    PRIMARY KEY (participant, step)) STRICT;
CREATE TABLE drive (
    participant TEXT NOT NULL, step INTEGER NOT NULL, attempt INTEGER NOT NULL, header TEXT NOT NULL,
    ticks INTEGER NOT NULL DEFAULT 0, end TEXT, begun INTEGER NOT NULL,
    PRIMARY KEY (participant, step, attempt)) STRICT;
CREATE TABLE piece (
    participant TEXT NOT NULL, step INTEGER NOT NULL, attempt INTEGER NOT NULL, from_tick INTEGER NOT NULL, line TEXT NOT NULL,
    PRIMARY KEY (participant, step, attempt, from_tick)) STRICT, WITHOUT ROWID;
CREATE TABLE event (
    given INTEGER NOT NULL, participant TEXT, what TEXT NOT NULL) STRICT;
PRAGMA user_version = 1;
";

/// Links of who is through, who was deleted, and who is at the second step.
const LINKS: [&str; 3] = [
    "0123456789abcdef0123456789abcdef",
    "11111111111111111111111111111111",
    "22222222222222222222222222222222",
];

/// The study's file as the first version left it: P001 is through, P002 was deleted, P003 has agreed and is at the questionnaire.
fn first_version(folder: &Path) -> Connection {
    let state = Connection::open(folder.join("seat/seat.db")).unwrap();
    state.execute_batch(FIRST).unwrap();
    let steps = r#"[{"kind":"text","title":"t","text":"x","agree":true},
        {"kind":"scale","scale":"mood","title":"Mood","items":["a","b"],"min":1,"max":5,"moment":"pre"},
        {"kind":"thanks","text":"","code":null}]"#;
    for (link, who, at, ended) in [
        (LINKS[0], "P001", 3, Some("done")),
        (LINKS[1], "P002", 1, Some("deleted")),
        (LINKS[2], "P003", 1, None),
    ] {
        let row = rusqlite::params![link, who, steps, at, ended];
        state
            .execute(
                "INSERT INTO person (token, participant, steps, at, ended, made) VALUES (?1, ?2, ?3, ?4, ?5, 1)",
                row,
            )
            .unwrap();
    }
    state
        .execute(
            "INSERT INTO answer VALUES ('P001', 1, '{\"answers\":[2,3],\"seconds\":4}', 1)",
            [],
        )
        .unwrap();
    state
}

fn one(folder: &Path, question: &str) -> i64 {
    let state = Connection::open(folder.join("seat/seat.db")).unwrap();
    state.query_row(question, [], |row| row.get(0)).unwrap()
}

#[test]
fn a_study_of_the_first_version_goes_on_where_it_was() {
    let folder = folder();
    drop(first_version(folder.path()));
    // Who is through had been written; a row that was taken out since is not written back.
    fs::create_dir_all(folder.path().join("surveys")).unwrap();
    let answers = folder.path().join("surveys/answers.csv");
    let header = "participant,moment,scale,item,answer,seconds\n";
    fs::write(&answers, header).unwrap();
    let server = Server::open(folder.path());
    assert_eq!(server.state(LINKS[0])["ended"], "done");
    assert_eq!(fs::read_to_string(&answers).unwrap(), header);
    assert_eq!(server.state(LINKS[1])["ended"], "deleted");
    finish(&server, LINKS[2]);
    let written = fs::read_to_string(&answers).unwrap();
    assert!(
        written.contains("P003,pre,mood,1,4,3.000") && !written.contains("P001,"),
        "{written}"
    );
    // The id of whoever was deleted is not given again, nor is that of anybody else.
    let token = server.seat.let_in().unwrap();
    let question = format!("SELECT participant = 'P004' FROM person WHERE token = '{token}'");
    assert_eq!(one(folder.path(), &question), 1);
    assert_eq!(one(folder.path(), "PRAGMA user_version"), 3);
    let left = "SELECT COUNT(*) FROM person WHERE participant = 'P002' OR ended = 'deleted'";
    assert_eq!(one(folder.path(), left), 0);
}

#[test]
fn what_stops_on_the_way_to_this_version_begins_again_from_the_older_one() {
    let folder = folder();
    let state = first_version(folder.path());
    let full = "CREATE TRIGGER full BEFORE DELETE ON person BEGIN SELECT RAISE(FAIL, 'database or disk is full'); END";
    state.execute_batch(full).unwrap();
    let open = || open(folder.path());
    let refused = open().err().unwrap().to_string();
    assert!(refused.contains("disk is full"), "{refused}");
    assert_eq!(one(folder.path(), "PRAGMA user_version"), 1);
    state.execute_batch("DROP TRIGGER full").unwrap();
    drop(open().unwrap());
    assert_eq!(one(folder.path(), "PRAGMA user_version"), 3);
    let forgotten = "SELECT COUNT(*) FROM forgotten WHERE participant = 'P002' AND swept = 1";
    assert_eq!(one(folder.path(), forgotten), 1);
}

#[test]
fn a_file_of_a_later_version_is_refused_and_left_as_it_is() {
    let folder = folder();
    let state = first_version(folder.path());
    state.execute_batch("PRAGMA user_version = 4").unwrap();
    let refused = open(folder.path());
    assert!(matches!(
        refused.err().unwrap(),
        SeatError::Version {
            found: 4,
            expected: 3,
            ..
        }
    ));
    assert_eq!(one(folder.path(), "SELECT COUNT(*) FROM person"), 3);
}

/// The style that is kept of P001.
fn style_of_the_first(folder: &Path) -> Value {
    let state = Connection::open(folder.join("seat/seat.db")).unwrap();
    let question = "SELECT fit FROM person WHERE participant = 'P001'";
    let style: String = state.query_row(question, [], |row| row.get(0)).unwrap();
    serde_json::from_str(&style).unwrap()
}

#[test]
fn a_score_that_an_older_version_kept_is_judged_and_is_in_points_of_the_study_s_scale_from_then_on()
{
    let adb = ScoreRange::ADB;
    let risky = ScoreRange::new(1.0, 6.0).unwrap();
    let wide = ScoreRange::new(11.0, 66.0).unwrap();
    // The model reads 30 of the ADB's points of 0, and 10 more of a style of 1.
    for (range, kept, style, expected) in [
        (adb, 30.0, json!([0.0]), Some(30.0)),
        (adb, -3.0, json!([-3.3]), None),
        (risky, 30.0, json!([0.0]), Some(1.0 + 19.0 * 5.0 / 44.0)),
        (risky, -3.0, json!([-3.3]), None),
        (wide, 30.0, json!([0.0]), Some(11.0 + 19.0 * 55.0 / 44.0)),
        // What another model said stays, and so does what this one says now.
        (adb, 30.0, json!([0.5]), Some(30.0)),
        (adb, 30.0, json!([0.0, 0.0]), Some(30.0)),
        (wide, 30.0, json!([-0.38]), Some(30.0)),
    ] {
        let folder = folder();
        let state = first_version(folder.path());
        let fit = json!({"embedding": style, "covariance": null, "score": kept, "readings": 3});
        let change = "UPDATE person SET fit = ?1 WHERE participant = 'P001'";
        state.execute(change, [fit.to_string()]).unwrap();
        drop(state);
        // Opened a second time, nothing is changed again.
        for _ in 0..2 {
            let settings = SeatSettings {
                range: Some(range),
                ..settings(folder.path())
            };
            let seat = Seat::open(&folder.path().join("seat/seat.db"), settings).unwrap();
            let found = style_of_the_first(folder.path());
            let case = format!("{kept} on {range}: {found}");
            if let Some(points) = expected {
                let score = found["score"].as_f64().unwrap();
                assert!((score - points).abs() < 1e-9, "{case}");
                assert!(found["beyond"].is_null(), "{case}");
            } else {
                assert!(found["score"].is_null(), "{case}");
                assert_eq!(found["beyond"], "scale", "{case}");
            }
            assert_eq!(found["embedding"], style, "{case}");
            let marked = lab(&Server::of(seat, |_| {})).contains("beyond what the model has met");
            assert_eq!(marked, expected.is_none(), "{case}");
        }
    }
}
