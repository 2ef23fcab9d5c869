//! Several sessions with one link, and several rides in a condition.

use crate::support::{MISC, STUDY, Server, folder_of, lab, opened, read, script::Script, tells};
use rusqlite::Connection;
use serde_json::Value;
use std::{collections::BTreeSet, fs, path::Path};

const A_DAY_S: i64 = 86_400;

fn folder() -> tempfile::TempDir {
    let sessions = "rides_per_condition = 2\nsessions = { count = 2, days_between = [2, 14] }\npost = [\"mood\"]\n\
                    probe = { scale = \"misc\", every_s = 12 }\n";
    let design = STUDY
        .replace("ride_s = 10", "ride_s = 15")
        .replace("[protocol]\n", &format!("[protocol]\n{sessions}"));
    let folder = folder_of(&design);
    fs::write(folder.path().join("scales/misc.toml"), MISC).unwrap();
    folder
}

/// Goes on until somebody is between two sessions or through; gives the steps that were met.
fn walk(server: &Server, token: &str, person: &Script) -> Vec<Value> {
    let mut met = Vec::new();
    loop {
        let state = server.state(token);
        let at = state["at"].as_u64().unwrap() as usize;
        match state["steps"].get(at) {
            Some(step) if step["kind"] != "between" => met.push(step.clone()),
            _ => return met,
        }
        assert!(person.go_on(server, token));
    }
}

/// Moves everybody's coming to where they are so many days back.
fn days_pass(folder: &Path, days: i64) {
    let connection = Connection::open(folder.join("seat/seat.db")).unwrap();
    let moved = connection.execute("UPDATE person SET since = since - ?1", [days * A_DAY_S]);
    assert!(moved.unwrap() > 0);
}

fn kinds(met: &[Value]) -> Vec<&str> {
    met.iter().map(|step| step["kind"].as_str().unwrap()).collect()
}

#[test]
fn the_same_link_goes_on_from_the_day_on_and_every_ride_is_in_the_style_of_the_first_session() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let first = walk(&server, &token, &Script::default());
    let rides = ["ride", "scale"].repeat(4);
    let begins = ["text", "scale", "controls", "practice", "drive"];
    assert_eq!(kinds(&first), [&begins[..], &rides].concat());
    let learned = server.state(&token)["fit"].clone();
    // What was given stands in the study's tables already.
    assert!(read(folder.path(), "surveys/answers.csv").contains("P001"));

    // Nobody goes on before the day, whatever their page sends.
    let state = server.state(&token);
    let at = state["at"].as_u64().unwrap();
    assert_eq!(state["between"]["open"], false);
    let early = server.post(&format!("/api/{token}/done/{at}"), "null");
    assert!(early.0 == 409 || early.0 == 400, "{early:?}");
    assert!(early.1.contains("not the day yet"), "{}", early.1);
    days_pass(folder.path(), 2);
    assert_eq!(server.state(&token)["between"]["open"], true);
    assert_eq!(server.post(&format!("/api/{token}/done/{at}"), "null").0, 200);

    let second = walk(&server, &token, &Script::default());
    let begins = ["controls", "drive"];
    let ends = ["scale", "thanks"];
    assert_eq!(kinds(&second), [&begins[..], &rides, &ends].concat());
    assert_eq!(server.state(&token)["ended"], "done");
    assert_eq!(server.state(&token)["fit"], learned);
    // Nothing is met twice.
    let driven = first.iter().chain(&second).filter(|step| step["seed"].is_string());
    let worlds: Vec<&str> = driven.map(|step| step["seed"].as_str().unwrap()).collect();
    assert_eq!(worlds.iter().collect::<BTreeSet<_>>().len(), 11);

    let log = |name: &str| folder.path().join(format!("logs/seat/P001-{name}.mcap"));
    for name in ["own", "calm", "calm_s1_t2", "sporty_s2_t1", "own_s2_t1"] {
        assert!(log(name).is_file(), "{name}");
    }
    let answers = read(folder.path(), "surveys/answers.csv");
    let head = answers.lines().next().unwrap();
    for column in ["moment", "condition", "session", "trial"] {
        assert!(head.split(',').any(|name| name == column), "{head}");
    }
    let rides: BTreeSet<_> =
        maveric_study::tables::surveys::read_answers(&folder.path().join("surveys/answers.csv"))
            .unwrap()
            .into_iter()
            .filter_map(|answer| Some(answer.moment.ride()?.to_string()))
            .collect();
    assert_eq!(rides.len(), 8, "{rides:?}");
    assert!(rides.contains("sporty:s2:t2"), "{rides:?}");
    let order = read(folder.path(), "participants.csv");
    assert!(order.contains("calm sporty") && !order.contains("sporty calm"), "{order}");
    assert!(!read(folder.path(), "seat/notes.csv").contains("days after"));
}

