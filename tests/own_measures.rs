//! What a laboratory brings beside logs: its own measures, answers alone, and the list of what is missing.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod support;

use maveric_study::tables::Table;
use serde_json::Value;
use std::{
    collections::BTreeMap,
    fmt::Write as _,
    path::{Path, PathBuf},
};
use support::{
    TempStudy,
    own_logs::{PEOPLE, change, read, recorded, recorded_of},
    page::Page,
};

const DECLARED: &str = "[[measure]]\nid = \"tor_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\naggression = \"-\"\n\
                        [[measure]]\nid = \"glances\"\nunit = \"1\"\n\
                        [[hypothesis]]\nsays = \"Taking over from the sporty car takes longer\"\noutcome = \"tor_s\"\n\
                        contrast = [\"sporty\", \"calm\"]\ndirection = \"+\"\n";

/// Two trials a person and condition, 0.2 s to both sides of the mean: 2, 2.1, 2.2, 2.3 s in the calm car and 0.5, 0.6, 0.7, 0.8 s more in the
/// sporty one.
fn table() -> String {
    table_of(&PEOPLE)
}

fn table_of(people: &[&str]) -> String {
    let mut text = "participant,condition,trial,tor_s,glances,rater\n".to_owned();
    for (i, who) in people.iter().enumerate() {
        let calm = 2.0 + 0.1 * i as f64;
        for (condition, mean) in [("calm", calm), ("sporty", calm + 0.5 + 0.1 * i as f64)] {
            let _ = writeln!(text, "{who},{condition},1,{:.1},3,A", mean - 0.2);
            let _ = writeln!(text, "{who},{condition},2,{:.1},{},A", mean + 0.2, 4 + i);
        }
    }
    text
}

/// The recorded study with measures of its own.
fn measured() -> TempStudy {
    let study = recorded(&["calm", "sporty"]);
    change(
        &study,
        "mine/study.toml",
        "[contrasts]",
        &format!("{DECLARED}[contrasts]"),
    );
    study.write("mine/measures.csv", table());
    study
}

fn without_logs(study: &TempStudy) {
    let logs = study.path("mine/logs");
    std::fs::remove_dir_all(&logs).unwrap();
    std::fs::create_dir(&logs).unwrap();
}

fn analysis(study: &TempStudy) -> Value {
    serde_json::from_str(&read(study, "mine/results/analysis.json")).unwrap()
}

fn panel<'a>(analysis: &'a Value, outcome: &str) -> Option<&'a Value> {
    let mut panels = analysis["panels"].as_array().unwrap().iter();
    panels.find(|panel| panel["outcome"] == outcome)
}

#[test]
fn a_measure_of_ones_own_is_an_outcome_like_ours() {
    let study = measured();
    let run = study.maveric_in("mine", &["run"]).ok();
    assert!(
        run.stderr
            .contains("no [[measure]] declares are not read: rater"),
        "{}",
        run.stderr
    );
    let own = read(&study, "mine/results/measurements_own.csv");
    assert_eq!(own.lines().count(), 1 + 2 * 2 * PEOPLE.len(), "{own}");
    assert!(
        own.contains("\nP01,calm,tor_s,2.0,2\n") && own.contains("\nP02,calm,glances,4.0,2\n"),
        "{own}"
    );
    let analysis = analysis(&study);
    let time = panel(&analysis, "tor_s").unwrap();
    assert_eq!(
        (&time["title"], &time["unit"]),
        (&"Take-over time".into(), &"s".into())
    );
    assert_eq!(
        (&time["n"], &time["differences_from"]),
        (&4.into(), &Value::Null)
    );
    // Nobody took over from their own drive, from which other measures are differences.
    let speed = panel(&analysis, "mean_velocity_mps").unwrap();
    assert_eq!(speed["differences_from"], "own");
    assert!(!time["comparison"].is_null(), "{time}");
    let contrast = &time["contrasts"][0];
    assert_eq!(
        (&contrast["first"], &contrast["second"]),
        (&"sporty".into(), &"calm".into())
    );
    let difference = contrast["mean_difference"].as_f64().unwrap();
    assert!((difference - 0.65).abs() < 1e-9, "{contrast}");
    let described = analysis["descriptives"].as_array().unwrap().iter();
    let mut described =
        described.filter(|row| row["outcome"] == "tor_s" && row["condition"] == "calm");
    assert!((described.next().unwrap()["mean"].as_f64().unwrap() - 2.15).abs() < 1e-9);
    let page = Page::read(&study.path("mine/report/index.html"));
    page.says(&[
        "Take-over time",
        "Taking over from the sporty car takes longer",
    ]);
    page.is_silent_of(&["What is not there"]);
    assert!(!study.path("mine/report/missing.csv").exists());
    // What is measured of the drives is what it was.
    let drives =
        maveric_study::tables::Table::read(&study.path("mine/results/measurements.parquet"));
    assert!(!drives.unwrap().has("tor_s"));
    study
        .maveric_in("mine", &["codebook", "--scales", "scales", "--out", "book"])
        .ok();
    assert!(
        read(&study, "mine/book/codebook_measures.csv").contains("\ntor_s,Take-over time,s,down\n")
    );
    assert!(
        read(&study, "mine/book/codebook.md").contains("| `glances` | glances | 1 | not known |")
    );
    let described = study
        .maveric_in("mine", &["design", "describe"])
        .ok()
        .stdout;
    assert!(
        described.contains("the study's own (Take-over time, glances;"),
        "{described}"
    );
}

