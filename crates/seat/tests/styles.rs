//! Rides in styles that are not on the dial: of a file, across, and what is refused of both.

use crate::support::{
    STUDY, Server, TAB, folder_of, lab, lab_post, open, opened,
    script::{driven, go_on, piece},
    tells,
};
use maveric_domain::{DriveId, Embedding, EmbeddingRow, ParticipantId};
use maveric_seat_page::Record;
use maveric_study::tables::embeddings::write_embeddings;
use serde_json::{Value, json};
use std::{fs, path::Path};

/// The study whose condition `sporty` has this car.
fn study(car: &str) -> String {
    let was = "{ dial = 8, recorded = true }";
    assert!(STUDY.contains(was));
    STUDY.replace(was, car)
}

const BY_FILE: &str = "{ embedding = \"styles.csv\", recorded = true }";

/// A file of styles, a row a person.
fn styles(folder: &Path, people: &[(&str, &[f64])]) {
    let row = |(who, style): &(&str, &[f64])| EmbeddingRow {
        drive: DriveId::new(format!("{who}-own")).unwrap(),
        participant: ParticipantId::new(*who).unwrap(),
        condition: "own".parse().unwrap(),
        session: maveric_domain::occasion::first(),
        trial: maveric_domain::occasion::first(),
        adb_used: false,
        adb: None,
        adb_hat: None,
        line_position: None,
        readings: None,
        covariance: None,
        line_position_se: None,
        support_p: None,
        beyond_why: None,
        posted_unseen: None,
        embedding: Embedding::new(style.to_vec()).unwrap(),
    };
    let rows: Vec<EmbeddingRow> = people.iter().map(row).collect();
    write_embeddings(&folder.join("styles.csv"), &rows).unwrap();
}

fn ridden(folder: &Path, drive: &str) -> Vec<f64> {
    let lines = fs::read_to_string(folder.join(format!("seat/{drive}.jsonl"))).unwrap();
    let style = Record::from_lines(&lines).unwrap().header.style.unwrap();
    style.coordinates().to_vec()
}

#[test]
fn the_style_of_ones_own_row_is_ridden_and_who_has_no_row_is_not_let_in() {
    let folder = folder_of(&study(BY_FILE));
    styles(folder.path(), &[("P001", &[0.7]), ("P002", &[-0.4])]);
    let server = Server::open(folder.path());
    for _ in 0..2 {
        let token = opened(&server);
        while go_on(&server, &token) {}
    }
    for (drive, style) in [("P001-sporty", 0.7), ("P002-sporty", -0.4)] {
        assert_eq!(ridden(folder.path(), drive), [style]);
    }
    // The seat rides in the style that it was asked for: nothing to say.
    assert!(!lab(&server).contains("another style"));
    let refused = server.seat.let_in().unwrap_err();
    let help = refused.suggestion().unwrap();
    let told = refused.to_string();
    tells(&told, &["styles.csv", "none of P003"]);
    assert!(help.contains("add the row of P003"), "{help}");
    lab_post(&server, "/lab/next", "");
    let lab = lab(&server);
    tells(&lab, &["none of P003", "add the row of P003"]);
}

#[test]
fn a_page_that_drove_another_style_is_told_of() {
    let folder = folder_of(&study(BY_FILE));
    styles(folder.path(), &[("P001", &[0.7])]);
    let server = Server::open(folder.path());
    let token = opened(&server);
    let at = |state: &Value| state["at"].as_u64().unwrap() as usize;
    loop {
        let state = server.state(&token);
        let Some(mut step) = state["steps"].get(at(&state)).cloned() else {
            break;
        };
        if step["kind"] != "ride" || step["condition"] != "ride-2" {
            assert!(go_on(&server, &token));
            continue;
        }
        step["style"] = json!("own");
        let (lines, _) = driven(&step);
        let path = format!("/api/{token}/drive/{}/1/{TAB}", at(&state));
        assert_eq!(server.post(&path, &piece(&lines)).0, 200);
        let done = format!("/api/{token}/done/{}", at(&state));
        assert_eq!(server.post(&done, "null").0, 200);
    }
    let lab = lab(&server);
    tells(&lab, &["P001-sporty: the page drove another style"]);
}

#[test]
fn styles_of_another_model_no_file_and_nothing_across_are_refused_when_the_seat_is_opened() {
    let refused = |car: &str, file: Option<&[f64]>| {
        let folder = folder_of(&study(car));
        if let Some(style) = file {
            styles(folder.path(), &[("P001", style)]);
        }
        let seat = open(folder.path());
        let told = seat.err().unwrap().to_string();
        assert!(!folder.path().join("participants.csv").exists(), "{told}");
        told
    };
    let says = |told: &str, words: &[&str]| {
        for word in words {
            assert!(told.contains(word), "{word}: {told}");
        }
    };
    let other = refused(BY_FILE, Some(&[0.1, 0.2]));
    says(&other, &["`sporty`", "styles.csv", "2 numbers", "model's have 1", "personalize"]);
    says(&refused(BY_FILE, None), &["`sporty`", "styles.csv"]);
    let across = refused("{ across = true, recorded = true }", None);
    says(&across, &["`sporty` cannot be driven by the model", "two numbers"]);
}
