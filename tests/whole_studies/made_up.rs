//! Cars that a model steers, with people who were made up.

use super::*;
use maveric_domain::Embedding;
use maveric_model::{model_file, style_space::LinearHead};
use std::collections::BTreeMap;

/// Makes up people for a study's folder, with drives of two minutes, in which everybody shows a habit.
fn generate(study: &TempStudy, folder: &str, learn: &str, test: &str) {
    let design = format!("{folder}/study.toml");
    let line = format!("generate --design {design} --duration 120 --learn {learn} --test {test}");
    study.maveric(&argv(&line)).ok();
}

/// Two outcomes are drawn, which is quicker than all.
const TWO_OUTCOMES: &str = "[[outcome]]\nmeasure = \"mean_velocity_mps\"\n[[outcome]]\nscale = \"jian_trust.overall\"\nlabel = \"Trust\"\n\n[contrasts]";
const SHORT: &str = "run --set epochs=2 --set duration=120";

fn synthetic(study: &TempStudy, folder: &str, conditions: &str, style: &str) {
    let init = ["init", folder, "--conditions", conditions, "--style", style];
    study.maveric(&[&init[..], &["--synthetic"]].concat()).ok();
    let design = format!("{folder}/study.toml");
    change(study, &design, "[contrasts]", TWO_OUTCOMES);
}

#[test]
fn a_dial_of_another_score_rehearsed_with_made_up_people() {
    let study = TempStudy::new();
    synthetic(&study, "mine", "calm,sporty", "mdsi.risky");
    generate(&study, "mine", "4", "3");
    let people = study.read("mine/participants.csv");
    tells(&people, &["S1P01,learn,", "S2P03,test,"]);
    study.mine(SHORT).ok();
    let conditions = study.read("mine/results/conditions.csv");
    assert_eq!(conditions.lines().count(), 1 + 3 * 2);
    // Half a step of 1.7 points either way, on a score from 1 to 6.
    let header: Vec<&str> = conditions.lines().next().unwrap().split(',').collect();
    let at = |name: &str| header.iter().position(|c| *c == name).unwrap();
    for line in conditions.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |name: &str| cells[at(name)].parse::<f64>().unwrap();
        assert!((1.0..=6.0).contains(&number("adb_hat")), "{line}");
        assert!(number("moved_points").abs() < 0.86, "{line}");
        assert!((number("moved_points") > 0.0) == (cells[at("condition")] == "sporty"), "{line}");
    }
    assert!(study.read("mine/results/ratings.csv").contains(",sporty,jian_trust,"));
    page(&study, "mine")
        .says(&[
            "Synthetic participants: 4 drives to learn from, 3 participants in two conditions: Calm and Sporty",
            "Position on the line of the risky score",
            "Calm lies 0.85 points of the risky score down from the embedding fitted to the person, held within 1 to 6",
            "Learned from 4 4 ",
            "Mean velocity over the conditions",
            "Trust condition: F",
            "To repeat maveric run --set epochs=2 --set duration=120 Times",
        ])
        .is_silent_of(&["mimic", "cautious", "perpendicular", "ADB score", "study 1", "aggression line", "as the paper"]);
    // By hand, the page says the call by hand.
    let by_hand = "report results --participants participants.csv --out again";
    study.mine(by_hand).ok();
    Page::read(&study.path("mine/again/index.html"))
        .says(&["To repeat maveric report results --participants participants.csv --out again"]);
    // What is given away has what they said, and is analysed anew with that and as long drives.
    study.write("key", "a secret of this test alone");
    study.mine("export --key ../key --out ../shared --pipeline").ok();
    tells(&study.read("shared/surveys.csv"), &[",sporty,jian_trust,"]);
    tells(
        &study.read("shared/README.md"),
        &["`maveric run pipeline.toml` in this folder", "after a condition"],
    );
    let pipeline = study.read("shared/pipeline.toml");
    tells(&pipeline, &["duration = 120", "answers = \"surveys.csv\""]);
    assert!(!pipeline.contains("\"rate\""), "{pipeline}");
    study.maveric_in("shared", &["run", "pipeline.toml"]).ok();
    let trust = |folder: &str| {
        let analysis = study.json(&format!("{folder}/results/analysis.json"));
        let rows = analysis["descriptives"].as_array().unwrap();
        let trust = rows.iter().filter(|d| d["outcome"] == "jian_trust.overall");
        let means: Vec<Option<f64>> = trust.map(|d| d["mean"].as_f64()).collect();
        means
    };
    let (first, again) = (trust("mine"), trust("shared"));
    assert!(!first.is_empty() && first.len() == again.len());
    for (a, b) in first.iter().zip(&again) {
        assert!((a.unwrap() - b.unwrap()).abs() < 1e-9, "{first:?} {again:?}");
    }
    // Real people are never replaced.
    study.write("mine/participants.csv", "participant,part\nP01,test\n");
    let generate = argv("generate --design mine/study.toml --learn 4 --test 3");
    study
        .maveric(&generate)
        .failed(1, &["mine/participants.csv", "holds 1 person who was not made up"]);
}

