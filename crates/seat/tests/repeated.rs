//! What the experimenter has driven again.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod support;

use serde_json::Value;
use std::{fs, path::Path};
use support::{Server, TAB, driven, entered, folder, folder_of, go_on, opened};

fn step(server: &Server, token: &str) -> (u64, Value) {
    let state = server.state(token);
    let at = state["at"].as_u64().unwrap();
    (at, state["steps"][at as usize].clone())
}

fn until(server: &Server, token: &str, kind: &str) -> u64 {
    loop {
        let (at, step) = step(server, token);
        if step["kind"] == kind {
            return at;
        }
        assert!(go_on(server, token), "no step is {kind}");
    }
}

fn repeat(server: &Server, at: u64, reason: &str) -> (u16, String) {
    let cookie = entered(server);
    let body = format!("act=repeat&reason={reason}");
    let path = format!("/lab/step/P001/{at}");
    server.ask("POST", &path, &body, &[("Cookie", &cookie)])
}

fn exists(folder: &Path, name: &str) -> bool {
    folder.join(name).is_file()
}

#[test]
fn a_ride_that_is_driven_again_counts_and_the_one_before_is_kept_and_marked() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let ride = until(&server, &token, "ride");
    // The first order rides `sporty` first.
    let state = server.state(&token);
    let (lines, _) = driven(&state["steps"][ride as usize]);
    let send = |attempt: u32, lines: &[String]| {
        let path = format!("/api/{token}/drive/{ride}/{attempt}/{TAB}");
        server.post(&path, &(lines.join("\n") + "\n"))
    };
    assert_eq!(send(1, &lines).0, 200);
    // Without a word of the experimenter's nobody drives a whole drive twice.
    let (status, reply) = send(2, &lines);
    assert!(
        status == 400 && reply.contains("has come to its end"),
        "{reply}"
    );
    assert_eq!(
        server.post(&format!("/api/{token}/done/{ride}"), "null").0,
        200
    );
    let name = ["calm", "sporty"]
        .map(|condition| format!("P001-{condition}"))
        .into_iter()
        .find(|name| exists(folder.path(), &format!("logs/seat/{name}.mcap")))
        .unwrap();
    let log = format!("logs/seat/{name}.mcap");
    let first = fs::read_to_string(folder.path().join(format!("seat/{name}.jsonl"))).unwrap();
    let (status, reply) = repeat(&server, ride + 1, "+");
    assert!(status == 400 && reply.contains("say why"), "{reply}");
    assert_eq!(repeat(&server, ride + 1, "a+fly+in+the+eye").0, 303);
    let state = server.state(&token);
    assert_eq!(
        (&state["at"], &state["attempts"], &state["whole"]),
        (&ride.into(), &1.into(), &false.into())
    );
    // Nothing of it is analysed until it was driven again; what was driven is kept under another name.
    assert!(!exists(folder.path(), &log));
    assert!(!exists(folder.path(), &format!("seat/{name}.jsonl")));
    let kept = folder.path().join(format!("seat/{name}.repeated1.jsonl"));
    assert_eq!(fs::read_to_string(&kept).unwrap(), first);
    // Whoever is on the page after it is told that it is over; so is a tab that still sends the drive before.
    let answers = r#"{"answers":[4,null],"seconds":6}"#;
    let after = format!("/api/{token}/answer/{}", ride + 1);
    assert_eq!(server.post(&after, answers).0, 410);
    assert_eq!(send(1, &lines).0, 410);
    let (status, reply) = repeat(&server, ride, "again");
    assert!(
        status == 400 && reply.contains("driven again already"),
        "{reply}"
    );
    while go_on(&server, &token) {}
    assert_eq!(server.state(&token)["ended"], "done");
    assert!(exists(folder.path(), &log) && kept.is_file());
    assert!(exists(folder.path(), &format!("seat/{name}.jsonl")));
    let events = fs::read_to_string(folder.path().join("seat/events.csv")).unwrap();
    let of_ride = |attempt: u32, what: &str| {
        let start = format!("P001,{},", ride + 1);
        let middle = format!(",{attempt},");
        let mut rows = events.lines().filter(|row| row.starts_with(&start));
        rows.any(|row| row.contains(&middle) && row.contains(what))
    };
    assert!(of_ride(1, "repeated: a fly in the eye"), "{events}");
    assert!(of_ride(1, ",ended,") && of_ride(2, ",ended,"), "{events}");
    // What is driven again is no drive that was stopped.
    assert!(!exists(folder.path(), "seat/stopped.csv"));
    server.seat.forget("P001").unwrap();
    assert!(!kept.exists());
    let state = fs::read(folder.path().join("seat/seat.db")).unwrap();
    let reason = b"fly in the eye";
    assert!(!state.windows(reason.len()).any(|bytes| bytes == reason));
}

#[test]
fn a_drive_that_is_driven_again_is_learned_from_again_and_one_that_goes_on_is_cut_short() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let practice = until(&server, &token, "practice");
    let (lines, _) = driven(&step(&server, &token).1);
    let path = format!("/api/{token}/drive/{practice}/1/{TAB}");
    assert_eq!(server.post(&path, &(lines[..4].join("\n") + "\n")).0, 200);
    assert_eq!(repeat(&server, practice, "hands+off").0, 303);
    assert_eq!(server.post(&path, &(lines[4..].join("\n") + "\n")).0, 410);
    let drive = until(&server, &token, "drive");
    assert!(go_on(&server, &token));
    let (at, _) = step(&server, &token);
    assert_eq!(at, drive + 1, "a ride, and nothing of it was driven");
    assert_eq!(repeat(&server, at, "the+wrong+foot").0, 303);
    assert!(!exists(folder.path(), "logs/seat/P001-own.mcap"));
    while go_on(&server, &token) {}
    assert_eq!(server.state(&token)["ended"], "done");
    assert!(exists(folder.path(), "logs/seat/P001-own.mcap"));
    assert!(exists(folder.path(), "seat/P001-own.repeated1.jsonl"));
}

#[test]
fn nothing_is_driven_again_once_something_was_answered_after_it_or_stands_in_the_tables() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let refused = |at: u64, why: &str| {
        let (status, reply) = repeat(&server, at, "because");
        assert!(status == 400 && reply.contains(why), "{why}: {reply}");
        assert_eq!(server.state(&token)["at"], at);
    };
    refused(0, "nothing was driven yet");
    let practice = until(&server, &token, "practice");
    refused(practice, "nothing was driven yet");
    until(&server, &token, "ride");
    assert!(go_on(&server, &token) && go_on(&server, &token));
    let (next, ride) = step(&server, &token);
    assert_eq!(ride["kind"], "ride");
    refused(next, "was answered already");

    let study = support::STUDY.replace(
        "[protocol]\n",
        "[protocol]\nprobe = { scale = \"misc\", every_s = 12 }\n",
    );
    let probed = folder_of(&study.replace("ride_s = 10", "ride_s = 20"));
    fs::write(probed.path().join("scales/misc.toml"), support::MISC).unwrap();
    let server = Server::open(probed.path());
    let token = opened(&server);
    let ride = until(&server, &token, "ride");
    assert!(go_on(&server, &token));
    server.seat.write_files().unwrap();
    let (status, reply) = repeat(&server, ride + 1, "because");
    assert!(
        status == 400 && reply.contains("stands in the study"),
        "{reply}"
    );
}
