//! Who takes back what they gave: from the page, from the laboratory, after the end, and while the server is busy with it.

use crate::support::{
    STUDY, Server, TAB, entered, folder, folder_of, lab, lab_post, one_person, opened, read,
    replies,
    script::{driven, go_on, piece, up_to},
    tells,
};
use std::{fs, path::Path, thread};

const DELETE: &str = r#"{"keep":false}"#;

/// Names of the files below a folder that hold one of these byte strings.
fn holding(folder: &Path, secrets: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(holding(&path, secrets));
            continue;
        }
        let bytes = fs::read(&path).unwrap();
        let holds = |secret: &&&str| bytes.windows(secret.len()).any(|w| w == secret.as_bytes());
        if let Some(secret) = secrets.iter().find(holds) {
            found.push(format!("{}: {secret}", path.to_string_lossy()));
        }
    }
    found
}

#[test]
fn who_is_through_can_take_everything_back_by_the_link_that_they_keep_and_no_byte_is_left() {
    let folder = folder();
    let server = Server::open(folder.path());
    let (token, other) = (opened(&server), opened(&server));
    let mut lines = Vec::new();
    loop {
        let state = server.state(&token);
        let step = &state["steps"][state["at"].as_u64().unwrap() as usize];
        if step["kind"] == "drive" {
            // Nobody else's pictures came as theirs did.
            lines = driven(step).0;
            for line in &mut lines {
                *line = line.replace("\"drawn\":60", "\"drawn\":31415926");
            }
            let path = format!("/api/{token}/drive/{}/1/{TAB}", state["at"]);
            assert_eq!(server.post(&path, &piece(&lines)).0, 200);
            let done = format!("/api/{token}/done/{}", state["at"]);
            assert_eq!(server.post(&done, "null").0, 200);
        } else if !go_on(&server, &token) {
            break;
        }
    }
    while go_on(&server, &other) {}
    assert!(server.state(&token)["fit"].is_object());
    let secrets = [&*token, "P001-", "P001,2", "P001,pre", &lines[3], "31415926"];
    assert!(holding(folder.path(), &secrets).len() > 4);
    let (status, reply) = server.post(&format!("/api/{token}/leave"), DELETE);
    assert!(status == 200 && reply.ends_with("\"deleted\""), "{reply}");
    // The reply was lost: the same request again has the same answer, and so has the page.
    let (status, reply) = server.post(&format!("/api/{token}/leave"), DELETE);
    assert!(status == 200 && reply.ends_with("\"deleted\""), "{reply}");
    assert_eq!(server.state(&token)["ended"], "deleted");
    assert_eq!(holding(folder.path(), &secrets), Vec::<String>::new());
    let lab = lab(&server);
    assert!(!lab.contains("P001") && lab.contains("P002"), "{lab}");
    // Whoever stays has everything, and the id is nobody's again.
    let people = read(folder.path(), "participants.csv");
    assert_eq!(people, "participant,study,order\nP002,2,sporty calm\n");
    drop(server);
    let server = Server::open(folder.path());
    assert_eq!(server.state(&token)["ended"], "deleted");
    let third = opened(&server);
    assert!(go_on(&server, &third));
    server.seat.write_files().unwrap();
    let people = read(folder.path(), "participants.csv");
    assert!(people.contains("P003") && !people.contains("P001"), "{people}");
    assert_eq!(holding(folder.path(), &secrets), Vec::<String>::new());
}

#[test]
fn who_takes_everything_back_while_their_drive_is_being_written_leaves_nothing() {
    let (folder, server, token) = one_person();
    up_to(&server, &token, 4);
    let (lines, style) = driven(&server.state(&token)["steps"][4]);
    let path = format!("/api/{token}/drive/4/1/{TAB}");
    assert_eq!(server.post(&path, &piece(&lines)).0, 200);
    server.post(&format!("/api/{token}/fit"), &style.unwrap());
    thread::scope(|scope| {
        let done = scope.spawn(|| server.post(&format!("/api/{token}/done/4"), "null"));
        let left = scope.spawn(|| server.post(&format!("/api/{token}/leave"), DELETE));
        assert_eq!(left.join().unwrap().0, 200);
        done.join().unwrap();
    });
    let secrets = [&*token, "P001-", "P001,2", "P001,pre", &lines[3]];
    assert_eq!(holding(folder.path(), &secrets), Vec::<String>::new());
    let names = |name: &str| fs::read_dir(folder.path().join(name)).into_iter().flatten().count();
    assert_eq!(names("logs/seat"), 0);
}

#[test]
fn after_the_day_that_the_consent_names_it_is_said_that_nothing_can_be_taken_back() {
    let until =
        |day: &str| STUDY.replace("drive_s", &format!("withdraw_until = \"{day}\"\ndrive_s"));
    let folder = folder_of(&until("2001-02-03"));
    let server = Server::open(folder.path());
    tells(&server.seat.withdrawal_over().unwrap(), &["2001-02-03"]);
    let (through, driving) = (opened(&server), opened(&server));
    while go_on(&server, &through) {}
    assert_eq!(server.state(&through)["withdraw"]["until"], "2001-02-03");
    assert_eq!(server.state(&through)["withdraw"]["open"], false);
    replies(server.post(&format!("/api/{through}/leave"), DELETE), 403, "2001-02-03");
    assert_eq!(server.state(&through)["ended"], "done");
    // Who is not through may always leave with everything.
    assert_eq!(server.post(&format!("/api/{driving}/leave"), DELETE).0, 200);
    let folder = folder_of(&until("2999-12-31"));
    let server = Server::open(folder.path());
    assert_eq!(server.seat.withdrawal_over(), None);
    let token = opened(&server);
    let consent = server.state(&token)["steps"][0]["text"].to_string();
    assert!(consent.contains("2999-12-31"), "{consent}");
    assert_eq!(server.state(&token)["withdraw"]["open"], true);
}

