//! A study as static files, and what people hand over.

use crate::support::{
    STUDY, Server, folder, folder_of, opened, read,
    script::{Script, go_on, written},
    seat, tells,
};
use maveric_seat::{Seat, carried, replay};
use serde_json::{Value, json};
use std::{fs, path::Path};

/// What somebody hands over who went through row `row`.
fn handed_over(seat: &Seat, folder: &Path, row: usize) -> Vec<Value> {
    let (mut lines, style) =
        crate::support::script::handed_over(seat, folder, row, &Script::default());
    let style: Value = serde_json::from_str(&style.unwrap()).unwrap();
    lines.extend([json!({"fit": style}), json!({"ended": "done"})]);
    lines
}

#[test]
fn what_is_handed_over_becomes_the_files_that_a_run_reads() {
    let folder = folder();
    let seat = seat(folder.path());
    let lines = handed_over(&seat, folder.path(), 1);
    let taken = carried::take_in(&seat, &written(folder.path(), &lines)).unwrap();
    assert_eq!(
        (taken.participant.as_str(), taken.sheets, taken.drives),
        ("P001", 4, 3)
    );
    let at = |name: &str| folder.path().join(name);
    let people = fs::read_to_string(at("participants.csv")).unwrap();
    assert_eq!(people, "participant,study,order\nP001,2,sporty calm\n");
    let answers = fs::read_to_string(at("surveys/answers.csv")).unwrap();
    assert_eq!(answers.lines().count(), 1 + 3 * 2);
    for drive in ["own", "calm", "sporty"] {
        assert!(at(&format!("logs/seat/P001-{drive}.mcap")).is_file());
        let record = at(&format!("seat/P001-{drive}.jsonl"));
        assert_eq!(replay::repeat(&record).unwrap().same, Some(true));
    }
    // The same again is somebody who was there.
    let again = carried::take_in(&seat, &written(folder.path(), &lines));
    assert!(again.is_err_and(|e| e.to_string().contains("taken in before, as P001")));
    // Their row of the square is theirs: who comes next gets the rows that are left, 0 and 2.
    let server = Server::of(seat, |_| {});
    for _ in 0..2 {
        let token = opened(&server);
        assert!(go_on(&server, &token));
    }
    server.seat.write_files().unwrap();
    let people = fs::read_to_string(at("participants.csv")).unwrap();
    assert!(
        people.ends_with("P002,2,calm sporty\nP003,2,calm sporty\n"),
        "{people}"
    );
    // Nor is somebody who is forgotten.
    server.seat.forget("P001").unwrap();
    let again = carried::take_in(&server.seat, &written(folder.path(), &lines));
    assert!(again.is_err_and(|e| e.to_string().contains("forgotten")));
}

#[test]
fn a_file_that_is_wrong_anywhere_is_refused_whole_and_names_the_line() {
    let folder = folder();
    let seat = seat(folder.path());
    let lines = handed_over(&seat, folder.path(), 0);
    let drive = lines
        .iter()
        .position(|l| l["record"].as_str().is_some_and(|r| r.contains("held")))
        .unwrap();
    let record = lines[drive]["record"].as_str().unwrap();
    let other_world = record.replacen("\"seed\":", "\"seed\":1", 1);
    let long =
        format!("{record}{{\"from_tick\":1000,\"ticks\":90000,\"held\":[[90000,0,0,0,0]]}}\n");
    let changed = |at: usize, key: &str, value: Value| {
        let mut lines = lines.clone();
        lines[at][key] = value;
        lines
    };
    let cases = [
        (0, "token", json!("../../../etc/passwd")),
        (0, "row", json!(99)),
        (0, "maveric_seat_person", json!(2)),
        (1, "step", json!(2)),
        (1, "sheet", json!({"agreed": false, "seconds": 1})),
        (2, "sheet", json!({"answers": [9, 1], "seconds": 1})),
        (
            2,
            "sheet",
            json!({"answers": ["<script>", 1], "seconds": 1}),
        ),
        (drive, "record", json!(other_world)),
        (drive, "record", json!(long)),
        (drive, "record", json!("{}\n")),
        (drive, "step", json!(0)),
        (drive, "path", json!("../../x")),
        (lines.len() - 1, "ended", json!("deleted")),
    ];
    for (at, key, value) in cases {
        let path = written(folder.path(), &changed(at, key, value.clone()));
        let error = carried::take_in(&seat, &path).unwrap_err().to_string();
        assert!(
            error.contains(&format!("line {}", at + 1)),
            "{key} {value}: {error}"
        );
    }
    let cut = &lines[..lines.len() - 1];
    let cut_off = carried::take_in(&seat, &written(folder.path(), cut)).unwrap_err();
    assert!(cut_off.to_string().contains("cut off"), "{cut_off}");
    let people = read(folder.path(), "participants.csv");
    assert_eq!(people, "participant,study,order\n");
}

