//! Studies that are not the paper's, walked with the program: what a `study.toml` says is what happens.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod support;

use support::{
    TempStudy,
    own_logs::{TABLE, answers, only_scales, scale, table},
};

const PEOPLE: [&str; 4] = ["P01", "P02", "P03", "P04"];
const SCALES: [(&str, usize, usize); 2] = [("comfort", 3, 7), ("hurry", 2, 5)];

fn read(study: &TempStudy, path: &str) -> String {
    std::fs::read_to_string(study.path(path)).unwrap()
}

/// Changes a file of the study.
fn change(study: &TempStudy, path: &str, from: &str, to: &str) {
    let text = read(study, path);
    assert!(text.contains(from), "{path} has no {from}:\n{text}");
    study.write(path, text.replace(from, to));
}

fn speed(who: usize, place: usize) -> f64 {
    95.0 + 3.0 * who as f64 + 6.0 * place as f64
}

/// A study whose cars were recorded: logs in km/h, two questionnaires of its own, the condition in the file's name.
fn recorded(conditions: &[&str]) -> TempStudy {
    let study = TempStudy::new();
    let list = conditions.join(",");
    study
        .maveric(&["init", "mine", "--conditions", &list, "--style", "none"])
        .ok();
    let own = [
        ("comfort", scale("comfort", 3, 1, 7, "mean")),
        ("hurry", scale("hurry", 2, 1, 5, "sum")),
    ];
    only_scales(&study, "mine", &own);
    change(
        &study,
        "mine/study.toml",
        "software = \"otree\"",
        "software = \"table\"",
    );
    study.write(
        "mine/surveys/answers.csv",
        answers(&PEOPLE, &SCALES, conditions),
    );
    let names = "[names]\nfile = \"{who}-{condition}\"\ndrive = \"{who}-{condition}\"\nparticipant = \"{who}\"\ncondition = \"{condition}\"\n";
    study.write("mine/mapping.toml", format!("{names}{TABLE}"));
    let rows: Vec<String> = PEOPLE
        .iter()
        .map(|p| format!("{p},,30,,{}", conditions.join(" ")))
        .collect();
    study.write(
        "mine/participants.csv",
        format!(
            "participant,population,age,gender,order\n{}\n",
            rows.join("\n")
        ),
    );
    for (i, who) in PEOPLE.iter().enumerate() {
        for (place, condition) in ["own"].iter().chain(conditions).enumerate() {
            study.write(
                &format!("mine/logs/{who}-{condition}.csv"),
                table(speed(i, place), 30.0, condition),
            );
        }
    }
    study
}

const TO_THE_NUMBERS: [&str; 4] = ["run", "measure", "score", "score-ratings"];

fn measured(study: &TempStudy) -> Vec<(String, String)> {
    study
        .maveric_in(
            "mine",
            &["measure", "--drives", "results/drives", "--out", "m.csv"],
        )
        .ok();
    let text = read(study, "mine/m.csv");
    let cells = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (cells[1].to_owned(), cells[2].to_owned())
    };
    text.lines().skip(1).map(cells).collect()
}

#[test]
fn three_recorded_cars_two_questionnaires_and_no_style() {
    let study = recorded(&["calm", "normal", "sporty"]);
    let ran = study.maveric_in("mine", &TO_THE_NUMBERS).ok();
    assert!(!ran.stderr.contains("train"), "{}", ran.stderr);
    let rows = measured(&study);
    assert_eq!(rows.len(), 16);
    for condition in ["own", "calm", "normal", "sporty"] {
        assert_eq!(rows.iter().filter(|(_, c)| c == condition).count(), 4);
    }
    // 101 km/h are 28.06 m/s, wherever the table says them.
    let speeds = read(&study, "mine/m.csv");
    let line = speeds.lines().find(|l| l.starts_with("P01-calm")).unwrap();
    assert!(line.contains("28.0"), "{line}");
    let ratings = read(&study, "mine/results/rating_scores.csv");
    assert!(ratings.contains(",calm,comfort,total,") && ratings.contains(",sporty,hurry,total,"));
    assert!(!ratings.contains(",pre,") && !ratings.contains("mimic"));
    let again = study.maveric_in("mine", &TO_THE_NUMBERS).ok();
    assert!(again.stdout.contains("nothing was run"), "{}", again.stdout);
}

