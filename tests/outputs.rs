//! What the program never writes over: what it was given, and what other programs made.

use crate::support::{TempStudy, argv};

const KEY: &str = "0123456789abcdef0123456789abcdef";

#[test]
fn no_command_writes_over_what_it_was_given() {
    let study = TempStudy::new();
    let given = argv("log.csv t.csv model scores.csv people.csv design.toml d/a.parquet");
    for name in &given {
        study.write(name, format!("this is {name}"));
    }
    for call in [
        "inspect log.csv --plot log.csv",
        "inspect log.csv --watch ./log.csv",
        "inspect log.csv --mapping t.csv --plot t.csv",
        "stats within t.csv --subject s --within w --value v --figure t.csv",
        "import t.csv --from otree --out t.csv",
        "score --surveys t.csv --out t.csv",
        "score --surveys scores_items.csv --surveys scores.csv --out scores.csv",
        "score --surveys t.csv --participants people.csv --out people.csv",
        "measure --drives d --out d/a.parquet",
        "measure --drives d --participants people.csv --out d/../people.csv",
        "train --drives d --scores scores.csv --out scores.csv",
        "train --drives d --design design.toml --out design.toml",
        "personalize --model model --drives d --out model",
        "personalize --model model --drives d --out new --learning-curve model",
        "steer --model model --embeddings t.csv --out t.csv",
        "steer --model model --embeddings t.csv --out model",
        "steer --model model --embeddings t.csv --attribute a.b --scores scores.csv --out scores.csv",
        "simulate --model model --conditions t.csv --out o --watch t.csv",
        "simulate --model model --conditions t.csv --out o --scenario design.toml --watch design.toml",
        "rate --measures t.csv --participants people.csv --out people.csv",
        "rate --measures t.csv --participants people.csv --out t.csv",
        "rate --measures t.csv --participants people.csv --out study_data/effects.toml",
        "evaluate --drives d --out d/a.parquet",
        "ablate --drives d --scores o/ablation.json --out o",
        "recommend d --design design.toml --out design.toml",
        "stats study d --design design.toml --out design.toml",
        "report d --out d",
    ] {
        let ran = study.maveric(&argv(call));
        assert_eq!(ran.status, Some(1), "{call}: {}", ran.stderr);
        assert!(ran.stderr.contains("is an input of this command"), "{call}: {}", ran.stderr);
    }
    for name in given {
        let now = study.read(name);
        assert_eq!(now, format!("this is {name}"));
    }
}

#[test]
fn an_export_never_mixes_with_what_it_was_made_from() {
    let study = TempStudy::new();
    study.write("key", KEY);
    let people = "participant,study,population,age,gender,professional,order\nAnna,2,students,30,f,false,mimic\n";
    study.write("mine/participants.csv", people);
    let export = |out: &str| {
        let export = argv("export --participants mine/participants.csv --key key --out");
        study.maveric(&[&export[..], &[out]].concat())
    };
    export("mine").failed(1, &["`participants.csv`, which no export wrote"]);
    assert_eq!(study.read("mine/participants.csv"), people);
    export("given").ok();
    study.write("mine/participants.csv", people.replace("Anna", "Bert"));
    export("given").ok();
    let table = study.read("given/participants.csv");
    assert_eq!(table.lines().count(), 2, "{table}");
    assert!(!table.contains("Anna") && !table.contains("Bert"));
    study.write("given/raw.csv", "Anna");
    export("given").failed(1, &["`raw.csv`, which no export wrote"]);
}

#[test]
fn recordings_of_people_are_not_written_over_by_made_up_ones() {
    let study = TempStudy::new();
    let generate = argv("generate --learn 1 --test 1 --duration 20 --out o");
    study.maveric(&generate).ok();
    study.maveric(&generate).ok();
    let log =
        std::fs::read_dir(study.path("o/logs/study1")).unwrap().next().unwrap().unwrap().path();
    let made = std::fs::read(&log).unwrap();
    let at = made.windows(9).position(|w| w == b"synthetic").unwrap();
    let mut recorded = made.clone();
    recorded[at..at + 9].copy_from_slice(b"humanoid!");
    std::fs::write(&log, &recorded).unwrap();
    study.maveric(&generate).failed(1, &["is a recording (MCAP)", "made-up"]);
    assert_eq!(std::fs::read(&log).unwrap(), recorded);
}