#[test]
fn the_laboratory_can_forget_somebody_and_is_asked_first() {
    let (folder, server, token) = one_person();
    while go_on(&server, &token) {}
    fs::write(folder.path().join("memo.txt"), "P002: as ill as p001").unwrap();
    let cookie = entered(&server);
    let with = &[("Cookie", cookie.as_str())];
    let (_, asks) = server.ask("GET", "/lab/forget/P001", "", with);
    tells(&asks, &["cannot be undone", "handed out"]);
    assert_eq!(server.state(&token)["ended"], "done");
    let (status, _) = server.ask("POST", "/lab/forget/P001", "", &[]);
    assert!(status != 200 && server.state(&token)["ended"] == "done");
    let (status, reply) = server.ask("POST", "/lab/forget/P001", "", with);
    assert_eq!(status, 200, "{reply}");
    tells(&reply, &["still name P001", "memo.txt"]);
    assert_eq!(server.state(&token)["ended"], "deleted");
    for method in ["GET", "POST"] {
        replies(server.ask(method, "/lab/forget/P009", "", with), 400, "P009");
    }
}

#[test]
fn notes_that_name_somebody_go_with_them_and_those_of_others_stay() {
    let folder = folder();
    let db = folder.path().join("seat/seat.db");
    let note = |server: &Server, text: &str| {
        let (status, reply) = lab_post(server, "/lab/note", &format!("note={text}"));
        assert_eq!(status, 303, "{reply}");
    };
    let server = Server::open(folder.path());
    for _ in 0..2 {
        let token = opened(&server);
        while go_on(&server, &token) {}
    }
    note(&server, "P001:+zebra-sick");
    note(&server, "as+p001+said:+zebra-sick");
    note(&server, "P002+and+P001x:+lion-well");
    server.seat.write_files().unwrap();
    assert!(holding(folder.path(), &["zebra-sick"]).len() >= 2);
    // From the laboratory, while the seat is open.
    assert_eq!(lab_post(&server, "/lab/forget/P001", "").0, 200);
    assert_eq!(holding(folder.path(), &["zebra-sick"]), [""; 0]);
    let table = || read(folder.path(), "seat/notes.csv");
    assert!(table().contains("lion-well"), "{}", table());
    // By the command, while it is closed.
    drop(server);
    let study = maveric_study::DesignFile::read(&folder.path().join("study.toml")).unwrap();
    maveric_seat::forget(&study, &db, "P002").unwrap();
    assert_eq!(holding(folder.path(), &["lion-well"]), [""; 0]);
}

#[test]
fn rows_that_somebody_deleted_by_hand_are_not_written_back() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let server = Server::open(folder.path());
    for _ in 0..2 {
        let token = opened(&server);
        while go_on(&server, &token) {}
    }
    drop(server);
    for name in ["participants.csv", "surveys/answers.csv"] {
        let text = fs::read_to_string(at(name)).unwrap();
        let rows = text.lines().filter(|line| !line.starts_with("P001"));
        fs::write(at(name), rows.map(|r| r.to_owned() + "\n").collect::<String>()).unwrap();
    }
    // A cell that was put right by hand stays right, too.
    let answers = fs::read_to_string(at("surveys/answers.csv")).unwrap();
    let right = answers.replace("P002,pre,mood,1,4", "P002,pre,mood,1,5");
    fs::write(at("surveys/answers.csv"), &right).unwrap();
    for _ in 0..2 {
        let server = Server::open(folder.path());
        server.seat.write_files().unwrap();
        let people = fs::read_to_string(at("participants.csv")).unwrap();
        assert_eq!(people, "participant,study,order\nP002,2,sporty calm\n");
        assert_eq!(fs::read_to_string(at("surveys/answers.csv")).unwrap(), right);
        let lab = lab(&server);
        tells(&lab, &["taken out of participants.csv by hand"]);
    }
}

#[test]
fn somebody_is_forgotten_while_the_seat_is_closed_and_a_name_misspelt_is_said() {
    let folder = folder();
    let state = folder.path().join("seat/seat.db");
    let study = maveric_study::DesignFile::read(&folder.path().join("study.toml")).unwrap();
    let server = Server::open(folder.path());
    let token = opened(&server);
    while go_on(&server, &token) {}
    let open = maveric_seat::forget(&study, &state, "P001").unwrap_err();
    assert!(open.to_string().contains("another seat"), "{open}");
    drop(server);
    let misspelt = maveric_seat::forget(&study, &state, "P01").unwrap_err();
    assert!(misspelt.suggestion().unwrap().contains("`P001`"));
    let gone = maveric_seat::forget(&study, &state, "P001").unwrap();
    assert!(gone.in_seat && gone.study.unwrap().left.is_empty());
    let secrets = [&*token, "P001-", "P001,2", "P001,pre"];
    assert_eq!(holding(folder.path(), &secrets), Vec::<String>::new());
    // Again, as after a run that was in the way.
    assert!(maveric_seat::forget(&study, &state, "P001").is_ok());
}