#[test]
fn words_that_somebody_wrote_are_taken_in_and_those_of_an_item_that_asks_for_none_are_not() {
    let folder = folder_of(&STUDY.replace("before = [\"mood\"]", "before = [\"why\"]"));
    let why = "id = \"why\"\ntitle = \"Why\"\nreference = \"made for this test\"\n\
               [[item]]\nkind = \"likert\"\ntext = \"Was it clear?\"\nmin = 1\nmax = 5\n\
               [[item]]\nkind = \"text\"\ntext = \"What was it about?\"\n";
    fs::write(folder.path().join("scales/why.toml"), why).unwrap();
    let seat = seat(folder.path());
    let mut lines = handed_over(&seat, folder.path(), 0);
    let is_sheet = |line: &Value| line["sheet"]["answers"].is_array();
    let asked = lines.iter().position(is_sheet).unwrap();
    for (texts, told) in [
        (json!({"1": "cars"}), "item 1: a text"),
        (json!({"two": "cars"}), "expected"),
    ] {
        lines[asked]["sheet"]["texts"] = texts;
        let refused = carried::take_in(&seat, &written(folder.path(), &lines)).unwrap_err();
        tells(
            &refused.to_string(),
            &[&format!("line {}", asked + 1), told],
        );
    }
    lines[asked]["sheet"]["texts"] = json!({"2": "cars, or trust"});
    let file = written(folder.path(), &lines);
    // An editor has put a mark before it.
    fs::write(
        &file,
        format!("\u{feff}{}", fs::read_to_string(&file).unwrap()),
    )
    .unwrap();
    carried::take_in(&seat, &file).unwrap();
    let answers = read(folder.path(), "surveys/answers.csv");
    tells(&answers, &["P001,pre,why,2,", "\"cars, or trust\""]);
}

#[test]
fn who_hands_over_nothing_is_not_somebody_who_is_through() {
    let folder = folder();
    let seat = seat(folder.path());
    let lines = handed_over(&seat, folder.path(), 0);
    let ended = |how: &str| json!({"ended": how});
    let nothing = [lines[0].clone(), ended("done")];
    let refused = |lines: &[Value], word: &str| {
        let taken = carried::take_in(&seat, &written(folder.path(), lines));
        let told = taken.unwrap_err().to_string();
        assert!(told.contains(word), "{told}");
    };
    refused(&nothing, "step 1");
    refused(&[lines[0].clone(), ended("left")], "nothing");
    // Questionnaires without the consent, and everything but the last ride.
    let mut without = lines.clone();
    without.remove(1);
    refused(&without, "agreed");
    let last = lines.iter().rposition(|l| l["record"].is_string()).unwrap();
    let mut without = lines.clone();
    without.remove(last);
    refused(&without, "ride");
    let mut left = lines[..4].to_vec();
    left.push(ended("left"));
    assert!(carried::take_in(&seat, &written(folder.path(), &left)).is_ok());
}

#[test]
fn a_study_that_promises_what_a_link_alone_can_do_is_not_exported() {
    let design = STUDY.replace("drive_s", "withdraw_until = \"2999-12-31\"\ndrive_s");
    let folder = folder_of(&design);
    let out = folder.path().join("online");
    let refused = carried::export(&seat(folder.path()), &out, None).unwrap_err();
    tells(&refused.to_string(), &["`withdraw_until`"]);
    assert!(!out.exists());
}

#[test]
fn a_folder_is_written_that_needs_no_server_and_sends_nowhere_else() {
    let folder = folder();
    let seat = seat(folder.path());
    let out = folder.path().join("online");
    for post in [
        "http://example.org/x",
        "javascript:alert(1)",
        "ftp://x",
        "here",
        "https://",
    ] {
        assert!(carried::export(&seat, &out, Some(post)).is_err(), "{post}");
        assert!(!out.exists(), "{post}");
    }
    let post = "https://example.org/answers?a=1;script-src%20*";
    let exported = carried::export(&seat, &out, Some(post)).unwrap();
    assert_eq!(exported.orders, 2);
    let page = fs::read_to_string(out.join("index.html")).unwrap();
    assert!(
        page.contains("connect-src 'self' https://example.org;"),
        "{page}"
    );
    assert!(!page.contains("\"/page/") && page.contains("data-study=\"study.json\""));
    for file in ["page.js", "page.css", "seat.wasm", "model.maveric"] {
        assert!(out.join(file).metadata().unwrap().len() > 100, "{file}");
    }
    // Again over itself, and never over something else.
    carried::export(&seat, &out, None).unwrap();
    let elsewhere = folder.path().join("seat");
    assert!(carried::export(&seat, &elsewhere, None).is_err());
    #[cfg(unix)]
    {
        let aim = folder.path().join("aim.html");
        fs::write(&aim, "mine").unwrap();
        fs::remove_file(out.join("index.html")).unwrap();
        std::os::unix::fs::symlink(&aim, out.join("index.html")).unwrap();
        assert!(carried::export(&seat, &out, None).is_err());
        assert_eq!(fs::read_to_string(&aim).unwrap(), "mine");
    }
}
