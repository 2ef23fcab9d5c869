//! The small study: everything runs, a second run does nothing, a changed parameter rebuilds what follows and only that.

use super::*;
use maveric_domain::ScoreRange;
use maveric_model::model_file;

const SMOKE: &str = "pipelines/smoke.toml";

fn states(report: &str) -> Vec<(String, String)> {
    let report: serde_json::Value = serde_json::from_str(report).unwrap();
    let text = |v: &serde_json::Value| v.as_str().unwrap().to_owned();
    report["stages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| (text(&s["stage"]), text(&s["state"])))
        .collect()
}

fn is_page(path: &Path) {
    let page = std::fs::read_to_string(path).unwrap();
    assert!(page.contains("ynthetic participants"), "the page says who these people are");
    assert!(!page.contains("NaN"), "no NaN on the page");
    assert!(
        !page.contains("src=\"http") && !page.contains("href=\"http"),
        "the page is self-contained"
    );
}

/// `report` on results that are emptied, or no numbers, or carry names that try to be markup.
fn bad_results_are_said(study: &TempStudy) {
    let path = "study_data/generated/smoke/analysis.json";
    let report = argv("report study_data/generated/smoke --out reports/bad");
    let text = study.read(path);
    let mut empty: serde_json::Value = serde_json::from_str(&text).unwrap();
    empty["participants"] = 0.into();
    for panel in empty["panels"].as_array_mut().unwrap() {
        panel["rows"] = serde_json::json!([]);
        panel["participants"] = serde_json::json!([]);
        panel["contrasts"] = serde_json::json!([]);
    }
    for row in empty["line"]["rows"].as_array_mut().unwrap() {
        row["points"] = serde_json::json!([]);
    }
    for row in empty["kept"].as_array_mut().unwrap() {
        row["points"] = serde_json::json!([]);
    }
    for row in empty["preferences"].as_array_mut().unwrap() {
        row["n"] = 0.into();
    }
    for list in ["reproduction", "nearer", "homophily", "similarity"] {
        empty[list] = serde_json::json!([]);
    }
    study.write(path, empty.to_string());
    let nasty = "<script>alert(1)</script> & \"Eve\" \u{202e}\u{645}\u{631} \u{1f697}";
    let excluded = study.path("study_data/generated/smoke/scores_exclusions.csv");
    let kept = std::fs::read_to_string(&excluded).unwrap();
    let field = format!("\"{}\"", nasty.replace('"', "\"\""));
    study.write(
        "study_data/generated/smoke/scores_exclusions.csv",
        format!("who,what,why\n{field},everything,{field}\n"),
    );
    study.maveric(&report).ok();
    let page = study.read("reports/bad/index.html");
    tells(
        &page,
        &[
            "No participant has a value in any condition",
            "No participant is left along the line",
            "&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;Eve&quot;",
        ],
    );
    assert!(!page.contains("<script>alert") && !page.contains("NaN"));
    study.write(path, text.replacen("\"participants\"", "\"participants\": 1e999, \"x\"", 1));
    study.maveric(&report).failed(1, &["analysis.json"]);
    study.write(path, text);
    std::fs::write(excluded, kept).unwrap();
}

/// How far the dial was turned in truth stands in a table: as far as the conditions' file says, those cut short counted.
fn steps_of_the_dial_are_told(study: &TempStudy) {
    let conditions = study.read("study_data/generated/smoke/conditions.csv");
    let mut lines = conditions.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| head.iter().position(|h| *h == name).unwrap();
    let (condition, moved, clamped) = (at("condition"), at("moved_points"), at("clamped"));
    let rows: Vec<Vec<&str>> = lines.map(|l| l.split(',').collect()).collect();
    let table = study.read("reports/smoke/tables/dial-steps.csv");
    for id in ["aggressive", "cautious"] {
        let own: Vec<&Vec<&str>> = rows.iter().filter(|r| r[condition] == id).collect();
        let steps: Vec<f64> = own.iter().map(|r| r[moved].parse().unwrap()).collect();
        let cut = own.iter().filter(|r| r[clamped] == "true").count();
        let told: Vec<&str> = table
            .lines()
            .find(|l| l.starts_with(id))
            .unwrap_or_else(|| panic!("{id} in {table}"))
            .split(',')
            .collect();
        assert_eq!(told[2], steps.len().to_string(), "n of {id}: {table}");
        assert_eq!(told[3], cut.to_string(), "cut short of {id}: {table}");
        let lowest = steps.iter().copied().fold(f64::INFINITY, f64::min);
        let low: f64 = told[6].replace('\u{2212}', "-").parse().unwrap();
        assert!((low - lowest).abs() < 0.06, "{id}: {low} for {lowest}");
    }
}

#[test]
fn the_small_study_runs_once_and_then_only_what_changed() {
    let study = TempStudy::new();
    let ran = study.maveric(&["run", SMOKE, "-j", "2"]).ok();
    assert!(ran.stdout.contains("index.html"), "it says where the report is: {}", ran.stdout);
    is_page(&study.path("reports/smoke/index.html"));
    for figure in [
        "domain",
        "simulator-view",
        "embedding-space",
        "difference-panels",
        "perpendicular",
        "preference",
    ] {
        let there = |end: &str| {
            let files = std::fs::read_dir(study.path("reports/smoke/figures")).unwrap();
            files.filter_map(Result::ok).any(|f| {
                let name = f.file_name().to_string_lossy().into_owned();
                name.starts_with(figure) && name.ends_with(end)
            })
        };
        assert!(there(".svg") && there(".png"), "figure {figure}");
    }

    let page = study.read("reports/smoke/index.html");
    assert!(page.contains("Habits as events"), "which heads they are");
    let of = |name: &str| page.matches(&format!("<figure id=\"figure-{name}")).count();
    assert_eq!(of("perpendicular"), 1, "one figure, one verdict");
    steps_of_the_dial_are_told(&study);

    bad_results_are_said(&study);
    let again = study.maveric(&["run", SMOKE, "--format", "json"]).ok();
    assert!(
        states(&again.stdout).iter().all(|(_, state)| state == "up_to_date"),
        "{}",
        again.stdout
    );
    assert!(study.maveric(&["run", SMOKE]).ok().stdout.contains("nothing was run"));

    let moved = study.maveric(&["run", SMOKE, "--set", "points=10", "--format", "json"]).ok();
    let upstream = ["generate", "ingest-study1", "ingest-study2", "score", "train", "personalize"];
    for (stage, state) in states(&moved.stdout) {
        let expected = if upstream.contains(&stage.as_str()) { "up_to_date" } else { "done" };
        assert_eq!(state, expected, "{stage}");
    }
}

#[test]
fn people_who_drove_twice_validate_a_model_and_their_first_drives_stay_what_they_were() {
    let study = TempStudy::new();
    let generate = |out: &str, more: &[&str]| {
        let sizes = argv("--study1 3 --study2 3 --duration 240 --seed 1");
        let call = [&["generate", "--out", out], &sizes[..], more].concat();
        study.maveric(&call).ok();
    };
    generate("once", &[]);
    generate("run", &["--repeat-drives"]);
    let log = |path: &str| std::fs::read(study.path(path)).unwrap();
    for file in ["study1/S1P01-own.mcap", "study2/S2P03-own.mcap"] {
        let (once, twice) = (format!("once/logs/{file}"), format!("run/logs/{file}"));
        assert!(log(&once) == log(&twice), "{file} differs");
    }
    let again = log("run/logs/study2-again/S2P03-own-again.mcap");
    assert!(again != log("run/logs/study2/S2P03-own.mcap"), "another day");

    for drives in ["study1", "study2", "study1-again", "study2-again"] {
        let (from, to) = (format!("run/logs/{drives}"), format!("run/drives/{drives}"));
        study.maveric(&["ingest", &from, "--out", &to]).ok();
    }
    let score = "score --surveys run/surveys.csv --out run/scores.csv";
    study.maveric(&argv(score)).ok();
    let train = "train --drives run/drives/study1 --again run/drives/study1-again \
                 --scores run/scores.csv --out model.maveric --epochs 2";
    study.maveric(&argv(train)).ok();
    let other_seed = train.replace("model.maveric", "again.maveric") + " --seed 2";
    study.maveric(&argv(&other_seed)).ok();
    let validate = |models: &str| {
        let line = format!("validate run {models} --duration 120 --format json");
        let ran = study.maveric(&argv(&line)).ok();
        serde_json::from_str::<serde_json::Value>(&ran.stdout).unwrap()
    };
    let found = validate("--model model.maveric --model again.maveric --out found");
    assert_eq!(found["drivers"], 3);
    // Linear heads are the same at every training seed: two files, one model.
    assert_eq!(found["models"].as_array().unwrap().len(), 1);
    let model = &found["models"][0];
    assert_eq!(model["same"], serde_json::json!(["again.maveric"]));
    let page = study.read("found/index.html");
    assert!(page.contains("1 trained model in 2 files"));
    assert!(page.contains("again.maveric holds the same model as model.maveric"));
    assert!(!page.contains("in brackets"));
    // Three people who drove twice give no covariance of seven measures: one distance less for those.
    assert!(model["identity"].as_array().unwrap().len() >= 8);
    assert_eq!(model["fidelity"].as_array().unwrap().len(), 7);
    assert_eq!(found["retest"].as_array().unwrap().len(), 7);
    let errors = &model["errors"];
    assert_eq!((&errors["people"], &errors["coordinates"]), (&3.into(), &9.into()));
    let within = |k: &str| errors[k]["estimate"].as_f64().unwrap();
    assert!(within("within_1") <= within("within_2"), "{errors}");
    let days = model["days_of"].as_u64().unwrap();
    assert!((3..=30).contains(&days), "{days}");
    assert_eq!(model["dial"].as_array().unwrap().len(), 5);
    assert!(model["perpendicular_moves_s"].as_f64().unwrap() < 1e-5);
    assert_eq!(model["drives"], 3 * (8 + 5));
    assert_eq!(model["collisions"], 0);
    // A model of a score from 1 to 6 is read on the ADB's scale, on which these people answered.
    let learned = model_file::from_bytes(&log("model.maveric")).unwrap();
    let on_six = learned.on_range(ScoreRange::new(1.0, 6.0).unwrap());
    study.write("on_six.maveric", model_file::to_bytes(&on_six).unwrap());
    let on_adb = validate("--model on_six.maveric --out six");
    let on_adb = &on_adb["models"][0];
    assert_eq!(on_adb["drives"], model["drives"]);
    assert!(on_adb["perpendicular_moves_s"].as_f64().unwrap() < 1e-5);
    let page = study.read("found/validation.md");
    assert!(page.contains("Identity") && !page.contains("NaN"));
    for table in [
        "retest",
        "identity",
        "errors",
        "fidelity",
        "likeness",
        "likeness-by-column",
        "dial",
        "perpendicular",
        "line",
    ] {
        assert!(study.path(&format!("found/tables/validation-{table}.csv")).exists());
    }
    let ablate = "ablate --drives run/drives/study1 --out parts";
    let short = format!("{ablate} --sizes 1 --windows 2 --folds 2 --epochs 1");
    let ran = study.maveric(&argv(&short)).ok();
    for variant in ["size 3", "size 1", "window 2 s", "without w", "linear with w", "own means"] {
        assert!(ran.stdout.contains(variant), "{}", ran.stdout);
    }
    let page = study.read("parts/index.html");
    assert!(page.contains("Synthetic participants") && !page.contains("NaN"));
    assert!(study.path("parts/ablation.json").exists());
    study.maveric(&argv(&format!("{ablate} --folds 40"))).failed(1, &["40"]);
    study.maveric(&argv("validate once --model model.maveric --out none")).failed(1, &["once"]);
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_one_thread_and_on_two() {
    let study = TempStudy::new();
    for (out, jobs) in [("one", "1"), ("two", "2")] {
        let run = |line: &str| study.maveric(&argv(&format!("{line} -j {jobs}"))).ok();
        let generate = "generate --study1 2 --study2 1 --duration 60 --seed 7";
        run(&format!("{generate} --out {out}"));
        let drives = format!("{out}/drives");
        run(&format!("ingest {out}/logs/study1 --out {drives}"));
        run(&format!("train --drives {drives} --out {out}/model.maveric --epochs 2"));
    }
    // Fewer people into the same folder: nobody who is no longer listed stays.
    let three = |people: &str| {
        let line = format!("generate --out three --study1 {people} --study2 1");
        study.maveric(&argv(&format!("{line} --duration 60 --seed 7"))).ok();
    };
    three("2");
    assert!(study.path("three/logs/study1/S1P02-own.mcap").exists());
    study.write("three/logs/study1/mine.mcap", "mine");
    three("1");
    assert!(!study.path("three/logs/study1/S1P02-own.mcap").exists());
    assert!(study.path("three/logs/study1/S1P01-own.mcap").exists());
    assert!(study.path("three/logs/study1/mine.mcap").exists());
    let files = ["participants.csv", "surveys.csv", "model.maveric"];
    let logs = std::fs::read_dir(study.path("one/logs/study1")).unwrap();
    let logs = logs.map(|f| format!("logs/study1/{}", f.unwrap().file_name().to_string_lossy()));
    let mut compared = 0;
    for file in files.map(str::to_owned).into_iter().chain(logs) {
        let read = |out: &str| std::fs::read(study.path(out).join(&file)).unwrap();
        assert!(read("one") == read("two"), "{file} differs");
        compared += 1;
    }
    assert!(compared >= 5);
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_ends_with_130_and_goes_on_where_it_stopped() {
    let study = TempStudy::new();
    // Many epochs: the run must not be over before it is interrupted.
    let paper = ["run", SMOKE, "--set", "heads=paper"];
    let mut command = study.command(&[&paper[..], &["--set", "epochs=2000"]].concat());
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let first = study.path("study_data/generated/smoke/scores.csv");
    for _ in 0..3000 {
        if first.exists() {
            break;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(first.exists());
    let killed = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    let ended = child.wait().unwrap();
    assert_eq!(ended.code(), Some(130));
    let next = study.maveric(&[&paper[..], &["--format", "json"]].concat()).ok();
    let generate = states(&next.stdout).into_iter().find(|(stage, _)| stage == "generate").unwrap();
    assert_eq!(generate.1, "up_to_date");
    let page = study.path("reports/smoke/index.html");
    is_page(&page);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("The paper’s five networks"));
    assert!(study.path("reports/smoke/figures").is_dir());
    let figures = std::fs::read_dir(study.path("reports/smoke/figures")).unwrap();
    let names = figures.map(|f| f.unwrap().file_name().to_string_lossy().into_owned());
    assert!(names.into_iter().any(|name| name.starts_with("architecture")));
}

#[test]
fn other_settings_in_the_same_place_and_elsewhere_leave_nothing_behind() {
    let study = TempStudy::new();
    let run = |more: &[&str]| {
        let short = argv("-j 2 --set epochs=2 --set duration=60");
        study.maveric(&[&["run", SMOKE], &short[..], more].concat()).ok()
    };
    let numbers = || std::fs::read(study.path("study_data/generated/smoke/analysis.json")).unwrap();
    let files = || {
        let drives = std::fs::read_dir(study.path("study_data/generated/smoke/drives/study2"));
        let names = drives.unwrap().map(|f| f.unwrap().file_name().into_string().unwrap());
        names.collect::<std::collections::BTreeSet<_>>()
    };
    run(&[]);
    let (first, drives) = (numbers(), files());
    let replaced = run(&["--set", "study2=4"]);
    let said = "the former results (study2=3, now 4) were replaced; `--variant NAME` keeps both";
    assert_eq!(replaced.stderr.matches(said).count(), 1, "{}", replaced.stderr);
    assert!(numbers() != first && files().len() > drives.len());
    run(&argv("--set seed=2 --set out=study_data/generated/two --set report=reports/two"));
    run(&[]);
    assert!(numbers() == first, "the first numbers again");
    assert_eq!(files(), drives);
    let verified = study.maveric(&["verify", SMOKE, "--set", "epochs=2", "--set", "duration=60"]);
    assert!(verified.ok().stdout.contains("0 not as recorded"));

    // A leftover drive is neither measured nor deleted.
    let leftover = "study_data/generated/smoke/drives/study2/S2P04-own.parquet";
    study.write(leftover, "a drive");
    let short = ["run", SMOKE, "--set", "epochs=2", "--set", "duration=60"];
    study.maveric(&short).failed(1, &["S2P04-own.parquet", "made by no run", "--move-aside"]);
    assert!(study.path(leftover).exists());
    run(&["--move-aside"]);
    assert!(numbers() == first && files() == drives);
}
