//! Who comes from a platform that pays: one link for each id, which stands in one file alone, and the way back by how a part ended.

use crate::support::{STUDY, Server, TAB, folder_of, script::Script};
use serde_json::json;
use std::{fs, path::Path};

const PAYS: &str = "platform = \"PROLIFIC_PID\"\n\
    redirect = { done = \"https://pays.example/?cc=DONE\", screened_out = \"https://pays.example/?cc=OUT\", stopped = \"https://pays.example/?cc=STOP\" }\n";

fn folder() -> tempfile::TempDir {
    folder_of(&STUDY.replace("[protocol]\n", &format!("[protocol]\n{PAYS}")))
}

/// Comes from the platform; gives the link that the answer leads to.
fn joins(server: &Server, query: &str) -> Result<String, String> {
    let (status, reply) = server.ask("GET", &format!("/join{query}"), "", &[]);
    if status != 303 {
        return Err(reply);
    }
    let to = reply.lines().find_map(|line| line.strip_prefix("location: /p/"));
    let token = to.unwrap().trim().to_owned();
    assert_eq!(server.post(&format!("/api/{token}/open/{TAB}"), "null").0, 200);
    Ok(token)
}

fn walk(server: &Server, token: &str, person: &Script) {
    while person.go_on(server, token) {}
}

fn payment(folder: &Path) -> String {
    fs::read_to_string(folder.join("seat/payment.csv")).unwrap()
}

#[test]
fn an_id_has_one_link_and_stands_in_one_file_alone_until_it_is_paid() {
    let folder = folder();
    let server = Server::open(folder.path());
    let first = joins(&server, "?PROLIFIC_PID=5f1a2b3c&STUDY_ID=x").unwrap();
    let second = joins(&server, "?PROLIFIC_PID=77aa").unwrap();
    assert_ne!(first, second);
    assert_eq!(joins(&server, "?PROLIFIC_PID=5f1a2b3c").unwrap(), first);
    for nobody in ["", "?PROLIFIC_PID=", "?OTHER=77aa", "?PROLIFIC_PID=a%20b"] {
        let refused = joins(&server, nobody).unwrap_err();
        assert!(refused.contains("PROLIFIC_PID=…"), "{nobody}: {refused}");
    }
    assert_eq!(server.state(&first)["redirect"], json!(null));
    walk(&server, &first, &Script::default());
    assert_eq!(server.state(&first)["redirect"], "https://pays.example/?cc=DONE");
    let unwell = Script { stops: Some((300, "unwell")), ..Script::default() };
    walk(&server, &second, &unwell);
    assert_eq!(server.state(&second)["redirect"], "https://pays.example/?cc=STOP");
    // Whoever takes everything back, and comes again by the same id.
    let third = joins(&server, "?PROLIFIC_PID=third").unwrap();
    assert_eq!(server.post(&format!("/api/{third}/leave"), "{\"keep\":false}").0, 200);
    assert_eq!(server.state(&third)["redirect"], "https://pays.example/?cc=STOP");
    assert_eq!(joins(&server, "?PROLIFIC_PID=third").unwrap(), third);
    assert_eq!(server.state(&third)["ended"], "deleted");
    assert!(!payment(folder.path()).contains("third"));
}

#[test]
fn the_ids_of_who_is_through_are_deleted_and_nobody_elses() {
    let folder = folder();
    let server = Server::open(folder.path());
    let through = joins(&server, "?PROLIFIC_PID=5f1a2b3c").unwrap();
    joins(&server, "?PROLIFIC_PID=77aa").unwrap();
    walk(&server, &through, &Script::default());
    assert_eq!(
        payment(folder.path()),
        "participant,platform_id,ended\nP001,5f1a2b3c,done\nP002,77aa,\n"
    );
    let study = maveric_study::DesignFile::read(&folder.path().join("study.toml")).unwrap();
    let state = folder.path().join("seat/seat.db");
    let open = maveric_seat::paid(&study, &state).unwrap_err();
    assert!(open.to_string().contains("open"), "{open}");
    drop(server);
    // In no other file, nor in the seat's.
    for file in walkdir(folder.path()) {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let bytes = fs::read(&file).unwrap();
        let has = bytes.windows(8).any(|part| part == b"5f1a2b3c");
        assert_eq!(has, name == "payment.csv", "{name}");
    }
    let paid = loop {
        match maveric_seat::paid(&study, &state) {
            Ok(paid) => break paid,
            // What serves it ends in the background.
            Err(_) => std::thread::sleep(std::time::Duration::from_millis(20)),
        }
    };
    assert_eq!((paid.deleted, paid.left), (1, 1));
    assert_eq!(payment(folder.path()), "participant,platform_id,ended\nP002,77aa,\n");
}

fn walkdir(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(walkdir(&path));
        } else {
            files.push(path);
        }
    }
    files
}

#[test]
fn a_study_without_a_platform_gives_no_links_by_that_address() {
    let folder = folder_of(STUDY);
    let server = Server::open(folder.path());
    let refused = joins(&server, "?PROLIFIC_PID=5f1a2b3c").unwrap_err();
    assert!(refused.starts_with("HTTP/1.1 400"), "{refused}");
    assert!(!folder.path().join("seat/payment.csv").exists());
}