#[test]
fn the_folders_name_or_a_column_may_say_the_condition() {
    let study = recorded(&["calm", "sporty"]);
    for (i, who) in PEOPLE.iter().enumerate() {
        for (place, condition) in ["own", "calm", "sporty"].iter().enumerate() {
            let old = study.path(&format!("mine/logs/{who}-{condition}.csv"));
            std::fs::remove_file(old).unwrap();
            study.write(
                &format!("mine/logs/{condition}/{who}.csv"),
                table(speed(i, place), 30.0, &condition.to_uppercase()),
            );
        }
    }
    let people = "file = \"{who}\"\ndrive = \"{who}-{condition}\"\nparticipant = \"{who}\"\ncondition = \"{condition}\"\n";
    study.write(
        "mine/mapping.toml",
        format!("[names]\nfolder = \"{{condition}}\"\n{people}{TABLE}"),
    );
    study.maveric_in("mine", &["run", "ingest"]).ok();
    let by_folder = measured(&study);
    assert_eq!(by_folder.len(), 12);
    let words = "columns = { condition = \"car\" }\nwords = { OWN = \"own\", CALM = \"calm\", SPORTY = \"sporty\" }\n";
    study.write(
        "mine/mapping.toml",
        format!("[names]\n{words}{people}{TABLE}"),
    );
    study.maveric_in("mine", &["run", "ingest"]).ok();
    // The drives are called by the column's words now; those of before are gone.
    assert_eq!(measured(&study), by_folder);
    assert!(study.path("mine/results/drives/P01-CALM.parquet").exists());
    assert!(!study.path("mine/results/drives/P01-calm.parquet").exists());
}

#[test]
fn whom_the_design_excludes_is_out_everywhere_and_strangers_are_counted() {
    let study = recorded(&["calm", "sporty"]);
    study.write("mine/logs/P09-calm.csv", table(100.0, 30.0, "calm"));
    study.write("mine/logs/P01-wild.csv", table(100.0, 30.0, "wild"));
    let rules = "[exclude]\npeople = { P02 = \"withdrew consent\" }\ndrives = { P03-calm = \"simulator sickness\" }\n";
    change(&study, "mine/study.toml", "[exclude]", rules);
    study.maveric_in("mine", &TO_THE_NUMBERS).ok();
    let rows = measured(&study);
    assert_eq!(rows.len(), 3 + 2 + 3);
    assert!(!rows.iter().any(|(who, _)| who == "P02" || who == "P09"));
    let listed = read(&study, "mine/results/drives/exclusions.csv");
    for said in [
        "left out by exclude.people: withdrew consent",
        "left out by exclude.drives: simulator sickness",
        "left out by unknown participant: P09 is not in the table of people",
        "`wild` is none of the design's: own, calm, sporty",
    ] {
        assert!(listed.contains(said), "{listed}");
    }
    let ratings = read(&study, "mine/results/rating_scores.csv");
    assert!(
        !ratings.contains("P02,")
            && !ratings.contains("P03,calm")
            && ratings.contains("P03,sporty")
    );
    let ran = study.maveric_in("mine", &["ingest", "--out", "again"]).ok();
    assert!(
        ran.stdout.contains("3 drives left out by exclude.people"),
        "{}",
        ran.stdout
    );
    assert!(
        ran.stdout
            .contains("1 drives left out by unknown condition"),
        "{}",
        ran.stdout
    );
}

