//! What is analysed, and the list of what is missing.

use super::*;

/// Two trials a person and condition, 0.2 s to both sides of the mean: 2, 2.1, 2.2, 2.3 s in the calm car and 0.5, 0.6, 0.7, 0.8 s more in the
/// sporty one.
fn table() -> String {
    table_of(&PEOPLE)
}

/// The recorded study with measures of its own.
fn measured() -> TempStudy {
    let study = recorded(&["calm", "sporty"]);
    change(&study, "mine/study.toml", "[contrasts]", &format!("{DECLARED}[contrasts]"));
    study.write("mine/measures.csv", table());
    study
}

fn without_logs(study: &TempStudy) {
    let logs = study.path("mine/logs");
    std::fs::remove_dir_all(&logs).unwrap();
    std::fs::create_dir(&logs).unwrap();
}

#[test]
fn a_measure_of_ones_own_is_an_outcome_like_ours() {
    let study = measured();
    let run = study.mine("run").ok();
    tells(&run.stderr, &["no [[measure]] declares are not read: rater"]);
    let own = study.read("mine/results/measurements_own.csv");
    assert_eq!(own.lines().count(), 1 + 2 * 2 * PEOPLE.len(), "{own}");
    tells(&own, &["\nP01,calm,tor_s,2.0,2\n", "\nP02,calm,glances,4.0,2\n"]);
    let analysis = analysis(&study);
    let time = panel(&analysis, "tor_s").unwrap();
    assert_eq!((&time["title"], &time["unit"]), (&"Take-over time".into(), &"s".into()));
    assert_eq!((&time["n"], &time["differences_from"]), (&4.into(), &Value::Null));
    // Nobody took over from their own drive, from which other measures are differences.
    let speed = panel(&analysis, "mean_velocity_mps").unwrap();
    assert_eq!(speed["differences_from"], "own");
    assert!(!time["comparison"].is_null(), "{time}");
    let contrast = &time["contrasts"][0];
    assert_eq!((&contrast["first"], &contrast["second"]), (&"sporty".into(), &"calm".into()));
    let difference = contrast["mean_difference"].as_f64().unwrap();
    assert!((difference - 0.65).abs() < 1e-9, "{contrast}");
    let described = analysis["descriptives"].as_array().unwrap().iter();
    let mut described =
        described.filter(|row| row["outcome"] == "tor_s" && row["condition"] == "calm");
    assert!((described.next().unwrap()["mean"].as_f64().unwrap() - 2.15).abs() < 1e-9);
    let page = Page::read(&study.path("mine/report/index.html"));
    page.says(&["Take-over time", "Taking over from the sporty car takes longer"]);
    page.is_silent_of(&["What is not there"]);
    assert!(!study.path("mine/report/missing.csv").exists());
    // What is measured of the drives is what it was.
    let drives = Table::read(&study.path("mine/results/measurements.parquet"));
    assert!(!drives.unwrap().has("tor_s"));
    study.mine("codebook --scales scales --out book").ok();
    assert!(
        study.read("mine/book/codebook_measures.csv").contains("\ntor_s,Take-over time,s,down\n")
    );
    assert!(
        study.read("mine/book/codebook.md").contains("| `glances` | glances | 1 | not known |")
    );
    let described = study.mine("design describe").ok().stdout;
    tells(&described, &["the study's own (Take-over time, glances;"]);
}

#[test]
fn what_the_study_does_not_know_is_refused_before_anything_runs() {
    let study = measured();
    for (from, to, words) in [
        (
            "P03,calm,1",
            "P30,calm,1",
            &["measures.csv", "row 9", "`participant`", "`P30`", "participants.csv: P01, P02"][..],
        ),
        (
            "P03,calm,1",
            "P03,clam,1",
            &["measures.csv", "row 9", "`condition`", "`clam`", "calm, sporty"],
        ),
        (
            "P03,calm,2",
            "P03,calm,1",
            &["measures.csv", "row 10", "P03, calm, 1", "row 9 says so already"],
        ),
    ] {
        study.write("mine/measures.csv", table().replace(from, to));
        study.mine("run").failed(1, words);
        assert!(!study.path("mine/results").exists());
    }
    study.write("mine/measures.csv", table());
    change(&study, "mine/study.toml", "id = \"glances\"", "id = \"lane_changes\"");
    let words = ["study.toml", "`measure.id`: found `lane_changes`", "measured of every drive"];
    study.mine("run").failed(1, &words);
    change(&study, "mine/study.toml", "id = \"lane_changes\"\nunit = \"1\"", "id = \"glances\"");
    study.mine("run").failed(1, &["study.toml", "`measure.glances.unit`: found nothing"]);
}

