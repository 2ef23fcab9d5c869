//! The paper's study in the seat: its four conditions, ridden from the consent to the page.

#[path = "../crates/seat/tests/support/mod.rs"]
mod seat;

use crate::support::{
    TempStudy, argv,
    own_logs::{analysis, change},
    page::Page,
};
use maveric_model::{Model, model_file, style_space::LinearHead};
use maveric_seat::{Seat, SeatSettings, replay};
use maveric_seat_page::Record;
use maveric_simulator::Scenario;
use maveric_study::{
    run_folder::read_scales,
    tables::{
        collected::read_lent,
        conditions::read_conditions,
        embeddings::{read_embeddings, write_embeddings},
    },
};
use seat::{Server, script::Script};
use std::{fmt::Write as _, path::Path, rc::Rc};

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
fn learned(conditions: &str) -> TempStudy {
    let study = TempStudy::new();
    let init = argv("init mine --conditions a,b --style adb.total --synthetic");
    study.maveric(&init).ok();
    let text = study.read("mine/study.toml");
    let first = text.find("[[condition]]").unwrap();
    let baseline = "\n[baseline]\nid = \"own\"\nlabel = \"Own\"\n";
    let head = &text[..first];
    let baseline = if head.contains("[baseline]") { "" } else { baseline };
    study.write("mine/study.toml", format!("{head}{baseline}{conditions}"));
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
    study.mine(generate).ok();
    study.mine("run train --set epochs=2").ok();
    study
}

/// The study's seat in the phase in which people ride.
fn opened(folder: &Path) -> Server {
    let model = std::fs::read(folder.join("results/model.maveric"));
    opened_with(folder, Some(model.unwrap()))
}

/// The study's seat; without a model people drive by hand alone.
fn opened_with(folder: &Path, model: Option<Vec<u8>>) -> Server {
    let settings = seat::settings(folder);
    let settings = SeatSettings {
        scales: read_scales(&folder.join("scales")).unwrap(),
        scenario: Scenario::paper(),
        model,
        ..settings
    };
    Server::of(Seat::open(&folder.join("seat/seat.db"), settings).unwrap(), |_| {})
}

#[test]
fn the_papers_four_conditions_are_ridden_from_consent_to_page() {
    let study = learned(CONDITIONS);
    let folder = study.path("mine");
    // What the helper reads where a model of the laboratory's rides.
    std::fs::copy(folder.join("results/model.maveric"), folder.join("lab.maveric")).unwrap();
    let model =
        model_file::from_bytes(&std::fs::read(folder.join("lab.maveric")).unwrap()).unwrap();
    let model = Rc::new(model);
    let server = opened(&folder);
    let speeds = [27.0, 29.0, 31.0, 33.0];
    let unwell = Some((500, "unwell"));
    let people = speeds.map(|speed| (speed, None));
    // A fifth stops in the first ride.
    for (speed, stops) in people.into_iter().chain([(30.0, unwell)]) {
        let person = Script { stops, ..driver(&model, speed) };
        let token = seat::opened(&server);
        while person.go_on(&server, &token) {}
        assert_eq!(server.state(&token)["ended"], "done");
    }
    drop(server);
    // Nobody's ride was in another style than the study's.
    let notes = study.read("mine/seat/notes.csv");
    assert!(!notes.contains("another style"), "{notes}");
    let ran = study.mine("run --set epochs=2").ok();
    assert!(ran.stdout.contains("index.html"), "{}", ran.stdout);

    // What the pipeline makes of the same people, who were learned of without their answers while they waited.
    let mut fits = read_embeddings(&folder.join("results/embeddings.csv")).unwrap();
    fits.retain(|row| !row.adb_used);
    write_embeddings(&folder.join("without.csv"), &fits).unwrap();
    let steer = "steer --model results/model.maveric --embeddings without.csv --out placed.csv --seed 5 --design study.toml";
    study.mine(steer).ok();
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
        assert_eq!(row.angle_rad.is_some(), row.condition.as_str() == "perpendicular");
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
    let measured = study.read("mine/results/rating_scores.csv");
    for condition in ["mimic", "aggressive", "cautious", "perpendicular"] {
        assert_eq!(measured.matches(&format!(",{condition},calm,total,")).count(), speeds.len());
    }
    // The ride that was stopped is counted, with its condition and the reason.
    let analysis = analysis(&study);
    let stopped = serde_json::json!([{"rule": "stopped", "why": "`mimic` was stopped: unwell", "who": ["P005-mimic"]}]);
    assert_eq!(analysis["flow"]["drives"], stopped);
    Page::read(&study.path("mine/report/index.html")).says(&[
        "`mimic` was stopped: unwell",
        "four conditions: Mimic, Aggressive, Cautious and Perpendicular",
    ]);
}