#[test]
fn five_conditions_on_a_dial_of_11_to_66_points_with_roles_and_then_a_model_from_elsewhere() {
    let study = TempStudy::new();
    synthetic(&study, "mine", "calmer,calm,own_style,brisk,brisker", "adb.total");
    let by_hand = "[[role]]\nid = \"brisk\"\n\n[[role]]\nid = \"calm\"\n\n[baseline]";
    change(&study, "mine/study.toml", "[baseline]", by_hand);
    change(&study, "mine/study.toml", "id = \"own\"", "id = \"hand\"");
    // Items from 1 to 6: a score of 11 to 66.
    change(&study, "mine/scales/adb.toml", "max = 5", "max = 6");
    change(&study, "mine/study.toml", "range = [11, 55]", "range = [11, 66]");
    generate(&study, "mine", "6", "3");
    // One of the six is a professional and demonstrates both roles.
    let logs = std::fs::read_dir(study.path("mine/logs/study1")).unwrap();
    assert_eq!(logs.count(), 6 + 2);
    study.mine(SHORT).ok();
    let conditions = study.read("mine/results/conditions.csv");
    assert_eq!(conditions.lines().count(), 1 + 3 * 5);
    let embeddings = study.read("mine/results/embeddings.csv");
    tells(&embeddings, &["S2P01-hand,S2P01,hand,true,"]);
    let found = analysis(&study);
    let velocity = panel(&found, "mean_velocity_mps").unwrap();
    assert_eq!(velocity["contrasts"].as_array().unwrap().len(), 10);
    page(&study, "mine")
        .says(&[
            "8 drives to learn from, 3 participants in five conditions: Calmer, Calm, Own style, Brisk and Brisker",
            "The model learned from 8 drives by hand",
            "Calmer lies 30 points of the aggressive driving score down from Own style, held within 11 to 66",
            "Accuracy of Own style",
            "Drives of S2P0",
            "Own style automated",
        ])
        .is_silent_of(&["mimic", "cautious", "perpendicular", "ADB score", "study 1", "ellipse", "as the paper"]);

    synthetic(&study, "theirs", "calm,brisk", "adb.total");
    let elsewhere = "[model]\nfile = \"../mine/results/model.maveric\"\n\n[people]";
    change(&study, "theirs/study.toml", "[people]", elsewhere);
    change(&study, "theirs/study.toml", "learn = {", "# learn = {");
    generate(&study, "theirs", "0", "3");
    let ran = study.maveric_in("theirs", &["run", "--set", "duration=120"]).ok();
    assert!(!ran.stderr.contains("train:"), "{}", ran.stderr);
    let conditions = study.read("theirs/results/conditions.csv");
    assert_eq!(conditions.lines().count(), 1 + 3 * 2);
    is_on_the_borrowers_scale(&study);
    page(&study, "theirs")
        .says(&[
            "Synthetic participants: 3 participants in two conditions: Calm and Brisk",
            "The model was learned elsewhere.",
            "The model was learned elsewhere, and the drives that it learned from are not here",
            "Personalising.",
            "Position on the line of the aggressive driving score",
            "mine/results/model.maveric",
        ])
        .is_silent_of(&[
            "drives to learn from",
            "training drives:",
            "Learned from 4",
            "mimic",
            "perpendicular",
            "brisker",
        ]);
}

/// The rows of a table, each cell by its column.
fn cells(table: &str) -> Vec<BTreeMap<&str, &str>> {
    let mut lines = table.lines().map(|line| line.split(','));
    let header: Vec<&str> = lines.next().unwrap().collect();
    lines.map(|line| header.iter().copied().zip(line).collect()).collect()
}

/// The lender's model reads 11 to 66 points, the borrower's study says 11 to 55: all that its stages say is in points of the latter.
fn is_on_the_borrowers_scale(study: &TempStudy) {
    let bytes = std::fs::read(study.path("mine/results/model.maveric")).unwrap();
    let lenders = LinearHead::aggression(&model_file::from_bytes(&bytes).unwrap()).unwrap();
    assert!(lenders.range()[1] > 65.0, "{:?}", lenders.range());
    let number = |row: &BTreeMap<&str, &str>, name: &str| row[name].parse::<f64>().unwrap();
    let lenders_points = |row: &BTreeMap<&str, &str>| {
        let numbers = (1..).map_while(|i| row.get(&*format!("w{i}"))?.parse::<f64>().ok());
        let style = Embedding::new(numbers.collect()).unwrap();
        lenders.read(&style).unwrap()
    };
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-6, "{found}");
    let on_55 = |points: f64| 11.0 + (points - 11.0) * 44.0 / 55.0;
    let embeddings = study.read("theirs/results/embeddings.csv");
    let fitted = cells(&embeddings);
    for row in fitted.iter().filter(|row| !row["adb_hat"].is_empty()) {
        near(number(row, "adb_hat"), on_55(lenders_points(row)));
    }
    let conditions = study.read("theirs/results/conditions.csv");
    let mut whole_steps = 0;
    for row in &cells(&conditions) {
        // The style that is steered from: the one that was fitted with the score, where there is one.
        let theirs = |r: &&BTreeMap<&str, &str>| r["participant"] == row["participant"];
        let own = fitted.iter().filter(theirs);
        let own = own.max_by_key(|r| r["adb_used"] == "true").unwrap();
        let points = lenders_points(row);
        near(number(row, "adb_hat"), on_55(points));
        let moved = points - lenders_points(own);
        near(number(row, "moved_points"), moved * 44.0 / 55.0);
        if row["clamped"] == "false" {
            // Half a step of 15 points, towards the side of the condition.
            let side = if row["condition"] == "brisk" { 1.0 } else { -1.0 };
            near(moved, side * 7.5 * 55.0 / 44.0);
            whole_steps += 1;
        }
    }
    assert!(whole_steps > 0, "{conditions}");
}

