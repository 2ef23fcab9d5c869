//! Who is left out is nowhere: every byte that is written afterwards is read.

#![allow(
    clippy::case_sensitive_file_extension_comparisons,
    reason = "its files are the program's own"
)]

mod traces;

use crate::support::{Ran, TempStudy, files, tells};
use maveric_study::{
    DesignFile,
    forget::{forget_person, refuse_learned_from_gone},
    tables::{Table, drives::read_drive, embeddings::read_embeddings},
};
use std::fmt::Write as _;
use traces::{Traces, nowhere};

/// Somebody whom the model learns from, and somebody who rides.
const LEARNED: &str = "Pae2ad5c3f7";
const TESTED: &str = "P968d0fdc85";
const KEY: &str = "a secret of this test alone";

const RUN: &str = "run --set epochs=2 --set duration=60 -j 2";

/// The sample that is shipped, run once.
fn run_once() -> TempStudy {
    let study = TempStudy::of_sample();
    study.write("key", KEY);
    study.mine(RUN).ok();
    collect(&study);
    study
}

/// What a seat would have collected of everybody.
fn collect(study: &TempStudy) {
    let people = study.read("mine/participants.csv");
    let ids = || people.lines().skip(1).filter_map(|line| line.split(',').next());
    let mut events = "participant,step,page,moment,attempt,time_s,what,value,at\n".to_owned();
    let mut consents = "participant,step,text_sha256,at\n".to_owned();
    let mut notes =
        "at,participant,by,text\n2026-11-23T10:00:00Z,,experimenter,a window was open\n".to_owned();
    for id in ids() {
        let _ = writeln!(events, "{id},5,own,,1,12.5,uncomfortable,,");
        let _ = writeln!(events, "{id},9,end,,,,done,,2026-11-23T10:00:00Z");
        let _ = writeln!(consents, "{id},1,{},2026-11-23T09:00:00Z", "ab".repeat(32));
        let _ = writeln!(notes, "2026-11-23T10:00:00Z,{id},seat,{id}-own: 60 s");
    }
    for (name, text) in [("events", events), ("consents", consents), ("notes", notes)] {
        study.write(&format!("mine/seat/{name}.csv"), text);
    }
}

fn export(study: &TempStudy, out: &str) -> Ran {
    let line = format!(
        "export --logs logs/study1 --logs logs/study2 --participants participants.csv \
         --surveys results/answers.csv --seat seat --notes --key ../key \
         --pipeline .maveric/study.toml --out ../{out}"
    );
    study.mine(&line)
}

/// What the lab itself keeps: what was there before any run, lists of exclusions, what runs note of themselves.
fn labs(name: &str) -> bool {
    let own = ["logs/", "surveys/", "scales/", ".maveric/", "seat/"];
    own.iter().any(|own| name.starts_with(own))
        || ["study.toml", "participants.csv"].contains(&name)
        || name.ends_with("exclusions.csv") && name.starts_with("results/")
}

/// A change to the study's design.
fn exclude(study: &TempStudy, rules: &str) {
    let text = study.read("mine/study.toml");
    study.write("mine/study.toml", format!("{text}\n[exclude]\n{rules}\n"));
}

/// Takes the rows of somebody out of the table of people.
fn delete_rows(study: &TempStudy, people: &[&str]) {
    let text = study.read("mine/participants.csv");
    let kept = text.lines().filter(|l| !people.iter().any(|p| l.starts_with(p)));
    let kept: Vec<&str> = kept.collect();
    study.write("mine/participants.csv", kept.join("\n") + "\n");
}

#[test]
fn whom_the_design_excludes_is_in_nothing_that_is_made_or_given_away() {
    let study = run_once();
    let people = [LEARNED, TESTED];
    let traces = Traces::of(&study, &people);
    let notes = study.read("mine/seat/notes.csv");
    let sick = format!("2026-11-23T11:00:00Z,,experimenter,{TESTED} felt sick\n");
    study.write("mine/seat/notes.csv", notes + &sick);
    export(&study, "shared").ok();
    // What is read finds those who are there: their words, and by themselves their samples.
    for traces in [&traces, &traces.samples_alone()] {
        let reads = std::panic::AssertUnwindSafe(|| nowhere(&study, "shared", traces, |_| false));
        assert!(std::panic::catch_unwind(reads).is_err());
    }
    exclude(
        &study,
        &format!(
            "people = {{ {LEARNED} = \"withdrew consent\", {TESTED} = \"withdrew consent\" }}"
        ),
    );
    // What was learned from them is refused until it is trained anew.
    export(&study, "early")
        .failed(1, &["model.maveric", LEARNED, "withdrew consent", "maveric run train"]);
    assert!(!study.path("early").exists());
    study.mine(RUN).ok();
    nowhere(&study, "mine", &traces, labs);
    let page = study.read("mine/report/index.html");
    assert!(page.contains("withdrew consent"), "the reason is told");
    let methods = study.read("mine/report/manuscript/methods.md");
    tells(
        &methods,
        &[
            "1 person was left out of everything: withdrew consent",
            "1 person was left out of those whom the model learned from: withdrew consent",
        ],
    );
    // A value that nobody has is described of nobody.
    let results = study.read("mine/report/manuscript/results.md");
    assert!(!results.contains("*M* = not known"), "{results}");
    let again = export(&study, "shared").ok();
    tells(&again.stdout, &["2 people left out by exclude.people"]);
    tells(&again.stderr, &["2 people of the export that stood in", "delete"]);
    nowhere(&study, "shared", &traces, |_| false);
    tells(&again.stderr, &["1 that name somebody who is left out are not"]);
    // All that the study has, with tables of the drives and what was analysed.
    let whole = "export --key ../key --out ../whole --drives parquet --notes --pipeline";
    study.mine(whole).ok();
    nowhere(&study, "whole", &traces, |_| false);
    assert!(study.path("whole/outcomes_long.csv").is_file());
    let status = study.mine("status").ok();
    assert!(status.stdout.contains(TESTED) || status.stderr.contains(TESTED));
}

