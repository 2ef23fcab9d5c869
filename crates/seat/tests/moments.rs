//! What is asked before somebody takes part, during a ride and at the end.

use crate::support::{
    MISC, STUDY, Server, TAB, folder_of, lab, open, opened, read,
    script::{driven, finish, go_on, piece, until},
};
use maveric_study::tables::surveys::read_answered;
use serde_json::json;
use std::fs;

const ABOUT: &str = "id = \"about\"\ntitle = \"You\"\nreference = \"made for this test\"\nitems = 2\nmin = 0\nmax = 120\nscoring = \"sum\"\n\
    wording = [\"How old are you?\", \"For how many years have you had a licence?\"]\n[[subscales]]\nid = \"age\"\ntitle = \"Age\"\nitems = [1]\n";

/// The study that asks at every moment.
fn study() -> String {
    let moments = "screen = [\"about\"]\nadmit_if = [\"about.age >= 18\", \"about.2 > 1\"]\n\
                   probe = { scale = \"misc\", every_s = 12 }\npost = [\"mood\"]\n";
    STUDY
        .replace("ride_s = 10", "ride_s = 40")
        .replace("[protocol]\n", &format!("[protocol]\n{moments}"))
}

fn folder(design: &str) -> tempfile::TempDir {
    let folder = folder_of(design);
    for (name, text) in [("misc", MISC), ("about", ABOUT)] {
        fs::write(folder.path().join(format!("scales/{name}.toml")), text).unwrap();
    }
    folder
}

#[test]
fn what_was_asked_on_the_way_and_at_the_end_stands_among_the_answers() {
    let folder = folder(&study());
    let server = Server::open(folder.path());
    let token = opened(&server);
    finish(&server, &token);
    let text = read(folder.path(), "surveys/answers.csv");
    let (head, rows) = text.split_once('\n').unwrap();
    assert_eq!(head, "participant,moment,scale,item,answer,seconds,condition,at_s");
    for row in [
        "P001,pre,mood,1,4,3.000,,",
        "P001,after,mood,1,4,3.000,calm,",
        "P001,post,mood,1,4,3.000,,",
        "P001,probe,misc,1,1,,calm,12",
        "P001,probe,misc,1,,,calm,24",
        "P001,probe,misc,1,3,,sporty,36",
    ] {
        assert!(rows.lines().any(|line| line == row), "{row}:\n{text}");
    }
    let answered = read_answered(&folder.path().join("surveys/answers.csv")).unwrap();
    assert_eq!((answered.answers.len(), answered.probes.len()), (2 * 4, 2 * 3));
    // Nothing of the screening is anywhere.
    assert!(!text.contains("about"), "{text}");
    let events = read(folder.path(), "seat/events.csv");
    assert!(!events.contains("about") && !folder.path().join("seat/not_admitted.csv").exists());
    assert!(events.contains(",probe:misc,1.0") || events.contains(",probe:misc,1,"), "{events}");
    // Pages were answered, and a ride is none.
    let pages: Vec<&str> = events
        .lines()
        .filter(|row| row.contains(",answered,"))
        .filter_map(|row| row.split(',').nth(2))
        .collect();
    assert_eq!(pages, ["mood"; 4]);
}

