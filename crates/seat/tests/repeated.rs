//! What the experimenter has driven again.

use crate::support::{
    Server, TAB, folder_of, lab_post, one_person, opened, read, replies,
    script::{driven, finish, go_on, here, piece, until},
};
use std::{fs, path::Path};

fn repeat(server: &Server, at: u64, reason: &str) -> (u16, String) {
    let body = format!("act=repeat&reason={reason}");
    lab_post(server, &format!("/lab/step/P001/{at}"), &body)
}

fn exists(folder: &Path, name: &str) -> bool {
    folder.join(name).is_file()
}

#[test]
fn a_ride_that_is_driven_again_counts_and_the_one_before_is_kept_and_marked() {
    let (folder, server, token) = one_person();
    let (ride, _) = until(&server, &token, "ride");
    // The first order rides `sporty` first.
    let state = server.state(&token);
    let (lines, _) = driven(&state["steps"][ride as usize]);
    let send = |attempt: u32, lines: &[String]| {
        let path = format!("/api/{token}/drive/{ride}/{attempt}/{TAB}");
        server.post(&path, &piece(lines))
    };
    assert_eq!(send(1, &lines).0, 200);
    // Without a word of the experimenter's nobody drives a whole drive twice.
    replies(send(2, &lines), 400, "has come to its end");
    assert_eq!(server.post(&format!("/api/{token}/done/{ride}"), "null").0, 200);
    let name = ["calm", "sporty"]
        .map(|condition| format!("P001-{condition}"))
        .into_iter()
        .find(|name| exists(folder.path(), &format!("logs/seat/{name}.mcap")))
        .unwrap();
    let log = format!("logs/seat/{name}.mcap");
    let first = read(folder.path(), &format!("seat/{name}.jsonl"));
    replies(repeat(&server, ride + 1, "+"), 400, "say why");
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
    replies(repeat(&server, ride, "again"), 400, "driven again already");
    finish(&server, &token);
    assert!(exists(folder.path(), &log) && kept.is_file());
    assert!(exists(folder.path(), &format!("seat/{name}.jsonl")));
    let events = read(folder.path(), "seat/events.csv");
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
    let (folder, server, token) = one_person();
    let (practice, _) = until(&server, &token, "practice");
    let (lines, _) = driven(&here(&server, &token).1);
    let path = format!("/api/{token}/drive/{practice}/1/{TAB}");
    assert_eq!(server.post(&path, &piece(&lines[..4])).0, 200);
    assert_eq!(repeat(&server, practice, "hands+off").0, 303);
    assert_eq!(server.post(&path, &piece(&lines[4..])).0, 410);
    let (drive, _) = until(&server, &token, "drive");
    assert!(go_on(&server, &token));
    let (at, _) = here(&server, &token);
    assert_eq!(at, drive + 1, "a ride, and nothing of it was driven");
    assert_eq!(repeat(&server, at, "the+wrong+foot").0, 303);
    assert!(!exists(folder.path(), "logs/seat/P001-own.mcap"));
    finish(&server, &token);
    assert!(exists(folder.path(), "logs/seat/P001-own.mcap"));
    assert!(exists(folder.path(), "seat/P001-own.repeated1.jsonl"));
}

#[test]
fn nothing_is_driven_again_once_something_was_answered_after_it_or_stands_in_the_tables() {
    let (_folder, server, token) = one_person();
    let refused = |at: u64, why: &str| {
        replies(repeat(&server, at, "because"), 400, why);
        assert_eq!(server.state(&token)["at"], at);
    };
    refused(0, "nothing was driven yet");
    let (practice, _) = until(&server, &token, "practice");
    refused(practice, "nothing was driven yet");
    until(&server, &token, "ride");
    assert!(go_on(&server, &token) && go_on(&server, &token));
    let (next, ride) = here(&server, &token);
    assert_eq!(ride["kind"], "ride");
    refused(next, "was answered already");

    let study = crate::support::STUDY
        .replace("[protocol]\n", "[protocol]\nprobe = { scale = \"misc\", every_s = 12 }\n");
    let probed = folder_of(&study.replace("ride_s = 10", "ride_s = 20"));
    fs::write(probed.path().join("scales/misc.toml"), crate::support::MISC).unwrap();
    let server = Server::open(probed.path());
    let token = opened(&server);
    let (ride, _) = until(&server, &token, "ride");
    assert!(go_on(&server, &token));
    server.seat.write_files().unwrap();
    replies(repeat(&server, ride + 1, "because"), 400, "stands in the study");
}
