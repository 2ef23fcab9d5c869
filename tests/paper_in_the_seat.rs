//! The paper's study in the seat: its four conditions, ridden from the consent to the page.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

#[path = "../crates/seat/tests/support/mod.rs"]
mod seat;
mod support;

use maveric_model::model_file;
use maveric_seat::{Seat, SeatSettings, replay};
use maveric_seat_page::Record;
use maveric_simulator::Scenario;
use maveric_study::{
    run_folder::read_scales,
    tables::{
        conditions::read_conditions,
        embeddings::{read_embeddings, write_embeddings},
    },
};
use seat::{Script, Server, TAB};
use std::{fmt::Write as _, path::Path, rc::Rc};
use support::{
    TempStudy,
    own_logs::{change, read},
    page::Page,
};

/// The paper's conditions, as they are ridden in the seat.
const CONDITIONS: &str = r#"
[[condition]]
id = "mimic"
label = "Mimic"
car = { dial = 0, recorded = true }
[[condition]]
id = "aggressive"
label = "Aggressive"
car = { dial = "+1", recorded = true }
[[condition]]
id = "cautious"
label = "Cautious"
car = { dial = "-1", recorded = true }
[[condition]]
id = "perpendicular"
label = "Perpendicular"
car = { across = true, recorded = true }

[[outcome]]
measure = "mean_velocity_mps"
[[outcome]]
scale = "calm.total"
label = "Calm"

[protocol]
consent = "consent.md"
before = ["adb"]
after = ["calm"]
practice = { lane_kept_s = 1, passes = 0, at_most_s = 10 }
drive_s = 60
ride_s = 20
seed = 5
"#;

const CALM: &str = "id = \"calm\"\ntitle = \"Calm\"\nreference = \"made for this test\"\nitems = 2\nmin = 1\nmax = 7\nscoring = \"mean\"\n\
wording = [\"I was calm.\", \"I felt at ease.\"]\n[[subscales]]\nid = \"total\"\ntitle = \"Calm\"\nitems = [1, 2]\n";

/// The study's folder, with a model that learned from six made-up people.
fn learned() -> TempStudy {
    let study = TempStudy::new();
    let init = [
        "init",
        "mine",
        "--conditions",
        "a,b",
        "--style",
        "adb.total",
        "--synthetic",
    ];
    study.maveric(&init).ok();
    let text = read(&study, "mine/study.toml");
    let first = text.find("[[condition]]").unwrap();
    let baseline = "\n[baseline]\nid = \"own\"\nlabel = \"Own\"\n";
    let head = &text[..first];
    let baseline = if head.contains("[baseline]") {
        ""
    } else {
        baseline
    };
    study.write("mine/study.toml", format!("{head}{baseline}{CONDITIONS}"));
    study.write("mine/consent.md", "You may leave at any time.");
    study.write("mine/scales/calm.toml", CALM);
    let asked: String = (1..=11).fold(String::new(), |mut text, item| {
        let _ = write!(text, "\"What I do, part {item}\", ");
        text
    });
    change(
        &study,
        "mine/scales/adb.toml",
        "\nitems = 11\n",
        &format!("\nitems = 11\nwording = [{asked}]\n"),
    );
    let generate = "generate --learn 6 --test 0 --duration 150 --seed 3 --design study.toml";
    let words: Vec<&str> = generate.split(' ').collect();
    study.maveric_in("mine", &words).ok();
    study
        .maveric_in("mine", &["run", "train", "--set", "epochs=2"])
        .ok();
    study
}

/// The study's seat in the phase in which people ride.
fn opened(folder: &Path) -> Server {
    let settings = seat::settings(folder);
    let settings = SeatSettings {
        scales: read_scales(&folder.join("scales")).unwrap(),
        scenario: Scenario::paper(),
        model: Some(std::fs::read(folder.join("results/model.maveric")).unwrap()),
        stretch: 1.0,
        ..settings
    };
    Server::of(
        Seat::open(&folder.join("seat/seat.db"), settings).unwrap(),
        |_| {},
    )
}