#[test]
fn whoever_has_no_row_among_the_people_any_more_is_as_one_who_was_never_there() {
    let study = run_once();
    let people = [LEARNED, TESTED];
    let traces = Traces::of(&study, &people);
    delete_rows(&study, &people);
    study.mine(RUN).ok();
    nowhere(&study, "mine", &traces, labs);
    let given = export(&study, "shared").ok();
    assert!(
        given.stdout.contains("2 people left out by unknown participant")
            || given.stdout.contains("left out by unknown participant"),
        "{}",
        given.stdout
    );
    nowhere(&study, "shared", &traces, |_| false);
}

#[test]
fn a_drive_that_is_excluded_is_in_nothing_and_its_person_stays() {
    let study = run_once();
    let drive = format!("{TESTED}-own");
    let path = study.path(&format!("mine/results/drives/{drive}.parquet"));
    let speeds = read_drive(&path).unwrap().rows().ego_speed_mps.clone();
    let traces = Traces::by(vec![drive.clone()], vec![speeds]);
    exclude(&study, &format!("drives = {{ \"{drive}\" = \"simulator sickness\" }}"));
    study.mine(RUN).ok();
    nowhere(&study, "mine", &traces, labs);
    let given = export(&study, "shared").ok();
    tells(&given.stdout, &["1 drive left out by exclude.drives"]);
    nowhere(&study, "shared", &traces, |_| false);
    let people = study.read("shared/participants.csv");
    assert_eq!(people.lines().count(), 1 + 8);
    let events = study.read("shared/seat/events.csv");
    assert!(events.contains(",uncomfortable,") && !events.contains("2026"), "{events}");
    let notes = study.read("shared/seat/notes.csv");
    assert!(notes.contains("-own: 60 s") && notes.contains("a window was open"));
    tells(&given.stderr, &["read seat/notes.csv"]);
}

#[test]
fn whoever_is_forgotten_is_nowhere_but_in_the_list_of_ids() {
    let study = run_once();
    let people = [LEARNED, TESTED];
    let traces = Traces::of(&study, &people);
    let model = study.path("mine/results/model.maveric");
    let kept = std::fs::read(&model).unwrap();
    // A note that nobody but the lab can judge.
    study.write(&format!("mine/seat/{TESTED}-calm.jsonl"), "a record");
    study.write("mine/notes.txt", format!("{TESTED} was late"));
    study.write("mine/seat/seat.db-wal", TESTED);
    let design = DesignFile::read(&study.path("mine/study.toml")).unwrap();
    let (mut last, mut last_id) = (None, None);
    for who in people {
        let enrolled = design.people(None).unwrap().enrolled;
        let person = enrolled.iter().find(|p| p.id.as_str() == who).unwrap();
        last = Some(forget_person(&design, &person.id).unwrap());
        last_id = Some(person.id.clone());
    }
    let last = last.unwrap();
    assert_eq!(last.left, [study.path("mine/notes.txt")]);
    // The seat's own file is the seat's to clear.
    for path in ["notes.txt", "seat/seat.db-wal"] {
        std::fs::remove_file(study.path("mine").join(path)).unwrap();
    }
    nowhere(&study, "mine", &traces, |name| name == "forgotten.csv");
    let events = study.read("mine/seat/events.csv");
    assert_eq!(events.lines().count(), 1 + 2 * 6);
    // An export that lies there may hold them under a pseudonym, which only its key tells.
    let earlier = study.write("mine/given/ro-crate-metadata.json", "{}");
    // So may what a run that was cut off moved aside.
    let aside = study.write("mine/results/moved-aside-2026-11-28/drives/a.parquet", "PAR1");
    let again = forget_person(&design, &last_id.unwrap()).unwrap();
    assert_eq!(again.left, [earlier, aside]);
    std::fs::remove_dir_all(study.path("mine/given")).unwrap();
    std::fs::remove_dir_all(study.path("mine/results/moved-aside-2026-11-28")).unwrap();
    // A copy of what had learned from them is refused; what is trained anew is not.
    study.write("mine/results/model.maveric", &kept);
    let refused = refuse_learned_from_gone(&design, &model).unwrap_err().to_string();
    assert!(refused.contains("model.maveric") && refused.contains(LEARNED), "{refused}");
    std::fs::remove_file(&model).unwrap();
    study.mine(RUN).ok();
    refuse_learned_from_gone(&design, &model).unwrap();
    nowhere(&study, "mine", &traces, |name| name == "forgotten.csv");
    export(&study, "shared").ok();
    nowhere(&study, "shared", &traces, |_| false);
    // The design names them no more, and their ids are not given again.
    let text = study.read("mine/study.toml");
    exclude(&study, &format!("people = {{ {TESTED} = \"left\" }}"));
    let named = ["exclude.people", TESTED, "forgotten"];
    study.mine("run").failed(1, &named);
    study.write("mine/study.toml", text);
    let table = study.path("mine/participants.csv");
    let text = std::fs::read_to_string(&table).unwrap();
    std::fs::write(&table, format!("{text}{TESTED},2,internal,30-39,male,false,\n")).unwrap();
    study.mine("run").failed(1, &["participants.csv", TESTED, "forgotten", "another id"]);
}