#[test]
fn what_the_study_does_not_know_is_refused_before_anything_runs() {
    let study = measured();
    for (from, to, words) in [
        (
            "P03,calm,1",
            "P30,calm,1",
            &[
                "measures.csv",
                "row 9",
                "`participant`",
                "`P30`",
                "participants.csv: P01, P02",
            ][..],
        ),
        (
            "P03,calm,1",
            "P03,clam,1",
            &[
                "measures.csv",
                "row 9",
                "`condition`",
                "`clam`",
                "calm, sporty",
            ],
        ),
        (
            "P03,calm,2",
            "P03,calm,1",
            &[
                "measures.csv",
                "row 10",
                "P03, calm, 1",
                "row 9 says so already",
            ],
        ),
    ] {
        study.write("mine/measures.csv", table().replace(from, to));
        study.maveric_in("mine", &["run"]).failed(1, words);
        assert!(!study.path("mine/results").exists());
    }
    study.write("mine/measures.csv", table());
    change(
        &study,
        "mine/study.toml",
        "id = \"glances\"",
        "id = \"lane_changes\"",
    );
    let words = [
        "study.toml",
        "`measure.id`: found `lane_changes`",
        "measured of every drive",
    ];
    study.maveric_in("mine", &["run"]).failed(1, &words);
    change(
        &study,
        "mine/study.toml",
        "id = \"lane_changes\"\nunit = \"1\"",
        "id = \"glances\"",
    );
    study
        .maveric_in("mine", &["run"])
        .failed(1, &["study.toml", "`measure.glances.unit`: found nothing"]);
}

#[test]
fn answers_alone_make_a_page_that_says_what_is_not_there() {
    let study = recorded(&["calm", "sporty"]);
    without_logs(&study);
    let before = study.maveric_in("mine", &["status"]).ok().stderr;
    assert!(
        before.contains("missing: log 12 of 12, drive 12 of 12"),
        "{before}"
    );
    assert!(before.contains("calm, log: no log (everybody)"), "{before}");
    study.maveric_in("mine", &["run"]).ok();
    let analysis_of_all = analysis(&study);
    assert!(panel(&analysis_of_all, "mean_velocity_mps").is_none());
    assert_eq!(panel(&analysis_of_all, "comfort.total").unwrap()["n"], 4);
    let page = Page::read(&study.path("mine/report/index.html"));
    page.says(&[
        "What is not there",
        "There are no drives",
        "no log",
        "comfort",
    ]);
    let missing = read(&study, "mine/report/missing.csv");
    assert_eq!(missing.lines().count(), 1 + 3 * PEOPLE.len(), "{missing}");
    assert!(missing.contains("\nP01,own,no log,no log,,\n"), "{missing}");
    let again = study.maveric_in("mine", &["run"]).ok();
    assert!(again.stdout.contains("nothing was run"), "{}", again.stdout);
    // With a table that lists three of them, the fourth is a stranger.
    study.write("mine/participants.csv", "participant\nP01\nP02\nP03\n");
    study.maveric_in("mine", &["run"]).ok();
    assert_eq!(analysis(&study)["participants"], 3);
}

#[test]
fn own_measures_alone_are_a_study_and_nothing_at_all_is_none() {
    let study = measured();
    without_logs(&study);
    std::fs::remove_file(study.path("mine/surveys/answers.csv")).unwrap();
    study.maveric_in("mine", &["run"]).ok();
    let analysis = analysis(&study);
    let outcomes = analysis["panels"].as_array().unwrap().iter();
    let outcomes: Vec<&str> = outcomes.map(|p| p["outcome"].as_str().unwrap()).collect();
    assert_eq!(outcomes, ["tor_s", "glances"]);
    Page::read(&study.path("mine/report/index.html"))
        .says(&["Take-over time", "What is not there"]);
    std::fs::remove_file(study.path("mine/measures.csv")).unwrap();
    study
        .maveric_in("mine", &["run"])
        .failed(1, &["`surveys/answers.csv`, which does not exist"]);
}

