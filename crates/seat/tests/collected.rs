//! What people do beside answering and driving stands in tables: events, consents, notes.

use crate::support::{script::*, *};
use maveric_ingest::{IngestSettings, read_log};
use maveric_model::model_file;
use maveric_seat::SeatError;
use maveric_study::tables::{
    Table,
    collected::{ConsentRow, EventRow, NoteRow, read_consents},
};
use serde_json::json;
use std::{fs, path::Path};

fn rows<T: serde::de::DeserializeOwned>(folder: &Path, name: &str) -> Vec<T> {
    let path = folder.join("seat").join(name);
    Table::read(&path).unwrap().records().unwrap()
}

#[test]
fn pages_presses_practice_consent_and_notes_reach_tables_and_go_with_the_person() {
    let free = STUDY.replace("{ dial = 8, recorded = true }", "{ free = true }");
    let folder = folder_of(&free);
    let server = Server::open(folder.path());
    let (token, other) = (opened(&server), opened(&server));
    while go_on(&server, &token) {}
    // Somebody who is still at it, and a note.
    assert!(go_on(&server, &other) && go_on(&server, &other));
    server.seat.note("the window was open").unwrap();
    drop(server);
    let server = Server::open(folder.path());

    let events: Vec<EventRow> = rows(folder.path(), "events.csv");
    let of = |who: &str, what: &str| -> Vec<&EventRow> {
        let is = |row: &&EventRow| row.participant.as_str() == who && row.what == what;
        events.iter().filter(is).collect()
    };
    let agreed = of("P001", "agreed");
    assert_eq!((agreed.len(), agreed[0].page.as_str()), (1, "consent"));
    assert!(agreed[0].at.is_some() && agreed[0].value.is_some());
    let sheets = of("P001", "answered");
    let moments: Vec<&str> = sheets.iter().filter_map(|r| r.moment.as_deref()).collect();
    assert_eq!(moments, ["pre", "calm", "sporty"]);
    assert!(sheets.iter().all(|row| row.page == "mood" && row.value == Some(6.0)));
    let dial = of("P001", "dial");
    assert_eq!((dial.len(), dial[0].page.as_str()), (1, "sporty"));
    assert_eq!((dial[0].time_s, dial[0].value), (Some(3.0), Some(5.0)));
    let practice: Vec<&str> =
        events.iter().filter(|row| row.page == "practice").map(|row| row.what.as_str()).collect();
    assert_eq!(practice.first(), Some(&"begun"));
    assert!(practice.last().unwrap().starts_with("practice"), "{practice:?}");
    assert_eq!(of("P001", "done").len(), 1);
    assert_eq!((of("P002", "answered").len(), of("P002", "done").len()), (1, 0));

    let consents: Vec<ConsentRow> =
        read_consents(&folder.path().join("seat/consents.csv")).unwrap();
    assert_eq!(consents.len(), 2);
    assert!(
        consents
            .iter()
            .all(|c| c.text_sha256.len() == 64 && c.at.is_some() && c.style_lent.is_none())
    );
    assert_eq!(consents[0].text_sha256, consents[1].text_sha256);
    let notes: Vec<NoteRow> = rows(folder.path(), "notes.csv");
    let note = notes.iter().find(|note| note.by == "experimenter").unwrap();
    assert_eq!((note.text.as_str(), &note.participant), ("the window was open", &None));
    assert!(notes.iter().any(|note| note.by == "seat"));

    // Whoever is forgotten is in none of them, and the others stay to the byte.
    let path = format!("/api/{token}/leave");
    assert_eq!(server.post(&path, r#"{"keep":false}"#).0, 200);
    for name in ["events.csv", "consents.csv", "notes.csv"] {
        let text = fs::read_to_string(folder.path().join("seat").join(name)).unwrap();
        assert!(!text.contains("P001"), "{name}: {text}");
    }
    server.seat.write_files().unwrap();
    let left: Vec<EventRow> = rows(folder.path(), "events.csv");
    let second: Vec<EventRow> =
        events.into_iter().filter(|r| r.participant.as_str() == "P002").collect();
    assert_eq!(left, second);
}

#[test]
fn what_was_driven_before_somebody_left_is_a_log_where_it_is_kept() {
    let (folder, server, token) = one_person();
    let (at, step) = until(&server, &token, "drive");
    let (lines, _) = driven(&step);
    let path = format!("/api/{token}/drive/{at}/1/{TAB}");
    let (status, reply) = server.post(&path, &piece(&lines[..6]));
    assert!(status == 200 && reply.ends_with("\r\n\r\n500"), "{reply}");
    let leave = format!("/api/{token}/leave");
    assert_eq!(server.post(&leave, r#"{"keep":true}"#).0, 200);
    let log = folder.path().join("logs/seat/P001-own.mcap");
    let drives = read_log(&log, &IngestSettings::default()).unwrap();
    let time_s = drives[0].recording.time_s();
    assert!((time_s[time_s.len() - 1] - time_s[0] - 5.0).abs() < 0.2);
    let said = read(folder.path(), "seat/notes.csv");
    assert!(said.contains("P001-own"), "{said}");
    let events: Vec<EventRow> = rows(folder.path(), "events.csv");
    let drive: Vec<&str> =
        events.iter().filter(|row| row.page == "own").map(|row| row.what.as_str()).collect();
    assert_eq!((drive.first(), drive.last()), (Some(&"begun"), Some(&"cut short")));
    assert_eq!(events.last().unwrap().what, "left");
    // Pressed again: the same.
    assert_eq!(server.post(&leave, r#"{"keep":true}"#).0, 200);
}

#[test]
fn whoever_leaves_where_they_are_to_agree_is_counted_and_whoever_leaves_later_is_not() {
    let folder = folder();
    let server = Server::open(folder.path());
    let (deleted, kept, later) = (opened(&server), opened(&server), opened(&server));
    let leave = |token: &str, body: &str| {
        let path = format!("/api/{token}/leave");
        assert_eq!(server.post(&path, body).0, 200);
        // The reply was lost.
        assert_eq!(server.post(&path, body).0, 200);
    };
    let not_agreed = folder.path().join("seat/not_agreed.csv");
    assert!(go_on(&server, &later));
    leave(&later, r#"{"keep":true}"#);
    assert!(!not_agreed.exists());
    leave(&deleted, r#"{"keep":false}"#);
    leave(&kept, r#"{"keep":true}"#);
    let path = folder.path().join("seat/consents.csv");
    let agreed = read_consents(&path).unwrap();
    assert_eq!(agreed.len(), 1);
    let text = fs::read_to_string(&not_agreed).unwrap();
    let expected = format!("text_sha256,people\n{},2\n", agreed[0].text_sha256);
    assert_eq!(text, expected);
}

/// A study whose people are learned from first and may be lent to those who ride later.
const LEARNS_AND_LENDS: &str = r#"
[study]
title = "Mine and another's"
[people]
learn = { part = "learn" }
test = { part = "test" }
[style]
score = "mood.total"
[[condition]]
id = "mine"
car = { dial = 0, recorded = true }
[[condition]]
id = "other"
car = { other = "matched", recorded = true }
[baseline]
id = "own"
[protocol]
consent = "consent.md"
debrief = "debrief.md"
before = ["mood"]
practice = { lane_kept_s = 1, passes = 0, at_most_s = 10 }
drive_s = 20
ride_s = 10
"#;

/// That study, in which one person ticked the box, one left it, and one had none.
fn three_agreed() -> tempfile::TempDir {
    let folder = folder_of(LEARNS_AND_LENDS);
    fs::write(folder.path().join("debrief.md"), "It was another's.").unwrap();
    let server = Server::of(open_with(folder.path(), None).unwrap(), |_| {});
    let answers = [
        r#","style_lent":true"#,
        r#","style_lent":false"#,
        // A page from before there was a box.
        "",
    ];
    for answer in answers {
        let token = opened(&server);
        let state = server.state(&token);
        assert!(state["steps"][0]["lend"].is_string(), "{state}");
        let sheet = format!(r#"{{"agreed":true{answer},"seconds":4.5}}"#);
        let agreed = server.post(&format!("/api/{token}/answer/0"), &sheet);
        assert_eq!(agreed.0, 200, "{}", agreed.1);
    }
    folder
}

#[test]
fn whoever_was_learned_from_and_did_not_tick_the_box_lends_nothing_and_no_page_is_told_their_names()
{
    let folder = three_agreed();
    let asked = ["P001-own", "P002-own", "P003-own"];
    let enough = [&asked[..], &["S1-own", "S2-own", "S3-own", "S4-own"]].concat();
    let model = learned_from(folder.path(), &enough);
    let seat = open_with(folder.path(), Some(model)).unwrap();
    assert!(seat.few_donors().unwrap().is_empty());
    let server = Server::of(seat, |_| {});
    let token = opened(&server);
    let (_, served) = server.ask("GET", &format!("/api/{token}/model"), "", &[]);
    let (_, bytes) = served.split_once("\r\n\r\n").unwrap();
    let served = model_file::from_bytes(bytes.as_bytes()).unwrap();
    let names = served.training().iter().map(|t| t.drive.to_string());
    let numbers = (1..=enough.len()).map(|number| format!("D{number}"));
    assert!(names.eq(numbers));
    let state = server.state(&token);
    assert!(!state.to_string().contains("P002"), "{state}");
    // The second and the third that the model learned from.
    let steps = state["steps"].as_array().unwrap().iter();
    let lent: Vec<_> = steps.filter(|step| step["style"]["lent"].is_object()).collect();
    assert_eq!(lent.len(), 1, "{state}");
    let withheld = &lent[0]["style"]["lent"]["withheld"];
    assert_eq!(*withheld, json!(["D2", "D3"]));
}

#[test]
fn where_too_few_lend_theirs_the_seat_opens_and_nobody_new_is_let_in() {
    let folder = three_agreed();
    let drives = |others: usize| {
        let asked = (1..=3).map(|i| format!("P00{i}-own"));
        let drives = asked.chain((0..others).map(|i| format!("S{i}-own")));
        drives.collect::<Vec<_>>()
    };
    let seat = |others: usize| {
        let drives = drives(others);
        let drives: Vec<&str> = drives.iter().map(String::as_str).collect();
        let model = learned_from(folder.path(), &drives);
        open_with(folder.path(), Some(model)).unwrap()
    };
    let few = seat(3);
    let told = few.few_donors().unwrap()[0].with_remedy();
    assert!(
        told.contains("4 drives that the model learned from may be lent") && told.contains("tick"),
        "{told}"
    );
    assert!(matches!(few.let_in(), Err(SeatError::Protocol { .. })));
    // Whom it has can still be forgotten.
    few.forget("P003").unwrap();
    drop(few);
    seat(4).let_in().unwrap();
}

#[test]
fn whoever_is_learned_from_is_asked_for_their_style_and_is_forgotten_with_the_answer() {
    let folder = three_agreed();
    let seat = open_with(folder.path(), None).unwrap();
    let path = folder.path().join("seat/consents.csv");
    let kept = || -> Vec<(String, Option<bool>)> {
        let rows = read_consents(&path).unwrap().into_iter();
        rows.map(|row| (row.participant.to_string(), row.style_lent)).collect()
    };
    let row = |who: &str, style_lent| (who.to_owned(), style_lent);
    let others = [row("P002", Some(false)), row("P003", None)];
    assert_eq!(kept()[0], row("P001", Some(true)));
    assert_eq!(kept()[1..], others);
    seat.forget("P001").unwrap();
    assert_eq!(kept(), others);
}

#[cfg(unix)]
#[test]
fn tables_and_logs_are_readable_by_owner_alone() {
    use std::os::unix::fs::PermissionsExt as _;
    let (folder, server, token) = one_person();
    while go_on(&server, &token) {}
    drop(server);
    let study = maveric_study::DesignFile::read(&folder.path().join("study.toml")).unwrap();
    let answers = study.resolve(&study.design.files().answers);
    let logs = study.resolve(&study.design.files().logs).join("seat");
    let logs = fs::read_dir(logs).unwrap().map(|entry| entry.unwrap().path());
    let files = [answers, study.people_file(None)].into_iter().chain(logs);
    for path in files {
        let mode = fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600, "{}", path.display());
    }
}