#[test]
fn who_is_not_admitted_is_counted_by_the_rule_and_leaves_nothing_else() {
    let folder = folder(&study());
    let server = Server::open(folder.path());
    let (held, next) = (opened(&server), opened(&server));
    server.seat.write_files().unwrap();
    let refuse = |sheet: &str| server.post(&format!("/api/{held}/answer/0"), sheet).0;
    // No answer is taken, and no rule that there is not.
    for sheet in [
        r#"{"answers":[17,0],"seconds":1}"#,
        r#"{"refused":2,"seconds":1}"#,
        r#"{"refused":0,"answers":[17,0],"seconds":1}"#,
    ] {
        assert_eq!(refuse(sheet), 400, "{sheet}");
    }
    assert_eq!(server.post(&format!("/api/{held}/done/0"), "null").0, 400);
    assert_eq!(refuse(r#"{"refused":0,"seconds":9}"#), 200);
    assert_eq!(refuse(r#"{"refused":0,"seconds":9}"#), 410);
    assert_eq!(server.state(&held)["ended"], "not admitted");
    assert_eq!(read(folder.path(), "seat/not_admitted.csv"), "rule,people\nabout.age >= 18,1\n");
    // Who comes after them has the first order, and they are in no table.
    while go_on(&server, &next) {}
    let another = opened(&server);
    while go_on(&server, &another) {}
    assert_eq!(
        read(folder.path(), "participants.csv"),
        "participant,study,order\nP002,2,sporty calm\nP003,2,calm sporty\n"
    );
    for file in ["surveys/answers.csv", "seat/events.csv", "seat/consents.csv"] {
        assert!(!read(folder.path(), file).contains("P001"), "{file}");
    }
    let lab = lab(&server);
    assert!(lab.contains("not admitted") && !lab.contains("about.age"), "{lab}");
}

#[test]
fn an_answer_to_a_probe_that_is_not_asked_is_refused() {
    let folder = folder(&study());
    let server = Server::open(folder.path());
    let token = opened(&server);
    let (at, step) = until(&server, &token, "ride");
    let question = &step["probe"]["question"];
    assert_eq!(
        (&question["text"], &question["min"], &question["max"]),
        (&json!("How sick do you feel?"), &json!(0), &json!(10))
    );
    let (lines, _) = driven(&step);
    let path = format!("/api/{token}/drive/{at}/1/{TAB}");
    assert_eq!(server.post(&path, &lines[0]).0, 200);
    let asked = lines.iter().find(|line| line.contains("probe:misc")).unwrap();
    for (from, to) in [
        ("probe:misc\",\"points\":1.0", "probe:misc\",\"points\":11.0"),
        ("probe:misc\",\"points\":1.0", "probe:misc\",\"points\":1.5"),
        ("probe:misc\"", "probe:mood\""),
    ] {
        let other = asked.replace(from, to);
        assert_ne!(&other, asked, "{from}");
        assert_eq!(server.post(&path, &other).0, 400, "{other}");
    }
    let (status, reply) = server.post(&path, &piece(&lines));
    assert_eq!(status, 200, "{reply}");
}

#[test]
fn what_cannot_be_asked_or_judged_is_refused_when_the_seat_is_opened() {
    let refused = |from: &str, to: &str, words: &[&str]| {
        let design = study();
        assert!(design.contains(from), "{from}");
        let folder = folder(&design.replace(from, to));
        let seat = open(folder.path());
        let told = seat.err().unwrap().to_string();
        for word in words {
            assert!(told.contains(word), "{word}: {told}");
        }
    };
    refused(
        "scale = \"misc\"",
        "scale = \"about\"",
        &["`probe`", "`about`", "2 items", "one item"],
    );
    refused("scale = \"misc\"", "scale = \"misk\"", &["`misk`", "did you mean `misc`?"]);
    refused(
        "about.age >= 18",
        "about.licence >= 18",
        &["`admit_if`", "`about.licence >= 18`", "about.1 to about.2", "about.age"],
    );
    refused("about.2 > 1", "about.3 > 1", &["`about.3 > 1`", "about.1 to about.2"]);
    refused("about.2 > 1", "about > 1", &["`about > 1`", "about.1 to about.2"]);
    refused("about.age >= 18", "about.age >= 180", &["0 to 120"]);
    refused("post = [\"mood\"]", "post = [\"moot\"]", &["`moot`", "did you mean `mood`?"]);
}

#[test]
fn whose_computer_lacks_what_the_study_needs_is_counted_by_it_before_anything_is_asked() {
    let needs = "needs = { width_px = 1280, device = \"keyboard\" }\nscreen = ";
    let folder = folder(&study().replace("screen = ", needs));
    let server = Server::open(folder.path());
    let (held, next) = (opened(&server), opened(&server));
    let step = server.state(&held)["steps"][0].clone();
    assert_eq!(
        step,
        json!({"kind": "computer", "needs": [
            {"what": "webgl"}, {"what": "device", "device": "keyboard"}, {"what": "width_px", "least": 1280.0}]})
    );
    let refuse = |sheet: &str| server.post(&format!("/api/{held}/answer/0"), sheet).0;
    assert_eq!(refuse(r#"{"refused":3,"seconds":1}"#), 400);
    assert_eq!(server.post(&format!("/api/{held}/done/0"), "null").0, 400);
    assert_eq!(refuse(r#"{"refused":2,"seconds":9}"#), 200);
    assert_eq!(server.state(&held)["ended"], "not admitted");
    assert_eq!(
        read(folder.path(), "seat/not_admitted.csv"),
        "rule,people\nneeds.width_px >= 1280,1\n"
    );
    // Who has what is needed goes on to the screening, and may be held back there.
    assert!(go_on(&server, &next));
    let state = server.state(&next);
    assert_eq!((state["at"].as_u64(), &state["steps"][1]["kind"]), (Some(1), &json!("screen")));
    let sheet = r#"{"refused":0,"seconds":9}"#;
    assert_eq!(server.post(&format!("/api/{next}/answer/1"), sheet).0, 200);
    assert_eq!(
        read(folder.path(), "seat/not_admitted.csv"),
        "rule,people\nabout.age >= 18,1\nneeds.width_px >= 1280,1\n"
    );
    assert!(!read(folder.path(), "participants.csv").contains("P00"));
}
