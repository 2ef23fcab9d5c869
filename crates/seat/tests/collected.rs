//! What people do beside answering and driving stands in tables: events, consents, notes.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod support;

use maveric_ingest::{IngestSettings, read_log};
use maveric_study::tables::{
    Table,
    collected::{ConsentRow, EventRow, NoteRow},
};
use std::{fs, path::Path};
use support::*;

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
    assert!(
        sheets
            .iter()
            .all(|row| row.page == "mood" && row.value == Some(6.0))
    );
    let dial = of("P001", "dial");
    assert_eq!((dial.len(), dial[0].page.as_str()), (1, "sporty"));
    assert_eq!((dial[0].time_s, dial[0].value), (Some(3.0), Some(5.0)));
    let practice: Vec<&str> = events
        .iter()
        .filter(|row| row.page == "practice")
        .map(|row| row.what.as_str())
        .collect();
    assert_eq!(practice.first(), Some(&"begun"));
    assert!(
        practice.last().unwrap().starts_with("practice"),
        "{practice:?}"
    );
    assert_eq!(of("P001", "done").len(), 1);
    assert_eq!(
        (of("P002", "answered").len(), of("P002", "done").len()),
        (1, 0)
    );

    let consents: Vec<ConsentRow> = rows(folder.path(), "consents.csv");
    assert_eq!(consents.len(), 2);
    assert!(
        consents
            .iter()
            .all(|c| c.text_sha256.len() == 64 && c.at.is_some())
    );
    assert_eq!(consents[0].text_sha256, consents[1].text_sha256);
    let notes: Vec<NoteRow> = rows(folder.path(), "notes.csv");
    let note = notes.iter().find(|note| note.by == "experimenter").unwrap();
    assert_eq!(
        (note.text.as_str(), &note.participant),
        ("the window was open", &None)
    );
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
    let second: Vec<EventRow> = events
        .into_iter()
        .filter(|r| r.participant.as_str() == "P002")
        .collect();
    assert_eq!(left, second);
}

#[test]
fn what_was_driven_before_somebody_left_is_a_log_where_it_is_kept() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let step = loop {
        let state = server.state(&token);
        let at = state["at"].as_u64().unwrap();
        let step = state["steps"][at as usize].clone();
        if step["kind"] == "drive" {
            break (at, step);
        }
        assert!(go_on(&server, &token));
    };
    let (lines, _) = driven(&step.1);
    let path = format!("/api/{token}/drive/{}/1/{TAB}", step.0);
    let (status, reply) = server.post(&path, &(lines[..6].join("\n") + "\n"));
    assert!(status == 200 && reply.ends_with("\r\n\r\n500"), "{reply}");
    let leave = format!("/api/{token}/leave");
    assert_eq!(server.post(&leave, r#"{"keep":true}"#).0, 200);
    let log = folder.path().join("logs/seat/P001-own.mcap");
    let read = read_log(&log, &IngestSettings::default()).unwrap();
    let time_s = read[0].recording.time_s();
    assert!((time_s[time_s.len() - 1] - time_s[0] - 5.0).abs() < 0.2);
    let said = fs::read_to_string(folder.path().join("seat/notes.csv")).unwrap();
    assert!(said.contains("P001-own"), "{said}");
    let events: Vec<EventRow> = rows(folder.path(), "events.csv");
    let drive: Vec<&str> = events
        .iter()
        .filter(|row| row.page == "own")
        .map(|row| row.what.as_str())
        .collect();
    assert_eq!(
        (drive.first(), drive.last()),
        (Some(&"begun"), Some(&"cut short"))
    );
    assert_eq!(events.last().unwrap().what, "left");
    // Pressed again: the same.
    assert_eq!(server.post(&leave, r#"{"keep":true}"#).0, 200);
}
