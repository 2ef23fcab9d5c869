use super::*;
use crate::{
    recordings::testing::{alone, drives, study},
    stages::validate::{Checked, LeaveOut},
};
use maveric_domain::Drive;
use maveric_rehearsal::leave_out::By;
use std::path::Path;

fn options(folder: &Path) -> Validate {
    Validate {
        run: folder.to_owned(),
        models: Vec::new(),
        leave_out: Some(LeaveOut::People),
        design: Some(folder.join("study.toml")),
        heads: HeadsKind::Linear,
        permutations: Some(20),
        out: folder.join("out"),
        scenario: None,
        duration_s: Some(60.0),
        points: 15.0,
        worlds: 1,
        seed: 1,
        jobs: 2,
        command: None,
    }
}

fn run(options: &Validate) -> Result<Outcome<InTurn>, StudyError> {
    let outcome = crate::Stage::run(options, Watch::unwatched())?;
    Ok(outcome.map(|value| match value {
        Checked::InTurn(found) => found,
        Checked::DroveTwice(_) => panic!("nobody was asked to drive twice"),
    }))
}

/// The file of a model that was learned from all six.
fn elsewhere(folder: &Path) -> std::path::PathBuf {
    let given: Vec<maveric_model::TrainingDrive<'_>> = drives()
        .iter()
        .map(|drive| maveric_model::TrainingDrive {
            drive,
            adb: maveric_domain::ScoreRange::ADB
                .score(if drive.meta().condition.as_str() == "sporty" { 45.0 } else { 20.0 })
                .ok(),
        })
        .collect();
    let mut observe = |_: &maveric_model::EpochReport| std::ops::ControlFlow::Continue(());
    let trained = maveric_model::train(&given, &TrainSettings::default(), 1, &mut observe).unwrap();
    let path = folder.join("elsewhere.maveric");
    let bytes = maveric_model::model_file::to_bytes(&trained.model).unwrap();
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn six_people_told_to_drive_differently_are_placed_recognised_and_repeated_whatever_the_threads() {
    let folder = study(drives());
    let mut options = options(folder.path());
    let found = run(&options).unwrap().value;
    let ids: Vec<&str> = found.tables.iter().map(|t| t.asked.id.as_str()).collect();
    assert_eq!(ids, ["order", "identity-calm", "retest-calm", "errors-calm"]);
    let Some(Answer::Order(order)) = &found.tables[0].answer else {
        panic!("{:?}", found.tables[0]);
    };
    let line = order.by(By::Line).unwrap();
    assert_eq!(line.n, 6);
    assert!(line.right >= 5, "{order:?}");
    assert!(line.p.unwrap() < 0.5 && order.permutations == 20, "{order:?}");
    let Some(Answer::Retest { measures, .. }) = &found.tables[2].answer else {
        panic!("{:?}", found.tables[2]);
    };
    let speed = measures.iter().find(|m| m.measure == "mean_velocity_mps");
    let speed = speed.unwrap();
    assert!(speed.n == 6 && speed.icc.is_some(), "{speed:?}");
    let Some(Answer::Errors(errors)) = &found.tables[3].answer else {
        panic!("{:?}", found.tables[3]);
    };
    // A coordinate of which a short drive says nothing is not counted.
    assert!(errors.pairs == 6 && (12..=18).contains(&errors.coordinates), "{errors:?}");
    let questions: Vec<String> = found.findings.iter().map(|f| f.question.to_string()).collect();
    assert_eq!(questions, ["order", "beyond-speed", "recognised"]);
    let read = |name: &str| std::fs::read_to_string(options.out.join(name)).unwrap();
    let (json, page) = (read("validation.json"), read("index.html"));
    assert!(!json.contains("NaN") && !page.contains("NaN"));
    assert!(page.contains("calm") && page.contains("Synthetic"));
    options.jobs = 1;
    options.out = folder.path().join("again");
    run(&options).unwrap();
    let again = std::fs::read_to_string(options.out.join("validation.json")).unwrap();
    assert!(again == json, "the same bytes on one thread");
}

#[test]
fn whoever_drove_once_and_a_drive_that_shows_nothing_are_named_and_left_out_of_what_needs_them() {
    // P5 has no sporty drive, and P4 stood still in it.
    let mut kept: Vec<Drive> = drives().to_vec();
    kept.retain(|d| d.meta().drive.as_str() != "P5-sporty");
    let standing = kept.iter_mut().find(|d| d.meta().drive.as_str() == "P4-sporty").unwrap();
    *standing = standing.slice(0, 30).unwrap();
    let folder = study(&kept);
    let outcome = run(&options(folder.path())).unwrap();
    let Some(Answer::Order(order)) = &outcome.value.tables[0].answer else {
        panic!();
    };
    assert!(order.by(By::Line).unwrap().n <= 5);
    let said = outcome.warnings.join("\n");
    assert!(said.contains("P5 is not counted: no drive in the role `sporty`"), "{said}");
    assert!(said.contains("P4-sporty"), "{said}");
}

#[test]
fn too_few_people_and_roles_that_nobody_drove_are_said_and_their_tables_stay_empty() {
    let folder = study(&drives()[..6]);
    let found = run(&options(folder.path())).unwrap();
    let why = found.value.tables[0].unanswered.as_ref().unwrap();
    assert!(why.contains("2 people") && why.contains("at least 3"), "{why}");
    assert!(found.value.findings.is_empty());
    let calm = drives().iter().filter(|d| d.meta().condition.as_str() == "calm");
    let said = run(&options(study(calm).path())).unwrap_err();
    assert!(said.to_string().contains("no two roles"), "{said}");
    let folder = study([]);
    std::fs::create_dir_all(folder.path().join("drives")).unwrap();
    assert!(run(&options(folder.path())).unwrap_err().to_string().contains("holds no drives"));
}

/// Declares what the tables of a study's design are.
fn declare(folder: &Path, tables: &str) {
    let path = folder.join("study.toml");
    let text = std::fs::read_to_string(&path).unwrap() + tables;
    std::fs::write(path, text).unwrap();
}

#[test]
fn no_verdict_rests_on_a_table_that_was_seen() {
    let folder = study(drives());
    let mut options = options(folder.path());
    options.permutations = None;
    let table = |id: &str, seen: bool, higher: &str| {
        format!(
            "[[validate.table]]\nid = \"{id}\"\nasks = \"order\"\nseen = {seen}\nhigher = \"{higher}\"\nlower = [\"calm\"]\n"
        )
    };
    let tables = [
        "[validate]\nsource = \"a laboratory\"\norder_of_drives = \"calm first\"\npermutations = 10\n",
        &table("seen", true, "sporty"),
        &table("nobody", false, "asleep"),
    ];
    declare(folder.path(), &tables.concat());
    let seen = run(&options).unwrap().value;
    assert!(seen.findings.is_empty(), "{:?}", seen.findings);
    let Some(Answer::Order(order)) = &seen.tables[0].answer else {
        panic!("{:?}", seen.tables[0]);
    };
    assert_eq!(order.permutations, 10);
    let why = seen.tables[1].unanswered.as_deref();
    assert_eq!(why, Some("nobody drove in the role `asleep`"));
    let page = std::fs::read_to_string(options.out.join("index.html")).unwrap();
    assert!(page.contains("a laboratory") && page.contains("calm first"));
    declare(folder.path(), &table("unseen", false, "sporty"));
    assert_eq!(run(&options).unwrap().value.findings.len(), 2);
}

#[test]
fn the_dial_is_driven_beside_directions_and_a_model_from_elsewhere_is_asked_what_it_says() {
    let folder = study(drives());
    let mut options = options(folder.path());
    let model = elsewhere(folder.path());
    let roles = "learn = [\"calm\", \"sporty\"]\nhigher = \"sporty\"\nlower = [\"calm\"]\n";
    let text = format!(
        "[[validate.table]]\nid = \"way\"\nasks = \"direction\"\njudged = [\"P0\", \"P1\"]\npoints = 15\ndirections = 50\n{roles}[[validate.table]]\nid = \"said\"\nasks = \"shipped\"\n{roles}"
    );
    declare(folder.path(), &text);
    let without = run(&options).unwrap().value;
    assert!(without.tables[1].unanswered.as_ref().unwrap().contains("--model"));
    options.models = vec![model];
    let found = run(&options).unwrap().value;
    let Some(Answer::Direction { found: way, .. }) = &found.tables[0].answer else {
        panic!("{:?}", found.tables[0]);
    };
    assert_eq!((way.people.len(), way.directions), (2, 50));
    assert!(way.people[0].own[0].unwrap() > 0.0 && way.dial.is_some(), "{way:?}");
    assert_eq!(found.findings[0].verdict, maveric_analysis::Verdict::TooFew);
    let Some(Answer::Shipped(said)) = &found.tables[1].answer else {
        panic!("{:?}", found.tables[1]);
    };
    assert_eq!(said.n, 6);
    assert!(said.people.iter().filter(|p| p.line.unwrap() > 0.0).count() >= 5, "{said:?}");
    let page = std::fs::read_to_string(options.out.join("index.html")).unwrap();
    assert!(page.contains("Does the dial point where people themselves go"));
}

fn all_six(folder: &Path) {
    let roles = "learn = [\"calm\", \"sporty\", \"calm-again\"]\n";
    let pair = "higher = \"sporty\"\nlower = [\"calm\"]\n";
    let of = |asks: &str, keys: &str| {
        format!("[[validate.table]]\nid = \"{asks}\"\nasks = \"{asks}\"\n{roles}{keys}")
    };
    let tables = [
        of("order", pair),
        of("identity", "among = \"calm\"\nsought = \"calm\"\n"),
        of("retest", "role = \"calm\"\n"),
        of("errors", "role = \"calm\"\n"),
        of(
            "direction",
            &format!("{pair}judged = [\"P0\", \"P1\"]\npoints = 15\ndirections = 20\n"),
        ),
        of("shipped", pair),
    ];
    declare(folder, &format!("[validate]\npermutations = 5\n{}", tables.concat()));
}

#[test]
fn a_drive_without_lanes_and_one_without_anybody_ahead_are_named_in_every_table_that_lacks_them() {
    let mut kept: Vec<Drive> = drives().to_vec();
    for drive in &mut kept {
        match drive.meta().drive.as_str() {
            "P0-calm" => *drive = drive.clone().without_lateral(),
            // The same person on the same day, with nobody else on the road.
            "P1-sporty" => *drive = alone(drive, 1, 1.5, 11),
            "P2-calm" => *drive = alone(drive, 2, -1.5, 20),
            _ => {}
        }
    }
    let folder = study(&kept);
    let mut options = options(folder.path());
    all_six(folder.path());
    options.permutations = None;
    options.models = vec![elsewhere(folder.path())];
    let outcome = run(&options).unwrap();
    let found = outcome.value;
    let unanswered: Vec<&str> =
        found.tables.iter().filter(|t| t.answer.is_none()).map(|t| t.asked.id.as_str()).collect();
    assert!(unanswered.is_empty(), "{unanswered:?}");
    let named = outcome.warnings.join("\n");
    for wanted in [
        "order: P1 is not counted: drive P1-sporty shows no vehicle ahead, so no time gap",
        "order: P2 is not counted: drive P2-calm shows no vehicle ahead, so no time gap",
        "identity: P2 is not counted: drive P2-calm shows no vehicle ahead, so no time gap",
        "shipped: support is not known: the model learned from 6 people, too few to say",
    ] {
        assert!(named.contains(wanted), "{wanted}\n{named}");
    }
    let lacks = |who: &str, measure: &str| {
        let of = |line: &&str| line.starts_with("retest: ") && line.contains(who);
        named.lines().filter(of).any(|line| line.contains(measure))
    };
    assert!(lacks("P2", "median time gap"), "{named}");
    assert!(lacks("P0", "counted in the rest"), "{named}");
    let Some(Answer::Order(order)) = &found.tables[0].answer else {
        panic!();
    };
    let n = |by| order.by(by).unwrap().n;
    assert_eq!((n(By::Speed), n(By::TimeGap)), (6, 4));
    for name in ["validation.json", "validation.md", "index.html"] {
        let text = std::fs::read_to_string(options.out.join(name)).unwrap();
        assert!(!text.contains("NaN"), "{name}");
    }
}

#[test]
fn a_model_of_too_few_people_says_that_support_is_not_known() {
    let folder = study(drives());
    let mut options = options(folder.path());
    all_six(folder.path());
    options.permutations = None;
    options.models = vec![elsewhere(folder.path())];
    let outcome = run(&options).unwrap();
    let tables = outcome.value.tables.iter();
    let shipped = tables.filter_map(|t| match &t.answer {
        Some(Answer::Shipped(shipped)) => Some(shipped),
        _ => None,
    });
    let [shipped] = shipped.collect::<Vec<_>>()[..] else {
        panic!();
    };
    assert_eq!((shipped.people_learned_from, shipped.n), (6, 6));
    assert!(shipped.unknown > 0, "{shipped:?}");
    assert!(shipped.people.iter().all(|p| p.line_se.is_some()));
    let markdown = std::fs::read_to_string(options.out.join("validation.md")).unwrap();
    for text in [outcome.warnings.join("\n"), markdown] {
        let says = |words: &str| text.contains(words);
        assert!(says("support is not known") && says("6 people, too few to say"), "{text}");
    }
}