#[test]
fn the_average_driver_needs_no_style() {
    let study = TempStudy::new();
    synthetic(&study, "mine", "average,again", "adb.total");
    let text = study.read("mine/study.toml");
    let (head, rest) = text.split_once("[style]").unwrap();
    let rest = &rest[rest.find("[[condition]]").unwrap()..];
    let mut cars = rest.to_owned();
    for dial in ["{ dial = \"-0.5\" }", "{ dial = \"+0.5\" }"] {
        assert!(cars.contains(dial), "{cars}");
        cars = cars.replacen(dial, "{ mean = true }", 1);
    }
    study.write("mine/study.toml", format!("{head}{cars}"));
    generate(&study, "mine", "3", "3");
    study.mine(SHORT).ok();
    let conditions = study.read("mine/results/conditions.csv");
    let line = conditions.lines().nth(1).unwrap();
    assert!(line.starts_with("S2P01,average,,,"), "{conditions}");
    page(&study, "mine")
        .says(&[
            "3 participants in two conditions: Average and Again",
            "Average is the average driver",
        ])
        .is_silent_of(&["the style", "points of", "on the line", "gradient of", "mimic"]);
}

/// The logarithm of the odds ratio for 1 m/s² of braking before a press, with its standard error; whether any cause has p < .05 after Holm.
fn braking_before_a_press(study: &TempStudy) -> ([f64; 2], bool) {
    let analysis = analysis(study);
    let rows = analysis["presses"]["before"].as_array().unwrap();
    let braking = rows.iter().find(|row| row["precursor"] == "braking_mps2");
    let test = &braking.unwrap()["test"];
    let per_unit = |key: &str| test[key].as_f64().unwrap() / test["sd"].as_f64().unwrap();
    let any = rows.iter().any(|row| row["p_holm"].as_f64().is_some_and(|p| p < 0.05));
    ([per_unit("estimate"), per_unit("se_model")], any)
}

#[test]
fn the_cause_of_made_up_presses_is_found_at_its_size_and_none_where_there_is_none() {
    let study = TempStudy::new();
    let init = ["init", "mine", "--conditions", "calm,sporty", "--synthetic"];
    study.maveric(&init).ok();
    let presses = |per_minute: f64, braking: f64| {
        let effects = include_str!("../../study_data/effects.toml");
        let presses = format!(
            "[presses]\nper_minute = {per_minute}\nperson_sd = 0.4\ncauses = {{ braking_mps2 = {braking} }}\n"
        );
        study.write("mine/effects.toml", format!("{effects}\n{presses}"));
    };
    presses(0.3, 0.7);
    let generate = "generate --design mine/study.toml --duration 120 --learn 4 --test 12";
    study.maveric(&argv(generate)).ok();
    let run = "run --set epochs=2 --set duration=300 stats";
    study.mine(run).ok();
    let ([estimate, se], any) = braking_before_a_press(&study);
    assert!(any && (estimate - 0.7).abs() < 3.0 * se && se < 0.1, "{estimate} {se}");
    presses(1.0, 0.0);
    study.mine(run).ok();
    let ([estimate, se], any) = braking_before_a_press(&study);
    assert!(!any && estimate.abs() < 3.0 * se, "{estimate} {se}");
    // What was pressed in a seat is not made up.
    let table = study.path("mine/results/measurements_presses.csv");
    let pressed = std::fs::read_to_string(&table).unwrap();
    let events = "participant,step,page,moment,attempt,time_s,what,value,at\n";
    let events = study.write("mine/seat/events.csv", events);
    let rate = "rate --measures results/measurements.parquet --participants participants.csv --effects effects.toml --scales scales \
                --drives results/av/drives --out rated.csv --seed 7";
    let told = study.mine(rate);
    assert!(told.ok().stderr.contains("seat/events.csv says what was pressed"));
    assert_eq!(std::fs::read_to_string(&table).unwrap(), pressed);
    std::fs::remove_file(events).unwrap();
    change(&study, "mine/effects.toml", "braking_mps2 =", "breaking =");
    let words = ["effects.toml", "presses.causes.breaking"];
    study.mine(run).failed(1, &words);
}