#[test]
fn each_thing_that_is_missing_is_listed_with_its_reason_before_a_run_and_after() {
    let study = measured();
    std::fs::remove_file(study.path("mine/logs/P02-calm.csv")).unwrap();
    study.write("mine/logs/P03-sporty.csv", "t,x\nno,log\n");
    let answers = read(&study, "mine/surveys/answers.csv");
    let kept = answers
        .lines()
        .filter(|l| !l.starts_with("P04,calm,hurry") && !l.starts_with("P01,pre"));
    study.write(
        "mine/surveys/answers.csv",
        kept.collect::<Vec<_>>().join("\n") + "\n",
    );
    let rows = table();
    let rows = rows.lines().filter(|l| !l.starts_with("P01,sporty"));
    study.write(
        "mine/measures.csv",
        rows.collect::<Vec<_>>().join("\n") + "\n",
    );
    let list = || {
        study
            .maveric_in("mine", &["status", "--missing", "missing.csv"])
            .ok();
        let table = read(&study, "mine/missing.csv");
        let rows: Vec<String> = table.lines().skip(1).map(str::to_owned).collect();
        rows
    };
    let before = list();
    let waits = "its log is not ingested yet";
    assert!(
        before.contains(&format!("P01,calm,,{waits},,")),
        "{before:#?}"
    );
    assert!(
        before.contains(&format!("P04,calm,,{waits},not answered: hurry,")),
        "{before:#?}"
    );
    // Every drive is waited for, before the drives one person’s answers.
    assert_eq!(before.len(), 3 * PEOPLE.len() + 1, "{before:#?}");
    study.maveric_in("mine", &["run"]).ok();
    let after = list();
    let [pre, sporty, calm, broken, partly] = &after[..] else {
        panic!("{after:#?}");
    };
    assert_eq!(pre, "P01,pre,,,no answers,");
    assert_eq!(sporty, "P01,sporty,,,,no row");
    assert_eq!(calm, "P02,calm,no log,no log,,");
    assert!(
        broken.starts_with("P03,sporty,,") && broken.contains("P03-sporty.csv"),
        "{broken}"
    );
    assert_eq!(partly, "P04,calm,,,not answered: hurry,");
    let missing = read(&study, "mine/report/missing.csv");
    assert_eq!(missing.lines().skip(1).collect::<Vec<_>>(), after);
    let json = study
        .maveric_in("mine", &["status", "--format", "json"])
        .ok()
        .stdout;
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(
        json["missing"]["rows"].as_array().unwrap().len(),
        after.len()
    );
    study
        .maveric(&["status", "pipelines/smoke.toml", "--missing", "x.csv"])
        .failed(2, &["--missing", "study.toml"]);
}

/// Somebody who withdrew, with rows in every table, and what the lab said of them.
const WITHDREW: &str = "Person03";
const SAID: [&str; 3] = ["felt observed", "Monday", "a remark"];
const KEY: &str = "a secret of this test alone";

/// A study of seven people with a factor between them, a covariate, and somebody who withdrew.
fn with_somebody_who_withdrew() -> TempStudy {
    let people = [
        "Person01", "Person02", WITHDREW, "Person04", "Person05", "Person06", "Person07",
    ];
    let study = recorded_of(&people, &["calm", "sporty"]);
    let declared = format!(
        "{DECLARED}[[factor]]\ncolumn = \"seat\"\nlabel = \"Seat, of Person03 unknown\"\n[[covariate]]\ncolumn = \"years\"\n[contrasts]"
    );
    change(&study, "mine/study.toml", "[contrasts]", &declared);
    let excluded = "# Person03 called on Monday\n[exclude]\npeople = { Person03 = \"withdrew, felt observed\" }\n";
    change(&study, "mine/study.toml", "[exclude]", excluded);
    study.write("mine/measures.csv", table_of(&people));
    let mut rows = "participant,age,seat,years,order,remark\n".to_owned();
    for (i, who) in people.iter().enumerate() {
        let seat = ["high", "low"][i % 2];
        let _ = writeln!(
            rows,
            "{who},3{i},{seat},{}.5,calm sporty,a remark",
            3 * i + i * i
        );
    }
    study.write("mine/participants.csv", rows);
    study.write("key", KEY);
    study
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let below = entries.flat_map(|entry| {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path)
        } else {
            vec![path]
        }
    });
    let mut all: Vec<PathBuf> = below.collect();
    all.sort();
    all
}