/// One's own style beside somebody else's of the same score.
const MINE_OR_ANOTHERS: &str = r#"
[[condition]]
id = "mine"
car = { dial = 0, recorded = true }
[[condition]]
id = "other"
car = { other = "matched", recorded = true }

[[outcome]]
scale = "calm.total"
label = "Calm"
drop_items = [2]

[protocol]
consent = "consent.md"
before = ["adb"]
after = ["calm"]
which = ["other", "mine"]
debrief = "debrief.md"
practice = { lane_kept_s = 1, passes = 0, at_most_s = 10 }
drive_s = 240
ride_s = 10
seed = 5
"#;

/// Lets somebody in who answers the box below the consent, and goes through to the end.
fn goes_through(server: &Server, person: &Script, style_lent: bool) {
    let token = seat::opened(server);
    let state = server.state(&token);
    let asked = state["steps"][0]["lend"].as_str().unwrap();
    assert!(asked.contains("drive in my style"), "{asked}");
    let agreed = format!(r#"{{"agreed":true,"style_lent":{style_lent},"seconds":4.5}}"#);
    let agreed = server.post(&format!("/api/{token}/answer/0"), &agreed);
    assert_eq!(agreed.0, 200);
    while person.go_on(server, &token) {}
    let state = server.state(&token);
    assert_eq!(state["ended"], "done");
    // Whoever rides is not told whose style it is.
    assert!(!state.to_string().contains("donor"), "{state}");
}

fn driver(model: &Rc<Model>, speed: f64) -> Script {
    Script {
        model: Rc::clone(model),
        own: None,
        stops: None,
        speed: Some(speed),
        answers: |item, low, high| Some(i64::midpoint(low, high) + i64::from(item == 1)),
    }
}

/// Two people drive by hand and are learned from; the second lets nobody be driven in their style.
fn two_are_learned_from(study: &TempStudy, folder: &Path) {
    let model = std::fs::read(folder.join("results/model.maveric")).unwrap();
    let model = Rc::new(model_file::from_bytes(&model).unwrap());
    let server = opened_with(folder, None);
    goes_through(&server, &driver(&model, 28.0), true);
    goes_through(&server, &driver(&model, 30.0), false);
    drop(server);
    study.mine("run train --set epochs=2").ok();
}

#[test]
fn somebody_elses_style_is_ridden_at_ones_own_score_and_whose_it_was_is_kept_for_the_study_alone() {
    let study = learned(MINE_OR_ANOTHERS);
    let folder = study.path("mine");
    study.write("mine/debrief.md", "One of the two cars drove in somebody else's style.");
    let which = include_str!("../study_data/further_scales/which.toml");
    study.write("mine/scales/which.toml", which);
    let model = folder.join("results/model.maveric");
    std::fs::copy(&model, folder.join("lab.maveric")).unwrap();
    two_are_learned_from(&study, &folder);
    std::fs::copy(&model, folder.join("lab.maveric")).unwrap();
    let model = model_file::from_bytes(&std::fs::read(model).unwrap()).unwrap();
    let training = model.training().iter().map(|drive| drive.drive.as_str());
    let learned: Vec<&str> = training.filter(|drive| drive.starts_with('P')).collect();
    assert_eq!(learned, ["P001-own", "P002-own"]);
    let dial = LinearHead::aggression(&model).unwrap();
    let model = Rc::new(model);
    let server = opened(&folder);
    for number in 0..12 {
        // The second, too, lets nobody be driven in their style.
        let person = driver(&model, 31.0 + 0.2 * f64::from(number));
        goes_through(&server, &person, number != 1);
    }
    server.seat.write_files().unwrap();
    let lent = read_lent(&folder.join("seat/lent.csv")).unwrap();
    assert_eq!(lent.len(), 12);
    let ridden = |drive: String| {
        let record = std::fs::read_to_string(folder.join(format!("seat/{drive}.jsonl"))).unwrap();
        Record::from_lines(&record).unwrap().header.style.unwrap()
    };
    for (place, row) in lent.iter().enumerate() {
        let own = ridden(format!("{}-mine", row.participant));
        let other = ridden(format!("{}-other", row.participant));
        assert_eq!(other, row.embedding);
        let apart = dial.read(&own).unwrap() - dial.read(&other).unwrap();
        assert!(apart.abs() < 1e-4 && own != other, "{row:?}: {apart}");
        // The first eleven ride in styles that the model learned from; then there are ten others who lend theirs.
        let donor = row.lent.donor.as_str();
        let tested = donor.starts_with('P') && donor != "P001-own";
        assert!(!row.lent.donor.as_str().starts_with(row.participant.as_str()));
        assert_eq!(tested, place >= 11, "{row:?}");
        assert!(!["P002-own", "P004-own"].contains(&donor), "{row:?}");
    }
    let consents = study.read("mine/seat/consents.csv");
    let lending = |answer: &str| consents.lines().filter(|l| l.ends_with(answer)).count();
    assert_eq!((lending(",true"), lending(",false")), (12, 2), "{consents}");
    let notes = study.read("mine/seat/notes.csv");
    assert!(!notes.contains("another style"), "{notes}");
    // The run knows what was ridden.
    drop(server);
    study.mine("run --set epochs=2").ok();
    let placed = read_conditions(&folder.join("results/conditions.csv")).unwrap();
    let placed: Vec<_> = placed.iter().filter(|row| row.condition.as_str() == "other").collect();
    assert_eq!(placed.len(), lent.len());
    for (placed, lent) in placed.into_iter().zip(&lent) {
        assert_eq!(placed.participant, lent.participant);
        assert_eq!(placed.embedding, lent.embedding);
        assert_eq!(placed.lent.as_ref().unwrap().donor, lent.lent.donor);
    }
    Page::read(&study.path("mine/report/index.html")).says(&[
        "beside somebody else’s style of the same score",
        "12 people were lent the style of",
        "Versions of the consent",
        "Lend their style",
        "Do people tell which ride was in their own style?",
        "Differences by another choice",
        "Mean answer to each item, of scores that are also tested without some",
        "2 I felt at ease. (left out)",
    ]);
    // All say the same of the two rides, and half of them rode in their own style first: half are right.
    let analysis = analysis(&study);
    let which = &analysis["which"];
    assert_eq!((&which["all"]["n"], &which["all"]["correct"]), (&12.into(), &6.into()));
    let mut right = [0, 1].map(|place| which["by_place"][place]["correct"].as_u64().unwrap());
    right.sort_unstable();
    assert_eq!(right, [0, 6]);
    let without = &analysis["sensitivity"][0];
    assert_eq!((&without["items"][0], &without["n"][1]), (&2.into(), &12.into()));
    let scores = study.read("mine/results/rating_scores.csv");
    assert!(scores.contains(",calm,total_without_2,"), "{scores}");
    let items = study.read("mine/results/rating_scores_item_means.csv");
    for row in ["calm,1,mine,12,", "calm,2,other,12,"] {
        assert!(items.contains(row), "{items}");
    }
    // What is given away names no donor by an id.
    study.write("mine/key.txt", "no key of anybody's, for a test alone");
    let export = "export --key key.txt --out given";
    study.mine(export).ok();
    let given = study.read("mine/given/seat/lent.csv");
    assert_eq!(given.lines().count(), 13);
    let ids = lent.iter().flat_map(|row| [row.lent.donor.as_str(), row.participant.as_str()]);
    for id in ids {
        assert!(!given.contains(id), "{id}: {given}");
    }
}
