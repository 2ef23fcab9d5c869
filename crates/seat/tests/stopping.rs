//! Who feels unwell stops: nothing more is driven, and what was is kept and marked.

use crate::support::{
    MISC, STUDY, Server, TAB, folder_of, lab, opened, read,
    script::{Script, driven, until},
    tells,
};
use maveric_seat::replay;
use serde_json::{Value, json};
use std::fs;

const STOPS: &str = "probe = { scale = \"misc\", every_s = 12 }\nstop_if = \"misc >= 6\"\npost = [\"mood\"]\n\
    aftercare = \"aftercare.md\"\ndebrief = \"debrief.md\"\n";

fn folder() -> tempfile::TempDir {
    let design = STUDY
        .replace("ride_s = 10", "ride_s = 40")
        .replace("[protocol]\n", &format!("[protocol]\n{STOPS}"));
    let folder = folder_of(&design);
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("scales/misc.toml", MISC);
    write("aftercare.md", "Sit down and drink some water.");
    write("debrief.md", "The car drove as you do, or not.");
    folder
}

/// Goes through the study; gives the kinds of steps that were met.
fn walk(server: &Server, token: &str, person: &Script) -> Vec<String> {
    let mut kinds = Vec::new();
    loop {
        let state = server.state(token);
        let at = state["at"].as_u64().unwrap() as usize;
        let Some(step) = state["steps"].get(at) else {
            return kinds;
        };
        kinds.push(step["kind"].as_str().unwrap().to_owned());
        assert!(person.go_on(server, token));
    }
}

#[test]
fn who_stops_is_cared_for_rides_no_more_and_the_ride_is_marked_with_the_reason() {
    let folder = folder();
    let server = Server::open(folder.path());
    let unwell = Script { stops: Some((1_500, "misc >= 6")), ..Script::default() };
    let (stopped, whole) = (opened(&server), opened(&server));
    let met = walk(&server, &stopped, &unwell);
    assert_eq!(
        met,
        ["text", "scale", "controls", "practice", "drive", "ride", "aftercare", "text", "thanks"]
    );
    assert_eq!(server.state(&stopped)["ended"], "done");
    // Whoever did not stop is asked at the end, and goes past the aftercare.
    let met = walk(&server, &whole, &Script::default());
    assert_eq!(met[5..], ["ride", "scale", "ride", "scale", "scale", "text", "thanks"]);
    assert_eq!(
        read(folder.path(), "seat/stopped.csv"),
        "participant,condition,time_s,reason\nP001,calm,15.0,misc >= 6\n"
    );
    // What was ridden is kept as a log, and drives again to where it was stopped.
    assert!(folder.path().join("logs/seat/P001-calm.mcap").is_file());
    let again = replay::repeat(&folder.path().join("seat/P001-calm.jsonl")).unwrap();
    assert_eq!((again.same, again.ticks), (Some(true), 1_501));
    let answers = read(folder.path(), "surveys/answers.csv");
    assert!(
        !answers.contains("P001,after") && answers.contains("P001,probe,misc,1,1,,calm,12"),
        "{answers}"
    );
    let lab = lab(&server);
    assert!(lab.contains("the person stopped (misc &gt;= 6)"), "{lab}");
}

#[test]
fn a_reason_that_the_study_does_not_have_is_refused_and_the_button_is_always_there() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let (at, step) = until(&server, &token, "ride");
    let (lines, _) = driven(&step);
    let path = format!("/api/{token}/drive/{at}/1/{TAB}");
    assert_eq!(server.post(&path, &lines[0]).0, 200);
    let with = |reason: &str| {
        let mut piece: Value = serde_json::from_str(&lines[1]).unwrap();
        piece["events"] = json!([{"tick": 50, "what": format!("stopped: {reason}")}]);
        piece.to_string()
    };
    assert_eq!(server.post(&path, &with("misc >= 3")).0, 400);
    assert_eq!(server.post(&path, &with("unwell")).0, 200);
}

#[test]
fn who_stopped_is_asked_once_more_how_they_feel_and_who_is_unwell_still_is_named() {
    let folder = folder();
    let server = Server::open(folder.path());
    let unwell = Script { stops: Some((1_500, "misc >= 6")), ..Script::default() };
    for (felt, named) in [(7, true), (2, false)] {
        let token = opened(&server);
        let at = loop {
            let state = server.state(&token);
            let at = state["at"].as_u64().unwrap() as usize;
            let step = &state["steps"][at];
            if step["kind"] == "aftercare" {
                assert_eq!(step["again"]["every_s"], 600.0);
                break at;
            }
            assert!(unwell.go_on(&server, &token));
        };
        let sent = |body: &str| server.post(&format!("/api/{token}/answer/{at}"), body).0;
        assert_eq!(sent("{\"answers\":[11],\"seconds\":600}"), 400);
        assert_eq!(sent(&format!("{{\"answers\":[{felt}],\"seconds\":603}}")), 200);
        while unwell.go_on(&server, &token) {}
        let who = if named { "P001" } else { "P002" };
        let notes = read(folder.path(), "seat/notes.csv");
        let told =
            notes.lines().any(|row| row.contains(who) && row.contains("still unwell 10 min"));
        assert_eq!(told, named, "{notes}");
        let events = read(folder.path(), "seat/events.csv");
        tells(&events, &[&format!("{who},"), &format!("felt:misc,{felt}")]);
    }
}