#[test]
fn the_papers_four_conditions_are_ridden_from_consent_to_page() {
    let study = learned();
    let folder = study.path("mine");
    // What the helper reads where a model of the laboratory's rides.
    std::fs::copy(
        folder.join("results/model.maveric"),
        folder.join("lab.maveric"),
    )
    .unwrap();
    let model =
        model_file::from_bytes(&std::fs::read(folder.join("lab.maveric")).unwrap()).unwrap();
    let model = Rc::new(model);
    let server = opened(&folder);
    let speeds = [27.0, 29.0, 31.0, 33.0];
    let unwell = Some((500, "unwell"));
    let people = speeds.map(|speed| (speed, None));
    // A fifth stops in the first ride.
    for (speed, stops) in people.into_iter().chain([(30.0, unwell)]) {
        let person = Script {
            model: Rc::clone(&model),
            own: None,
            stops,
            speed: Some(speed),
            answers: |item, low, high| Some(i64::midpoint(low, high) + i64::from(item == 1)),
        };
        let token = server.seat.let_in().unwrap();
        assert_eq!(
            server.post(&format!("/api/{token}/open/{TAB}"), "null").0,
            200
        );
        while person.go_on(&server, &token) {}
        assert_eq!(server.state(&token)["ended"], "done");
    }
    drop(server);
    // Nobody's ride was in another style than the study's.
    let notes = read(&study, "mine/seat/notes.csv");
    assert!(!notes.contains("another style"), "{notes}");
    let ran = study.maveric_in("mine", &["run", "--set", "epochs=2"]).ok();
    assert!(ran.stdout.contains("index.html"), "{}", ran.stdout);

    // What the pipeline makes of the same people, who were learned of without their answers while they waited.
    let mut fits = read_embeddings(&folder.join("results/embeddings.csv")).unwrap();
    fits.retain(|row| !row.adb_used);
    write_embeddings(&folder.join("without.csv"), &fits).unwrap();
    let steer = "steer --model results/model.maveric --embeddings without.csv --out placed.csv --seed 5 --design study.toml";
    let words: Vec<&str> = steer.split(' ').collect();
    study.maveric_in("mine", &words).ok();
    let mut placed = read_conditions(&folder.join("placed.csv")).unwrap();
    placed.retain(|row| row.participant.as_str() != "P005");
    assert_eq!(placed.len(), 4 * speeds.len());
    for row in &placed {
        let record = folder.join(format!("seat/{}-{}.jsonl", row.participant, row.condition));
        assert_eq!(replay::repeat(&record).unwrap().same, Some(true));
        let record = Record::from_lines(&std::fs::read_to_string(&record).unwrap()).unwrap();
        let ridden = record.header.style.unwrap();
        let pairs = ridden.coordinates().iter().zip(row.embedding.coordinates());
        for (ridden, placed) in pairs {
            assert!(
                (ridden - placed).abs() < 1e-5,
                "{} {}: {ridden} {placed}",
                row.participant,
                row.condition
            );
        }
        assert_eq!(
            row.angle_rad.is_some(),
            row.condition.as_str() == "perpendicular"
        );
    }
    // Across is somewhere else than the own style, at an angle of one's own.
    let mut angles: Vec<f64> = placed.iter().filter_map(|row| row.angle_rad).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    assert_eq!(angles.len(), speeds.len());
    // The angle is the one of the whole run, too.
    let run = read_conditions(&folder.join("results/conditions.csv")).unwrap();
    for row in run.iter().filter(|row| row.participant.as_str() != "P005") {
        if let Some(angle) = row.angle_rad {
            assert!(angles.iter().any(|a| (a - angle).abs() < 1e-9), "{angle}");
        }
    }
    let measured = read(&study, "mine/results/rating_scores.csv");
    for condition in ["mimic", "aggressive", "cautious", "perpendicular"] {
        assert_eq!(
            measured
                .matches(&format!(",{condition},calm,total,"))
                .count(),
            speeds.len()
        );
    }
    // The ride that was stopped is counted, with its condition and the reason.
    let analysis: serde_json::Value =
        serde_json::from_str(&read(&study, "mine/results/analysis.json")).unwrap();
    let stopped = serde_json::json!([{"rule": "stopped", "why": "`mimic` was stopped: unwell", "who": ["P005-mimic"]}]);
    assert_eq!(analysis["flow"]["drives"], stopped);
    Page::read(&study.path("mine/report/index.html")).says(&[
        "`mimic` was stopped: unwell",
        "four conditions: Mimic, Aggressive, Cautious and Perpendicular",
    ]);
}
