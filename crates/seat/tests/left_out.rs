//! What the experimenter leaves out: a step that is skipped, a part that is aborted.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod support;

use std::fs;
use support::{Server, TAB, driven, entered, folder, go_on, opened};

/// Goes on until the step is of this kind; its number from 0.
fn until(server: &Server, token: &str, kind: &str) -> u64 {
    loop {
        let state = server.state(token);
        let at = state["at"].as_u64().unwrap();
        if state["steps"][at as usize]["kind"] == kind {
            return at;
        }
        assert!(go_on(server, token), "no step is {kind}");
    }
}

struct Lab<'a> {
    server: &'a Server,
    cookie: String,
}

impl Lab<'_> {
    fn act(&self, step: u64, act: &str, reason: &str) -> (u16, String) {
        let (path, body) = (
            format!("/lab/step/P001/{step}"),
            format!("act={act}&reason={reason}"),
        );
        self.server
            .ask("POST", &path, &body, &[("Cookie", &self.cookie)])
    }
}

#[test]
fn a_ride_that_is_skipped_is_kept_as_far_as_it_went_and_left_out_by_name_and_the_person_goes_on() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let lab = Lab {
        server: &server,
        cookie: entered(&server),
    };
    let ride = until(&server, &token, "ride");
    let state = server.state(&token);
    let (lines, _) = driven(&state["steps"][ride as usize]);
    let path = format!("/api/{token}/drive/{ride}/1/{TAB}");
    assert_eq!(server.post(&path, &(lines[..5].join("\n") + "\n")).0, 200);
    // Not without the password, and not without a reason.
    let body = "act=skip&reason=x";
    server.post(&format!("/lab/step/P001/{ride}"), body);
    let (status, reply) = lab.act(ride, "skip", "+");
    assert!(status == 400 && reply.contains("say why"), "{reply}");
    assert_eq!(server.state(&token)["at"], ride);
    let (_, asks) = server.ask(
        "GET",
        &format!("/lab/step/P001/{ride}"),
        "",
        &[("Cookie", &lab.cookie)],
    );
    assert!(
        asks.contains(&format!("Step {} of P001", ride + 1)),
        "{asks}"
    );
    assert_eq!(lab.act(ride, "skip", "the+wheel+came+loose").0, 303);
    assert_eq!(server.state(&token)["at"], ride + 1);
    // The page that drives is told so, and asks where it is.
    for (path, body) in [
        (path.clone(), lines[5].clone() + "\n"),
        (format!("/api/{token}/done/{ride}"), "null".to_owned()),
    ] {
        let (status, reply) = server.post(&path, &body);
        assert!(
            status == 410 && reply.contains("maveric-refused: over"),
            "{reply}"
        );
    }
    // A page that was old does nothing to the step after it.
    let (status, reply) = lab.act(ride, "skip", "again");
    assert!(status == 400 && reply.contains("by now"), "{reply}");
    while go_on(&server, &token) {}
    assert_eq!(server.state(&token)["ended"], "done");
    let (status, reply) = lab.act(ride, "abort", "late");
    assert!(
        status == 400 && reply.contains("has ended: done"),
        "{reply}"
    );

    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let stopped = read("seat/stopped.csv");
    assert_eq!(
        stopped,
        "participant,condition,time_s,reason\nP001,calm,4.0,skipped: the wheel came loose\n"
    );
    let events = read("seat/events.csv");
    let row = events.lines().find(|l| l.contains("skipped")).unwrap();
    let number = ride + 1;
    assert!(
        row.starts_with(&format!(
            "P001,{number},calm,,,4.0,skipped: the wheel came loose,,20"
        )),
        "{row}"
    );
    assert!(events.contains(",sporty,,1,10.0,ended,"), "{events}");
    let notes = read("seat/notes.csv");
    assert!(
        notes.contains(&format!(
            "P001,seat,step {number}: skipped: the wheel came loose"
        )),
        "{notes}"
    );
    for ride in ["calm", "sporty"] {
        assert!(
            folder
                .path()
                .join(format!("logs/seat/P001-{ride}.mcap"))
                .is_file()
        );
    }
    server.seat.forget("P001").unwrap();
    let state = fs::read(folder.path().join("seat/seat.db")).unwrap();
    let reason = b"came loose";
    assert!(!state.windows(reason.len()).any(|bytes| bytes == reason));
}

#[test]
fn who_is_aborted_drives_no_more_is_told_the_aftercare_and_is_through() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let lab = Lab {
        server: &server,
        cookie: entered(&server),
    };
    let drive = until(&server, &token, "drive");
    assert_eq!(server.state(&token)["aborted"], false);
    assert_eq!(lab.act(drive, "abort", "fire+alarm").0, 303);
    let state = server.state(&token);
    // Their page says who ended it: nobody thanks them for saying that they feel unwell.
    assert_eq!(state["aborted"], true);
    let at = state["at"].as_u64().unwrap();
    assert_eq!(state["steps"][at as usize]["kind"], "aftercare");
    let (status, reply) = lab.act(at, "abort", "again");
    assert!(
        status == 400 && reply.contains("nothing is driven any more"),
        "{reply}"
    );
    while go_on(&server, &token) {}
    assert_eq!(server.state(&token)["ended"], "done");
    let stopped = fs::read_to_string(folder.path().join("seat/stopped.csv")).unwrap();
    assert!(
        stopped.ends_with("\nP001,own,0.0,aborted: fire alarm\n"),
        "{stopped}"
    );
}

#[test]
fn what_nobody_goes_on_without_is_not_skipped_and_a_skipped_sheet_takes_no_answer() {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let lab = Lab {
        server: &server,
        cookie: entered(&server),
    };
    let refused = |step: u64, act: &str, why: &str| {
        let (status, reply) = lab.act(step, act, "because");
        assert!(status == 400 && reply.contains(why), "{why}: {reply}");
        assert_eq!(server.state(&token)["at"], step);
    };
    refused(0, "skip", "has not agreed");
    refused(0, "abort", "has not agreed yet");
    refused(0, "again", "expected skip, repeat, abort or extend");
    refused(0, "repeat", "nothing was driven yet");
    let sheet = until(&server, &token, "scale");
    assert_eq!(lab.act(sheet, "skip", "asked+on+paper").0, 303);
    let answers = r#"{"answers":[4,null],"seconds":6}"#;
    assert_eq!(
        server
            .post(&format!("/api/{token}/answer/{sheet}"), answers)
            .0,
        410
    );
    let practice = until(&server, &token, "practice");
    assert_eq!(lab.act(practice, "skip", "drove+here+before").0, 303);
    let drive = until(&server, &token, "drive");
    refused(drive, "skip", "the rides need the style");
    // The last before the aftercare goes past it.
    until(&server, &token, "ride");
    go_on(&server, &token);
    until(&server, &token, "ride");
    go_on(&server, &token);
    let last = until(&server, &token, "scale");
    assert_eq!(lab.act(last, "skip", "tired").0, 303);
    let state = server.state(&token);
    let at = state["at"].as_u64().unwrap();
    assert_eq!(state["steps"][at as usize]["kind"], "thanks");
    refused(at, "skip", "this is the end");
    while go_on(&server, &token) {}
    let surveys = fs::read_to_string(folder.path().join("surveys/answers.csv")).unwrap();
    assert!(
        !surveys.contains("P001,pre,") && surveys.contains("P001,calm,"),
        "{surveys}"
    );
    assert!(
        !folder.path().join("seat/stopped.csv").exists(),
        "nothing of the analysis was left out"
    );
}
