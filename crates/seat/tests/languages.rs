//! In which language somebody goes on: chosen first, and everything after comes in it.

use crate::support::{MOOD, STUDY, Server, folder_of, open, opened, read, script::Script, tells};
use std::fs;

const GERMAN: &str = "[translation.de]\nitems = [\"Ich bin ruhig.\", \"Ich bin angespannt.\"]\n";

/// The study in two languages; whoever cannot read the scale in the second lacks its translation.
fn folder(translated: bool) -> tempfile::TempDir {
    let languages = "[protocol]\nlanguages = [\"en\", \"de\"]\n";
    let folder = folder_of(&STUDY.replace("[protocol]\n", languages));
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("consent.de.md", "Sie können jederzeit gehen.");
    if translated {
        write("scales/mood.toml", &format!("{MOOD}{GERMAN}"));
    }
    folder
}

#[test]
fn everything_after_the_choice_is_in_the_language_that_was_chosen() {
    let folder = folder(true);
    let server = Server::open(folder.path());
    let (german, english) = (opened(&server), opened(&server));
    let page = |server: &Server, token: &str| server.ask("GET", &format!("/p/{token}"), "", &[]).1;
    for (token, language, said) in [
        (&german, "de", ["Ich bin ruhig.", "Sie können jederzeit gehen.", "lang=\"de\""]),
        (&english, "en", ["I am <i>calm</i>.", "You may leave at any time.", "lang=\"en\""]),
    ] {
        let state = server.state(token);
        assert_eq!(state["steps"][0]["kind"], "language");
        assert_eq!(state["steps"][0]["languages"], serde_json::json!(["en", "de"]));
        let other = server.post(&format!("/api/{token}/language/0/fr"), "null");
        assert!(other.0 == 400 && other.1.contains("expected en, de"), "{other:?}");
        let who = if language == "de" { "P001" } else { "P002" };
        server.seat.extend(who, 0, 0.1, "to be sure").unwrap();
        // Sent twice, as after a lost reply.
        for _ in 0..2 {
            let path = format!("/api/{token}/language/0/{language}");
            assert_eq!(server.post(&path, "null").0, 200);
        }
        let state = server.state(token);
        assert_eq!(state["at"], 1);
        // What was made longer before stays so.
        let steps = state["steps"].as_array().unwrap();
        let practice = steps.iter().find(|step| step["kind"] == "practice");
        assert_eq!(practice.unwrap()["seconds"], 16.0);
        let told = state["steps"].to_string();
        assert!(told.contains(said[0]) && told.contains(said[1]), "{told}");
        assert!(page(&server, token).contains(said[2]), "{language}");
        while Script::default().go_on(&server, token) {}
        assert_eq!(server.state(token)["ended"], "done");
    }
    let people = read(folder.path(), "participants.csv");
    tells(&people, &["P001,2,calm sporty", "P002,2,sporty calm"]);
    let events = read(folder.path(), "seat/events.csv");
    assert!(events.contains("P001,1,language,,,,de,"), "{events}");
    // A seat that is opened again knows what was chosen.
    drop(server);
    let server = Server::open(folder.path());
    assert!(page(&server, &german).contains("lang=\"de\""));
}

#[test]
fn what_a_language_lacks_is_said_before_anybody_is_let_in() {
    let folder = folder(false);
    let refused = open(folder.path());
    let told = refused.err().unwrap().to_string();
    assert!(told.contains("`mood` in `de`"), "{told}");
}

#[test]
fn a_text_of_a_language_that_is_not_there_is_named() {
    let folder = folder(true);
    fs::remove_file(folder.path().join("consent.de.md")).unwrap();
    let study = maveric_study::DesignFile::read(&folder.path().join("study.toml")).unwrap();
    let missing = maveric_seat::files::texts(&study).unwrap_err().to_string();
    assert!(missing.contains("consent.de.md"), "{missing}");
}