/// Whether a word stands in a text, not inside another.
fn says(text: &str, word: &str) -> bool {
    let inside = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
    text.match_indices(word).any(|(at, _)| {
        !inside(text[..at].chars().next_back()) && !inside(text[at + word.len()..].chars().next())
    })
}

/// The files of a folder, by name or by what they hold, that say one of these words.
fn naming(folder: &Path, words: &[&str]) -> Vec<PathBuf> {
    let mut all = files(folder);
    all.retain(|path| {
        let mut text = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
        text += &path.strip_prefix(folder).unwrap().to_string_lossy();
        if path.extension().is_some_and(|e| e == "parquet") {
            let table = Table::read(path).unwrap();
            let cells = table.columns().into_iter().map(|c| table.text(&c).unwrap());
            text.extend(cells.flatten().flatten().map(|cell| cell + "\n"));
        }
        words.iter().any(|word| says(&text, word))
    });
    all
}

/// The rows of a table of numbers and plain words, by column.
fn rows(study: &TempStudy, path: &str) -> Vec<BTreeMap<String, String>> {
    let text = read(study, path);
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let names: Vec<String> = lines.next().unwrap().collect();
    lines
        .map(|cells| names.iter().cloned().zip(cells).collect())
        .collect()
}

/// Mean and number of the values of an outcome in a condition.
fn mean(long: &[BTreeMap<String, String>], outcome: &str, condition: &str) -> (f64, usize) {
    let there = long.iter().filter(|row| row["condition"] == condition);
    let values: Vec<f64> = there.filter_map(|row| row[outcome].parse().ok()).collect();
    (
        values.iter().sum::<f64>() / values.len() as f64,
        values.len(),
    )
}

#[test]
fn what_is_given_away_is_what_was_analysed_and_nothing_of_whoever_withdrew() {
    let study = with_somebody_who_withdrew();
    study.maveric_in("mine", &["run"]).ok();
    let export = |more: &[&str]| {
        let words = [
            "export",
            "--key",
            "../key",
            "--out",
            "../shared",
            "--pipeline",
        ];
        study.maveric_in("mine", &[&words, more].concat())
    };
    let given = export(&["--drives", "parquet"]).ok();
    assert!(
        given
            .stdout
            .contains("6 participants under pseudonyms, 18 drives")
    );
    assert!(
        given.stderr.contains("are `…` in the export"),
        "{}",
        given.stderr
    );
    let key = blake3::derive_key("maveric study export pseudonyms v1", KEY.as_bytes());
    let hash = blake3::keyed_hash(&key, WITHDREW.as_bytes()).to_hex();
    let pseudonym = format!("P{}", &hash[..10]);
    let theirs = [
        &SAID[..],
        &[WITHDREW, pseudonym.as_str(), "Person01", "Person07"],
    ]
    .concat();
    assert_eq!(
        naming(&study.path("shared"), &theirs),
        Vec::<PathBuf>::new()
    );
    // The same search finds them in the study itself, in each kind of file.
    let found = naming(&study.path("mine"), &["Person01", WITHDREW]);
    let ends = |ending: &str| found.iter().any(|p| p.to_string_lossy().ends_with(ending));
    assert!(
        ends("study.toml") && ends("measures.csv") && ends("analysis.json"),
        "{found:?}"
    );
    // Every outcome has the numbers of the analysis, and one row has what the other table has.
    let (long, wide) = (
        rows(&study, "shared/outcomes_long.csv"),
        rows(&study, "shared/outcomes_wide.csv"),
    );
    assert_eq!((long.len(), wide.len()), (18, 6));
    let mut units: BTreeMap<String, f64> = BTreeMap::new();
    for row in analysis(&study)["descriptives"].as_array().unwrap() {
        let (outcome, condition) = (
            row["outcome"].as_str().unwrap(),
            row["condition"].as_str().unwrap(),
        );
        let (value, n) = mean(&long, outcome, condition);
        assert_eq!(row["n"], n, "{row}");
        let Some(analysed) = row["mean"].as_f64().filter(|m| *m != 0.0) else {
            continue;
        };
        let unit = *units.entry(outcome.to_owned()).or_insert(analysed / value);
        assert!(
            (analysed / value / unit - 1.0).abs() < 1e-12,
            "{row}: {value}"
        );
        assert!(
            (unit - 1.0).abs() < 1e-12 || outcome.contains("_mps"),
            "{outcome}: {unit}"
        );
        for row in long.iter().filter(|row| row["condition"] == condition) {
            let person = wide.iter().find(|p| p["participant"] == row["participant"]);
            assert_eq!(
                person.unwrap()[&format!("{outcome}.{condition}")],
                row[outcome]
            );
        }
    }
    let known = units.contains_key("tor_s") && units.contains_key("comfort.total");
    assert!(units.len() == 11 && known, "{units:?}");
    let seats = long.iter().filter(|row| row["seat"] == "high").count();
    assert_eq!(seats, 3 * 3, "the first, fifth and seventh sat high");
    assert!(long.iter().all(|row| row["years"].ends_with(".5")));
    // Each drive stands as a table of as many rows, and by another word as another kind of table alone.
    let drives = files(&study.path("shared/drives"));
    assert_eq!(drives.len(), 18);
    let samples = |path: &Path| Table::read(path).unwrap().rows();
    assert!(drives.iter().all(|path| samples(path) == 1200));
    // What is given away is a study: it can be analysed anew, with the same numbers but for millimetres.
    std::fs::rename(study.path("shared"), study.path("again")).unwrap();
    study.maveric_in("again", &["run"]).ok();
    let again: Value = serde_json::from_str(&read(&study, "again/results/analysis.json")).unwrap();
    let (first, second) = (&analysis(&study)["descriptives"], &again["descriptives"]);
    let (first, second) = (first.as_array().unwrap(), second.as_array().unwrap());
    assert_eq!(first.len(), second.len());
    for (a, b) in first.iter().zip(second) {
        assert_eq!((&a["outcome"], &a["n"]), (&b["outcome"], &b["n"]));
        let [a_mean, b_mean] = [a, b].map(|row| row["mean"].as_f64().unwrap_or_default());
        assert!(
            (a_mean - b_mean).abs() <= 1e-3 * (1.0 + a_mean.abs()),
            "{a} {b}"
        );
    }
}

