//! Rides that show the person's own drive by hand again.

use crate::support::{
    STUDY, Server, TAB, folder_of, lab, open_with, opened,
    script::{Script, driven, go_on, here, piece},
};
use maveric_seat_page::{Record, replay};
use std::{fs, path::Path};

/// A study of one's own drive beside the average driver's; the debriefing says so.
fn study() -> tempfile::TempDir {
    let design = STUDY
        .replace("car = { dial = -8, recorded = true }", "car = { replay = \"own\" }")
        .replace("car = { dial = 8, recorded = true }", "car = { mean = true, recorded = true }")
        .replace("ride_s = 10", "ride_s = 20\nworld = \"same\"\ndebrief = \"debrief.md\"");
    let folder = folder_of(&design);
    let text = "One of the rides was your own drive.";
    fs::write(folder.path().join("debrief.md"), text).unwrap();
    folder
}

/// The record among what the seat wrote.
fn record(folder: &Path, name: &str) -> Record {
    let path = folder.join(format!("seat/{name}.jsonl"));
    Record::from_lines(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn a_ride_goes_through_the_same_states_as_the_drive_that_it_shows() {
    let folder = study();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let (status, reply) = server.ask("GET", &format!("/api/{token}/own"), "", &[]);
    assert!(status >= 400 && reply.contains("no drive by hand"), "{reply}");
    let script = Script { speed: Some(30.0), ..Script::default() };
    while script.go_on(&server, &token) {}
    assert_eq!(server.state(&token)["ended"], "done");
    let [own, again, other] =
        ["P001-own", "P001-calm", "P001-sporty"].map(|name| record(folder.path(), name));
    assert!(again.shows(&own) && !other.shows(&own));
    assert_eq!(again.end, own.end, "every car, at every step, is where it was");
    assert_eq!(other.header.seed, own.header.seed, "every ride is in the world of the drive");
    assert!(replay(&again).unwrap().same());
    let told = lab(&server);
    assert!(told.contains("P001-calm: 20 s") && !told.contains("another drive"), "{told}");
}

#[test]
fn nothing_but_the_own_drive_is_shown_without_a_model() {
    let design = STUDY
        .replace("[model]\nfile = \"lab.maveric\"\n[style]\nscore = \"adb.total\"\n", "")
        .replace("[[condition]]\nid = \"sporty\"\ncar = { dial = 8, recorded = true }\n", "")
        .replace("car = { dial = -8, recorded = true }", "car = { replay = \"own\" }")
        .replace("ride_s = 10", "ride_s = 20\nworld = \"same\"\ndebrief = \"debrief.md\"");
    let folder = folder_of(&design);
    fs::write(folder.path().join("debrief.md"), "It was your own drive.").unwrap();
    let server = Server::of(open_with(folder.path(), None).unwrap(), |_| {});
    let token = opened(&server);
    while go_on(&server, &token) {}
    let [own, again] = ["P001-own", "P001-calm"].map(|name| record(folder.path(), name));
    assert!(again.shows(&own) && again.end == own.end);
}

#[test]
fn a_page_that_shows_another_drive_is_told_to_the_experimenter_and_one_that_lets_a_model_drive_is_refused()
 {
    let folder = study();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let script = Script::default();
    let (at, step) = loop {
        let (at, step) = here(&server, &token);
        if step["style"] == "replay" {
            break (at, step);
        }
        assert!(script.go_on(&server, &token));
    };
    let state = server.state(&token);
    let send = |lines: &[String]| {
        let place = format!("/api/{token}/drive/{at}/1/{TAB}");
        server.post(&place, &piece(lines))
    };
    let (by_model, _) = driven(&step);
    let (status, reply) = send(&by_model[..1]);
    assert!(status >= 400 && reply.contains("head of another drive"), "{reply}");
    let mut other = state.clone();
    let mut by_hand = step.clone();
    (by_hand["kind"], by_hand["seed"]) = ("drive".into(), step["seed"].clone());
    let faster = Script { speed: Some(34.0), ..Script::default() };
    other["own"] = faster.driven(&by_hand, &state).0.join("\n").into();
    let (lines, _) = script.driven(&step, &other);
    assert_eq!(send(&lines).0, 200);
    let done = format!("/api/{token}/done/{at}");
    assert_eq!(server.post(&done, "null").0, 200);
    while script.go_on(&server, &token) {}
    let told = lab(&server);
    let another = "the page showed another drive than the person";
    assert!(told.contains(another), "{told}");
}