#[test]
fn a_page_is_not_told_which_condition_comes_again() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let state = server.state(&token);
    for step in state["steps"].as_array().unwrap() {
        let told = format!("{}{}", step["condition"], step["moment"]);
        for word in ["calm", "sporty", ":t2"] {
            assert!(!told.contains(word) && step["trial"].is_null(), "{step}");
        }
    }
    let steps = state["steps"].as_array().unwrap().iter();
    let numbers = steps.filter_map(|step| step["number"].as_u64());
    assert_eq!(numbers.collect::<Vec<_>>(), [1, 2, 3, 4, 1, 2, 3, 4]);
}

#[test]
fn who_comes_late_goes_on_and_it_is_written_down_and_who_stopped_is_not_asked_again() {
    let folder = folder();
    let server = Server::open(folder.path());
    let (late, stopped) = (opened(&server), opened(&server));
    walk(&server, &late, &Script::default());
    days_pass(folder.path(), 15);
    let at = server.state(&late)["at"].as_u64().unwrap();
    assert_eq!(server.post(&format!("/api/{late}/done/{at}"), "null").0, 200);
    walk(&server, &late, &Script::default());
    let notes = read(folder.path(), "seat/notes.csv");
    tells(&notes, &["session 2: 15 days after the one before, at most 14"]);

    let unwell = Script { stops: Some((700, "unwell")), ..Script::default() };
    let met = walk(&server, &stopped, &unwell);
    assert_eq!(kinds(&met[4..]), ["drive", "ride", "aftercare", "thanks"]);
    let rows = read(folder.path(), "seat/stopped.csv");
    assert!(rows.lines().nth(1).unwrap().starts_with("P002,"), "{rows}");
}

#[test]
fn a_ride_of_a_further_session_that_was_stopped_is_named_with_its_session() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    walk(&server, &token, &Script::default());
    days_pass(folder.path(), 3);
    let at = server.state(&token)["at"].as_u64().unwrap();
    assert_eq!(server.post(&format!("/api/{token}/done/{at}"), "null").0, 200);
    let unwell = Script { stops: Some((700, "unwell")), ..Script::default() };
    walk(&server, &token, &unwell);
    let path = folder.path().join("seat/stopped.csv");
    let rows: Vec<maveric_study::tables::collected::Stopped> =
        maveric_study::tables::read_rows(&path).unwrap();
    assert_eq!((rows.len(), rows[0].session.get()), (1, 2));
    assert_eq!(rows[0].trial.get(), 1);
}

#[test]
fn the_experimenter_may_let_somebody_go_on_before_the_day_for_a_reason() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    walk(&server, &token, &Script::default());
    let lab = lab(&server);
    assert!(lab.contains("between two sessions"), "{lab}");
    let at = server.state(&token)["at"].as_u64().unwrap() as usize;
    let act = maveric_seat::steps::Act::Skip;
    server.seat.leave_out("P001", at, act, "came a day early").unwrap();
    let met = walk(&server, &token, &Script::default());
    assert_eq!(kinds(&met[..2]), ["controls", "drive"]);
}