#[test]
fn an_export_says_what_it_holds_and_is_whole_or_not_there() {
    let study = with_somebody_who_withdrew();
    let export = |more: &[&str]| {
        let words = ["export", "--key", "../key", "--out", "../a/shared"];
        study.maveric_in("mine", &[&words, more].concat())
    };
    export(&["--drives", "xml"]).failed(2, &["[possible values: csv, parquet]"]);
    // Before there are results there are no outcomes, which is said where there is a folder of them.
    export(&["--drives", "csv"]).ok();
    assert!(!study.path("a/shared/outcomes_long.csv").exists());
    let drives = files(&study.path("a/shared/drives"));
    assert!(drives.len() == 18 && drives.iter().all(|d| d.extension().unwrap() == "csv"));
    let design = read(&study, "a/shared/study.toml");
    assert!(design.contains("# 1 person left out by name"), "{design}");
    let readme = read(&study, "a/shared/README.md");
    for part in [
        "6 people, 18 drives and 90 answers",
        "- 1 person left out by exclude.people",
        "| `measures.csv` |",
        "| `drives/` |",
        "read.csv(\"surveys.csv\")",
        "None is given",
    ] {
        assert!(readme.contains(part), "no {part} in {readme}");
    }
    let factors = read(&study, "a/shared/factors.csv");
    for row in [
        "condition,within,",
        ",sporty,Sporty,",
        "seat,between,\"Seat, of … unknown\",high,high,,3",
        "years,covariate,years,,,,6",
    ] {
        assert!(factors.contains(row), "no {row} in {factors}");
    }
    for file in [
        "scales/comfort.toml",
        "codebook.csv",
        "codebook.md",
        "codebook_measures.csv",
        "surveys_wide.csv",
    ] {
        assert!(study.path("a/shared").join(file).is_file(), "{file}");
    }
    // A text that names somebody stops it, and what stood there stays.
    let scale = read(&study, "mine/scales/comfort.toml");
    study.write(
        "mine/scales/comfort.toml",
        format!("# Person03 did not understand item 2\n{scale}"),
    );
    let before = files(&study.path("a"));
    export(&[]).failed(
        1,
        &["comfort.toml", "names `Person03`", "take the name out"],
    );
    assert_eq!(files(&study.path("a")), before);
    let elsewhere = ["export", "--key", "../key", "--out", "../b/c/shared"];
    study
        .maveric_in("mine", &elsewhere)
        .failed(1, &["names `Person03`"]);
    assert!(!study.path("b").exists());
    study.write("mine/scales/comfort.toml", scale);
    study.write("a/shared/mine.txt", "somebody's own");
    export(&[]).failed(1, &["`mine.txt`, which no export wrote", "a new folder"]);
    assert!(study.path("a/shared/drives").exists());
}