#[test]
fn a_fault_of_the_design_names_file_key_value_and_what_would_be_possible() {
    let study = recorded(&["calm", "sporty"]);
    let sound = read(&study, "mine/study.toml");
    for (from, to, words) in [
        (
            "[contrasts]",
            "[contrast]",
            &[
                "study.toml",
                "unknown field `contrast`",
                "did you mean `contrasts`?",
            ][..],
        ),
        (
            "compare = \"all\"",
            "compare = \"against clam\"",
            &["`contrasts.compare`", "`clam`", "did you mean `calm`?"],
        ),
        (
            "id = \"sporty\"",
            "id = \"calm\"",
            &["`condition.id`", "`calm` twice"],
        ),
        (
            "car = { recorded = true }",
            "car = { dial = 1 }",
            &["`condition.calm.car`", "no `[style]`"],
        ),
    ] {
        study.write("mine/study.toml", sound.replacen(from, to, 1));
        study
            .maveric_in("mine", &["ingest", "--out", "d"])
            .failed(1, words);
        study.maveric_in("mine", &["run"]).failed(1, words);
        assert!(!study.path("mine/d").exists());
    }
    study.write("mine/study.toml", &sound);
    change(&study, "mine/participants.csv", "P02,", "P01,");
    study
        .maveric_in("mine", &["ingest", "--out", "d"])
        .failed(1, &["participants.csv", "row 2", "each participant once"]);
}

#[test]
fn a_dial_of_another_score_rehearsed_with_made_up_people() {
    let study = TempStudy::new();
    let init = [
        "init",
        "mine",
        "--conditions",
        "calm,sporty",
        "--style",
        "mdsi.risky",
        "--synthetic",
    ];
    study.maveric(&init).ok();
    let generate = [
        "generate",
        "--design",
        "mine/study.toml",
        "--learn",
        "4",
        "--test",
        "3",
        "--duration",
        "60",
    ];
    study.maveric(&generate).ok();
    let people = read(&study, "mine/participants.csv");
    assert!(
        people.contains("S1P01,learn,") && people.contains("S2P03,test,"),
        "{people}"
    );
    let settings = ["--set", "epochs=2", "--set", "duration=60"];
    study
        .maveric_in("mine", &[&["run", "rate"][..], &settings].concat())
        .ok();
    let conditions = read(&study, "mine/results/conditions.csv");
    assert_eq!(conditions.lines().count(), 1 + 3 * 2);
    // Half a step of 1.7 points either way, on a score from 1 to 6.
    let header: Vec<&str> = conditions.lines().next().unwrap().split(',').collect();
    let at = |name: &str| header.iter().position(|c| *c == name).unwrap();
    for line in conditions.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |name: &str| cells[at(name)].parse::<f64>().unwrap();
        assert!((1.0..=6.0).contains(&number("adb_hat")), "{line}");
        assert!(number("moved_points").abs() < 0.86, "{line}");
        assert!(
            (number("moved_points") > 0.0) == (cells[at("condition")] == "sporty"),
            "{line}"
        );
    }
    assert!(read(&study, "mine/results/ratings.csv").contains(",sporty,jian_trust,"));
    // Real people are never replaced.
    study.write("mine/participants.csv", "participant,part\nP01,test\n");
    study.maveric(&generate).failed(
        1,
        &["mine/participants.csv", "1 people who were not made up"],
    );
}

#[test]
fn status_says_who_is_out_and_what_nobody_drove_and_a_design_names_only_what_there_is() {
    let study = recorded(&["calm", "sporty"]);
    let rules = "[exclude]\npeople = { P02 = \"withdrew consent\" }\n";
    change(&study, "mine/study.toml", "[exclude]", rules);
    for who in PEOPLE {
        std::fs::remove_file(study.path(&format!("mine/logs/{who}-sporty.csv"))).unwrap();
    }
    study.maveric_in("mine", &TO_THE_NUMBERS).ok();
    let said = study.maveric_in("mine", &["status"]).ok().stderr;
    assert!(said.contains("P02 is left out: withdrew consent"), "{said}");
    assert!(
        said.contains("condition sporty: nobody drove it") && !said.contains("calm: nobody"),
        "{said}"
    );
    let sound = read(&study, "mine/study.toml");
    for (more, words) in [
        (
            "[[outcome]]\nmeasure = \"mean_velocity\"\n",
            ["`outcome.measure`", "did you mean `mean_velocity_mps`?"],
        ),
        (
            "[[outcome]]\nscale = \"comfort.totl\"\n",
            ["`outcome.scale`", "did you mean `comfort.total`?"],
        ),
        (
            "[homophily]\nfactors = [\"comfrt\"]\nratings = [\"hurry.total\"]\n",
            ["`homophily.factors`", "did you mean `comfort`?"],
        ),
        (
            "[style]\nscore = \"comfort.total\"\nrange = [1, 9]\n",
            ["`style.range`: found [1, 9]", "within 1 to 7"],
        ),
    ] {
        study.write("mine/study.toml", format!("{more}{sound}"));
        study.maveric_in("mine", &["run"]).failed(1, &words);
    }
    study.write("mine/study.toml", sound.replace("P02 =", "P20 ="));
    study
        .maveric_in("mine", &["run"])
        .failed(1, &["study.toml", "`exclude.people`: found `P20`"]);
}

