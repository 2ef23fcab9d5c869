//! What the experimenter leaves out: a step that is skipped, a part that is aborted.

use crate::support::{
    Server, TAB, entered, lab_post, one_person, read, replies,
    script::{driven, finish, go_on, here, piece, until},
    tells,
};
use std::fs;

/// What the experimenter does at a step of the first person.
fn act(server: &Server, step: u64, act: &str, reason: &str) -> (u16, String) {
    let body = format!("act={act}&reason={reason}");
    lab_post(server, &format!("/lab/step/P001/{step}"), &body)
}

#[test]
fn a_ride_that_is_skipped_is_kept_as_far_as_it_went_and_left_out_by_name_and_the_person_goes_on() {
    let (folder, server, token) = one_person();
    let (ride, _) = until(&server, &token, "ride");
    let state = server.state(&token);
    let (lines, _) = driven(&state["steps"][ride as usize]);
    let path = format!("/api/{token}/drive/{ride}/1/{TAB}");
    assert_eq!(server.post(&path, &piece(&lines[..5])).0, 200);
    // Not without the password, and not without a reason.
    let body = "act=skip&reason=x";
    server.post(&format!("/lab/step/P001/{ride}"), body);
    replies(act(&server, ride, "skip", "+"), 400, "say why");
    assert_eq!(server.state(&token)["at"], ride);
    let (_, asks) =
        server.ask("GET", &format!("/lab/step/P001/{ride}"), "", &[("Cookie", &entered(&server))]);
    tells(&asks, &[&format!("Step {} of P001", ride + 1)]);
    // A form each: Enter in a field of one does nothing of another.
    for act in ["skip", "repeat", "abort", "extend"] {
        let begins =
            format!("<form method=\"post\"><input type=\"hidden\" name=\"act\" value=\"{act}\">");
        assert_eq!(asks.matches(&begins).count(), 1, "{asks}");
    }
    assert_eq!(asks.matches("name=\"act\"").count(), 4, "{asks}");
    assert_eq!(act(&server, ride, "skip", "the+wheel+came+loose").0, 303);
    assert_eq!(server.state(&token)["at"], ride + 1);
    // The page that drives is told so, and asks where it is.
    for (path, body) in [
        (path.clone(), lines[5].clone() + "\n"),
        (format!("/api/{token}/done/{ride}"), "null".to_owned()),
    ] {
        replies(server.post(&path, &body), 410, "maveric-refused: over");
    }
    // A page that was old does nothing to the step after it.
    replies(act(&server, ride, "skip", "again"), 400, "by now");
    finish(&server, &token);
    replies(act(&server, ride, "abort", "late"), 400, "has ended: done");

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
        row.starts_with(&format!("P001,{number},calm,,,4.0,skipped: the wheel came loose,,20")),
        "{row}"
    );
    assert!(events.contains(",sporty,,1,10.0,ended,"), "{events}");
    let notes = read("seat/notes.csv");
    assert!(
        notes.contains(&format!("P001,seat,step {number}: skipped: the wheel came loose")),
        "{notes}"
    );
    for ride in ["calm", "sporty"] {
        assert!(folder.path().join(format!("logs/seat/P001-{ride}.mcap")).is_file());
    }
    server.seat.forget("P001").unwrap();
    let state = fs::read(folder.path().join("seat/seat.db")).unwrap();
    let reason = b"came loose";
    assert!(!state.windows(reason.len()).any(|bytes| bytes == reason));
}

#[test]
fn who_is_aborted_drives_no_more_is_told_the_aftercare_and_is_through() {
    let (folder, server, token) = one_person();
    let (drive, _) = until(&server, &token, "drive");
    assert_eq!(server.state(&token)["aborted"], false);
    assert_eq!(act(&server, drive, "abort", "fire+alarm").0, 303);
    let state = server.state(&token);
    // Their page says who ended it: nobody thanks them for saying that they feel unwell.
    assert_eq!(state["aborted"], true);
    let at = state["at"].as_u64().unwrap();
    assert_eq!(state["steps"][at as usize]["kind"], "aftercare");
    replies(act(&server, at, "abort", "again"), 400, "nothing is driven any more");
    finish(&server, &token);
    let stopped = read(folder.path(), "seat/stopped.csv");
    assert!(stopped.ends_with("\nP001,own,0.0,aborted: fire alarm\n"), "{stopped}");
}

#[test]
fn what_nobody_goes_on_without_is_not_skipped_and_a_skipped_sheet_takes_no_answer() {
    let (folder, server, token) = one_person();
    let refused = |step: u64, what: &str, why: &str| {
        replies(act(&server, step, what, "because"), 400, why);
        assert_eq!(server.state(&token)["at"], step);
    };
    refused(0, "skip", "has not agreed");
    refused(0, "abort", "has not agreed yet");
    refused(0, "again", "expected skip, repeat, abort or extend");
    refused(0, "repeat", "nothing was driven yet");
    let (sheet, _) = until(&server, &token, "scale");
    assert_eq!(act(&server, sheet, "skip", "asked+on+paper").0, 303);
    let answers = r#"{"answers":[4,null],"seconds":6}"#;
    assert_eq!(server.post(&format!("/api/{token}/answer/{sheet}"), answers).0, 410);
    let (practice, _) = until(&server, &token, "practice");
    assert_eq!(act(&server, practice, "skip", "drove+here+before").0, 303);
    let (drive, _) = until(&server, &token, "drive");
    refused(drive, "skip", "the rides need the style");
    // The last before the aftercare goes past it.
    until(&server, &token, "ride");
    go_on(&server, &token);
    until(&server, &token, "ride");
    go_on(&server, &token);
    let (last, _) = until(&server, &token, "scale");
    assert_eq!(act(&server, last, "skip", "tired").0, 303);
    let state = server.state(&token);
    let at = state["at"].as_u64().unwrap();
    assert_eq!(state["steps"][at as usize]["kind"], "thanks");
    refused(at, "skip", "this is the end");
    while go_on(&server, &token) {}
    let surveys = read(folder.path(), "surveys/answers.csv");
    assert!(!surveys.contains("P001,pre,") && surveys.contains("P001,calm,"), "{surveys}");
    assert!(
        !folder.path().join("seat/stopped.csv").exists(),
        "nothing of the analysis was left out"
    );
}

#[test]
fn nobody_is_asked_about_a_ride_that_was_skipped_before_it_began() {
    let (folder, server, token) = one_person();
    let (ride, _) = until(&server, &token, "ride");
    assert_eq!(act(&server, ride, "skip", "no+picture").0, 303);
    let (at, next) = here(&server, &token);
    assert_eq!((at, next["kind"].as_str()), (ride + 2, Some("ride")));
    let late = format!("/api/{token}/answer/{}", ride + 1);
    let answers = r#"{"answers":[4,null],"seconds":6}"#;
    assert_eq!(server.post(&late, answers).0, 410);
    finish(&server, &token);
    let surveys = read(folder.path(), "surveys/answers.csv");
    assert!(!surveys.contains("P001,calm,") && surveys.contains("P001,sporty,"), "{surveys}");
    let stopped = read(folder.path(), "seat/stopped.csv");
    assert!(stopped.ends_with("\nP001,calm,0.0,skipped: no picture\n"), "{stopped}");
}