#[test]
fn answers_alone_make_a_page_that_says_what_is_not_there() {
    let study = recorded(&["calm", "sporty"]);
    without_logs(&study);
    let before = study.mine("status").ok().stderr;
    tells(&before, &["missing: log 12 of 12, drive 12 of 12"]);
    assert!(before.contains("calm, log: no log (everybody)"), "{before}");
    study.mine("run").ok();
    let analysis_of_all = analysis(&study);
    assert!(panel(&analysis_of_all, "mean_velocity_mps").is_none());
    assert_eq!(panel(&analysis_of_all, "comfort.total").unwrap()["n"], 4);
    let page = Page::read(&study.path("mine/report/index.html"));
    page.says(&["What is not there", "There are no drives", "no log", "comfort"]);
    let missing = study.read("mine/report/missing.csv");
    assert_eq!(missing.lines().count(), 1 + 3 * PEOPLE.len(), "{missing}");
    assert!(missing.contains("\nP01,own,no log,no log,,\n"), "{missing}");
    let again = study.mine("run").ok();
    assert!(again.stdout.contains("nothing was run"), "{}", again.stdout);
    // With a table that lists three of them, the fourth is a stranger.
    study.write("mine/participants.csv", "participant\nP01\nP02\nP03\n");
    study.mine("run").ok();
    assert_eq!(analysis(&study)["participants"], 3);
}

#[test]
fn own_measures_alone_are_a_study_and_nothing_at_all_is_none() {
    let study = measured();
    without_logs(&study);
    std::fs::remove_file(study.path("mine/surveys/answers.csv")).unwrap();
    study.mine("run").ok();
    let analysis = analysis(&study);
    let outcomes = analysis["panels"].as_array().unwrap().iter();
    let outcomes: Vec<&str> = outcomes.map(|p| p["outcome"].as_str().unwrap()).collect();
    assert_eq!(outcomes, ["tor_s", "glances"]);
    Page::read(&study.path("mine/report/index.html"))
        .says(&["Take-over time", "What is not there"]);
    std::fs::remove_file(study.path("mine/measures.csv")).unwrap();
    study.mine("run").failed(1, &["`surveys/answers.csv`, which does not exist"]);
}

#[test]
fn each_thing_that_is_missing_is_listed_with_its_reason_before_a_run_and_after() {
    let study = measured();
    std::fs::remove_file(study.path("mine/logs/P02-calm.csv")).unwrap();
    study.write("mine/logs/P03-sporty.csv", "t,x\nno,log\n");
    let answers = study.read("mine/surveys/answers.csv");
    let kept =
        answers.lines().filter(|l| !l.starts_with("P04,calm,hurry") && !l.starts_with("P01,pre"));
    study.write("mine/surveys/answers.csv", kept.collect::<Vec<_>>().join("\n") + "\n");
    let rows = table();
    let rows = rows.lines().filter(|l| !l.starts_with("P01,sporty"));
    study.write("mine/measures.csv", rows.collect::<Vec<_>>().join("\n") + "\n");
    let list = || {
        study.mine("status --missing missing.csv").ok();
        let table = study.read("mine/missing.csv");
        let rows: Vec<String> = table.lines().skip(1).map(str::to_owned).collect();
        rows
    };
    let before = list();
    let waits = "its log is not ingested yet";
    assert!(before.contains(&format!("P01,calm,,{waits},,")), "{before:#?}");
    assert!(before.contains(&format!("P04,calm,,{waits},not answered: hurry,")), "{before:#?}");
    // Every drive is waited for, before the drives one person’s answers.
    assert_eq!(before.len(), 3 * PEOPLE.len() + 1, "{before:#?}");
    study.mine("run").ok();
    let after = list();
    let [pre, sporty, calm, broken, partly] = &after[..] else {
        panic!("{after:#?}");
    };
    assert_eq!(pre, "P01,pre,,,no answers,");
    assert_eq!(sporty, "P01,sporty,,,,no row");
    assert_eq!(calm, "P02,calm,no log,no log,,");
    assert!(broken.starts_with("P03,sporty,,") && broken.contains("P03-sporty.csv"), "{broken}");
    assert_eq!(partly, "P04,calm,,,not answered: hurry,");
    let missing = study.read("mine/report/missing.csv");
    assert_eq!(missing.lines().skip(1).collect::<Vec<_>>(), after);
    let json = study.mine("status --format json").ok().stdout;
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["missing"]["rows"].as_array().unwrap().len(), after.len());
    study
        .maveric(&["status", "pipelines/smoke.toml", "--missing", "x.csv"])
        .failed(2, &["--missing", "study.toml"]);
}