#[test]
fn five_conditions_on_the_dial_roles_a_baseline_of_another_name_and_then_a_model_from_elsewhere() {
    let study = TempStudy::new();
    let five = "calmer,calm,own_style,brisk,brisker";
    study
        .maveric(&[
            "init",
            "mine",
            "--conditions",
            five,
            "--style",
            "adb.total",
            "--synthetic",
        ])
        .ok();
    let by_hand = "[[role]]\nid = \"brisk\"\n\n[[role]]\nid = \"calm\"\n\n[baseline]";
    change(&study, "mine/study.toml", "[baseline]", by_hand);
    change(&study, "mine/study.toml", "id = \"own\"", "id = \"hand\"");
    let generate = [
        "generate",
        "--design",
        "mine/study.toml",
        "--duration",
        "60",
        "--learn",
    ];
    study
        .maveric(&[&generate[..], &["4", "--test", "3"]].concat())
        .ok();
    // One of the four is a professional and demonstrates both roles.
    let logs = std::fs::read_dir(study.path("mine/logs/study1")).unwrap();
    assert_eq!(logs.count(), 4 + 2);
    study
        .maveric_in("mine", &["run", "steer", "--set", "epochs=2"])
        .ok();
    let conditions = read(&study, "mine/results/conditions.csv");
    assert_eq!(conditions.lines().count(), 1 + 3 * 5);
    let embeddings = read(&study, "mine/results/embeddings.csv");
    assert!(
        embeddings.contains("S2P01-hand,S2P01,hand,true,"),
        "{embeddings}"
    );
    let init = [
        "init",
        "theirs",
        "--conditions",
        "calm,brisk",
        "--style",
        "adb.total",
        "--synthetic",
    ];
    study.maveric(&init).ok();
    let elsewhere = "[model]\nfile = \"../mine/results/model.maveric\"\n\n[people]";
    change(&study, "theirs/study.toml", "[people]", elsewhere);
    change(&study, "theirs/study.toml", "learn = {", "# learn = {");
    let generate = [
        "generate",
        "--design",
        "theirs/study.toml",
        "--duration",
        "60",
        "--learn",
    ];
    study
        .maveric(&[&generate[..], &["0", "--test", "3"]].concat())
        .ok();
    let ran = study.maveric_in("theirs", &["run", "steer"]).ok();
    assert!(!ran.stderr.contains("train:"), "{}", ran.stderr);
    assert_eq!(
        read(&study, "theirs/results/conditions.csv")
            .lines()
            .count(),
        1 + 3 * 2
    );
}

#[test]
fn two_recorded_cars_without_a_drive_by_hand_and_a_factor_between_people() {
    let study = recorded(&["calm", "sporty"]);
    let text = read(&study, "mine/study.toml");
    let (head, rest) = text.split_once("[baseline]").unwrap();
    let rest = &rest[rest.find("# [[outcome]]").unwrap()..];
    study.write(
        "mine/study.toml",
        format!("{head}[[factor]]\ncolumn = \"population\"\n\n{rest}"),
    );
    study.maveric_in("mine", &TO_THE_NUMBERS).ok();
    let rows = measured(&study);
    assert_eq!(rows.len(), 8);
    let listed = read(&study, "mine/results/drives/exclusions.csv");
    assert!(
        listed.contains("`own` is none of the design's: calm, sporty"),
        "{listed}"
    );
    change(
        &study,
        "mine/study.toml",
        "column = \"population\"",
        "column = \"popualtion\"",
    );
    study.maveric_in("mine", &["ingest", "--out", "d"]).failed(
        1,
        &[
            "participants.csv",
            "`popualtion`",
            "did you mean `population`?",
        ],
    );
}
