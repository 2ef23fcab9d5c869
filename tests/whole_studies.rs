//! Studies that are not the paper's, walked from logs and answers to the page: it says what was done, and nothing that was not.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod support;

use serde_json::Value;
use std::fmt::Write as _;
use support::{
    TempStudy,
    own_logs::{change, measured, read, recorded, recorded_of, table},
    page::Page,
};

/// What only the paper's study has.
const THE_PAPERS: [&str; 9] = [
    "mimic",
    "cautious",
    "perpendicular",
    "ADB",
    "study 1",
    "study 2",
    "four conditions",
    "as the paper",
    "beside the claims",
];
/// What only a learned car has.
const LEARNED: [&str; 7] = [
    "learned",
    "embedding",
    "network",
    "dial",
    "aggress",
    "the style",
    "synthetic",
];

fn page(study: &TempStudy, folder: &str) -> Page {
    Page::read(&study.path(&format!("{folder}/report/index.html")))
}

fn analysis(study: &TempStudy, folder: &str) -> Value {
    serde_json::from_str(&read(study, &format!("{folder}/results/analysis.json"))).unwrap()
}

fn panel<'a>(analysis: &'a Value, outcome: &str) -> &'a Value {
    let panels = analysis["panels"].as_array().unwrap();
    panels.iter().find(|p| p["outcome"] == outcome).unwrap()
}

#[test]
fn three_recorded_cars_two_questionnaires_and_no_style() {
    let study = recorded(&["calm", "normal", "sporty"]);
    let ran = study.maveric_in("mine", &["run"]).ok();
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
    assert!(!ratings.contains(",pre,"));
    let found = analysis(&study, "mine");
    let velocity = panel(&found, "mean_velocity_mps");
    assert_eq!(
        (&velocity["n"], &velocity["test"]),
        (&4.into(), &"t".into())
    );
    assert_eq!(velocity["contrasts"].as_array().unwrap().len(), 3);
    page(&study, "mine")
        .says(&[
            "4 participants in three conditions: Calm, Normal and Sporty",
            "drove by hand (Own), took part in the recorded conditions (Calm, Normal and Sporty) and answered questionnaires",
            "Flow of participants",
            "Mean velocity over the conditions: F(",
            "Number of lane changes over the conditions: no test statistic: neither test has a value",
            "comfort over the conditions",
            "Measures are differences from the drive Own",
            "Calm is the study’s own car, of which the recordings are read",
            "No drive has a value of these measures, so they are not tested: distance headway merge back",
            "1 minute a drive by hand",
            "Nothing was left out",
            "To repeat maveric run Times",
        ])
        .is_silent_of(&THE_PAPERS)
        .is_silent_of(&LEARNED);
    let again = study.maveric_in("mine", &["run"]).ok();
    assert!(again.stdout.contains("nothing was run"), "{}", again.stdout);
    // A condition in which nobody drove or said anything is no study of that condition.
    let more = "[[condition]]\nid = \"wild\"\n\n[baseline]";
    change(&study, "mine/study.toml", "[baseline]", more);
    let refused = study.maveric_in("mine", &["run"]);
    assert_eq!(refused.status, Some(1));
    assert!(
        refused
            .stderr
            .contains("nobody drove or rated the condition `wild`")
            && refused.stderr.contains("maveric status"),
        "{}",
        refused.stderr
    );
}

#[test]
fn whom_a_rule_leaves_out_is_out_of_drives_answers_tests_tables_and_counts() {
    let people = ["P01", "P02", "P03", "P04", "P05", "P06", "P07", "P08"];
    let conditions = ["calm", "normal", "sporty"];
    let study = recorded_of(&people, &conditions);
    // P05 gives one answer to items of both kinds; P06 sat through one condition alone; P04's last drive broke off.
    let ease = "id = \"ease\"\ntitle = \"Ease\"\nreference = \"ours\"\nitems = 6\nmin = 1\nmax = 5\nscoring = \"mean\"\nreversed = [2, 4]\n\
                [[subscales]]\nid = \"total\"\ntitle = \"Ease\"\nitems = [1, 2, 3, 4, 5, 6]\n";
    study.write("mine/scales/ease.toml", ease);
    let mut answers = read(&study, "mine/surveys/answers.csv");
    for who in people {
        for item in 1..=6 {
            let answer = if who == "P05" { 5 } else { 1 + item % 5 };
            writeln!(answers, "{who},pre,ease,{item},{answer}").unwrap();
        }
    }
    answers.push_str("P09,calm,comfort,1,3\nP01,wild,comfort,1,3\n");
    let of_p06 =
        |line: &&str| !(line.starts_with("P06,normal,") || line.starts_with("P06,sporty,"));
    let answers: Vec<&str> = answers.lines().filter(of_p06).collect();
    study.write("mine/surveys/answers.csv", answers.join("\n"));
    for condition in ["normal", "sporty"] {
        std::fs::remove_file(study.path(&format!("mine/logs/P06-{condition}.csv"))).unwrap();
    }
    let broken_off: Vec<String> = read(&study, "mine/logs/P04-sporty.csv")
        .lines()
        .take(400)
        .map(str::to_owned)
        .collect();
    study.write("mine/logs/P04-sporty.csv", broken_off.join("\n"));
    study.write("mine/logs/P09-calm.csv", table(100.0, 30.0, "calm"));
    study.write("mine/logs/P01-wild.csv", table(100.0, 30.0, "wild"));
    let listed = read(&study, "mine/participants.csv");
    study.write("mine/participants.csv", format!("{listed}P10,,30,,\n"));
    let rules = "[exclude]\npeople = { P02 = \"withdrew consent\" }\ndrives = { P03-calm = \"simulator sickness\" }\n\
                 drive_shorter_than_s = 50\nstraight_lined = true\nfewer_conditions_than = 2\n";
    change(&study, "mine/study.toml", "[exclude]", rules);
    study.maveric_in("mine", &["run"]).ok();
    let rows = measured(&study);
    let of = |who: &str| rows.iter().filter(|(p, _)| p == who).count();
    assert_eq!(
        (of("P01"), of("P02"), of("P03"), of("P04"), of("P09")),
        (4, 0, 3, 3, 0)
    );
    let listed = read(&study, "mine/results/drives/exclusions.csv");
    for said in [
        "left out by exclude.people: withdrew consent",
        "left out by exclude.drives: simulator sickness",
        "left out by exclude.drive_shorter_than_s: the drive is 20 s long, expected at least 50 s",
        "left out by unknown participant: P09 is not in the table of people",
        "`wild` is none of the design's: own, calm, normal, sporty",
    ] {
        assert!(listed.contains(said), "no `{said}` in {listed}");
    }
    let ratings = read(&study, "mine/results/rating_scores.csv");
    for gone in ["P02,", "P03,calm,", "P04,sporty,", "P09,", ",wild,"] {
        assert!(!ratings.contains(gone), "{gone}: {ratings}");
    }
    let scores = read(&study, "mine/results/scores.csv");
    assert!(!scores.contains("P02,") && !scores.contains("P05,") && scores.contains("P06,"));
    let found = analysis(&study, "mine");
    let flow = &found["flow"];
    assert_eq!(
        (&flow["recruited"], &flow["drove"], &flow["analysed"]),
        (&9.into(), &8.into(), &5.into())
    );
    let by_reason: Vec<(&str, usize)> = flow["left_out"]
        .as_array()
        .unwrap()
        .iter()
        .map(|l| {
            (
                l["why"].as_str().unwrap(),
                l["who"].as_array().unwrap().len(),
            )
        })
        .collect();
    for (why, n) in [
        ("withdrew consent", 1),
        ("one answer to every item of `ease`, reversed ones too", 1),
        ("fewer than 2 conditions", 1),
        ("no drive and no answer in any condition", 1),
    ] {
        assert!(by_reason.contains(&(why, n)), "{why}: {by_reason:?}");
    }
    assert_eq!(flow["drives"].as_array().unwrap().len(), 2);
    for outcome in ["mean_velocity_mps", "comfort.total"] {
        let panel = panel(&found, outcome);
        let asked: Vec<&str> = panel["participants"]
            .as_array()
            .unwrap()
            .iter()
            .map(|p| p.as_str().unwrap())
            .collect();
        assert_eq!(asked, ["P01", "P03", "P04", "P07", "P08"]);
        // P03 and P04 each lack one condition.
        assert_eq!(panel["n"], 3, "{outcome}");
    }
    page(&study, "mine").says(&[
        "5 participants in three conditions",
        "Of 9 who were recruited, 4 were left out: 1 (withdrew consent)",
        "Tested 5 18 ",
        "drive shorter than 50 s",
        "simulator sickness",
    ]);
    let ran = study.maveric_in("mine", &["ingest", "--out", "again"]).ok();
    for said in [
        "4 drives left out by exclude.people",
        "1 drive left out by exclude.drives",
        "1 drive left out by exclude.drive_shorter_than_s",
        "1 drive left out by unknown condition",
    ] {
        assert!(ran.stdout.contains(said), "no `{said}` in {}", ran.stdout);
    }
    // What nobody made here is named, and left alone.
    std::fs::copy(
        study.path("mine/again/P01-own.parquet"),
        study.path("mine/again/P01-again.parquet"),
    )
    .unwrap();
    let foreign = ["P01-again.parquet", "does not list"];
    let measure = ["measure", "--drives", "again", "--out", "m.csv"];
    study.maveric_in("mine", &measure).failed(1, &foreign);
    let ingest = ["ingest", "--out", "again"];
    study.maveric_in("mine", &ingest).failed(1, &foreign);
    assert!(study.path("mine/again/P01-again.parquet").exists());
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
    let people = ["P01,town", "P02,town", "P03,lab", "P04,lab"].join(",30,,\n");
    study.write(
        "mine/participants.csv",
        format!("participant,population,age,gender,order\n{people},30,,\n"),
    );
    study.maveric_in("mine", &["run"]).ok();
    assert_eq!(measured(&study).len(), 8);
    let listed = read(&study, "mine/results/drives/exclusions.csv");
    assert!(
        listed.contains("`own` is none of the design's: calm, sporty"),
        "{listed}"
    );
    page(&study, "mine")
        .says(&[
            "4 participants in two conditions: Calm and Sporty",
            "Measures and answers are shown as they are",
            "Tested, town 2 4 ",
            "Tested, lab 2 4 ",
            "1 minute a drive.",
        ])
        .is_silent_of(&THE_PAPERS)
        .is_silent_of(&LEARNED)
        .is_silent_of(&["by hand", "baseline", "differences from"]);
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

/// Makes up people for a study's folder, with drives of two minutes, in which everybody shows a habit.
fn generate(study: &TempStudy, folder: &str, learn: &str, test: &str) {
    let design = format!("{folder}/study.toml");
    let words = ["generate", "--design", &design, "--duration", "120"];
    let sizes = ["--learn", learn, "--test", test];
    study.maveric(&[&words[..], &sizes].concat()).ok();
}

/// Two outcomes are drawn, which is quicker than all.
const TWO_OUTCOMES: &str = "[[outcome]]\nmeasure = \"mean_velocity_mps\"\n[[outcome]]\nscale = \"jian_trust.overall\"\nlabel = \"Trust\"\n\n[contrasts]";
const SHORT: [&str; 5] = ["run", "--set", "epochs=2", "--set", "duration=120"];

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
    let people = read(&study, "mine/participants.csv");
    assert!(
        people.contains("S1P01,learn,") && people.contains("S2P03,test,"),
        "{people}"
    );
    study.maveric_in("mine", &SHORT).ok();
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
    let by_hand = [
        "report",
        "results",
        "--participants",
        "participants.csv",
        "--out",
        "again",
    ];
    study.maveric_in("mine", &by_hand).ok();
    Page::read(&study.path("mine/again/index.html"))
        .says(&["To repeat maveric report results --participants participants.csv --out again"]);
    // Real people are never replaced.
    study.write("mine/participants.csv", "participant,part\nP01,test\n");
    let generate = [
        "generate",
        "--design",
        "mine/study.toml",
        "--learn",
        "4",
        "--test",
        "3",
    ];
    study.maveric(&generate).failed(
        1,
        &[
            "mine/participants.csv",
            "holds 1 person who was not made up",
        ],
    );
}

#[test]
fn five_conditions_on_a_dial_of_11_to_66_points_with_roles_and_then_a_model_from_elsewhere() {
    let study = TempStudy::new();
    synthetic(
        &study,
        "mine",
        "calmer,calm,own_style,brisk,brisker",
        "adb.total",
    );
    let by_hand = "[[role]]\nid = \"brisk\"\n\n[[role]]\nid = \"calm\"\n\n[baseline]";
    change(&study, "mine/study.toml", "[baseline]", by_hand);
    change(&study, "mine/study.toml", "id = \"own\"", "id = \"hand\"");
    // Items from 1 to 6: a score of 11 to 66.
    change(&study, "mine/scales/adb.toml", "max = 5", "max = 6");
    change(
        &study,
        "mine/study.toml",
        "range = [11, 55]",
        "range = [11, 66]",
    );
    generate(&study, "mine", "6", "3");
    // One of the six is a professional and demonstrates both roles.
    let logs = std::fs::read_dir(study.path("mine/logs/study1")).unwrap();
    assert_eq!(logs.count(), 6 + 2);
    study.maveric_in("mine", &SHORT).ok();
    let conditions = read(&study, "mine/results/conditions.csv");
    assert_eq!(conditions.lines().count(), 1 + 3 * 5);
    let embeddings = read(&study, "mine/results/embeddings.csv");
    assert!(
        embeddings.contains("S2P01-hand,S2P01,hand,true,"),
        "{embeddings}"
    );
    let found = analysis(&study, "mine");
    let contrasts = panel(&found, "mean_velocity_mps")["contrasts"].as_array();
    assert_eq!(contrasts.unwrap().len(), 10);
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
    let ran = study
        .maveric_in("theirs", &["run", "--set", "duration=120"])
        .ok();
    assert!(!ran.stderr.contains("train:"), "{}", ran.stderr);
    let conditions = read(&study, "theirs/results/conditions.csv");
    assert_eq!(conditions.lines().count(), 1 + 3 * 2);
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

#[test]
fn the_average_driver_needs_no_style() {
    let study = TempStudy::new();
    synthetic(&study, "mine", "average,again", "adb.total");
    let text = read(&study, "mine/study.toml");
    let (head, rest) = text.split_once("[style]").unwrap();
    let rest = &rest[rest.find("[[condition]]").unwrap()..];
    let mut cars = rest.to_owned();
    for dial in ["{ dial = \"-0.5\" }", "{ dial = \"+0.5\" }"] {
        assert!(cars.contains(dial), "{cars}");
        cars = cars.replacen(dial, "{ mean = true }", 1);
    }
    study.write("mine/study.toml", format!("{head}{cars}"));
    generate(&study, "mine", "3", "3");
    study.maveric_in("mine", &SHORT).ok();
    let conditions = read(&study, "mine/results/conditions.csv");
    let line = conditions.lines().nth(1).unwrap();
    assert!(line.starts_with("S2P01,average,,,"), "{conditions}");
    page(&study, "mine")
        .says(&[
            "3 participants in two conditions: Average and Again",
            "Average is the average driver",
        ])
        .is_silent_of(&[
            "the style",
            "points of",
            "on the line",
            "gradient of",
            "mimic",
        ]);
}

/// The logarithm of the odds ratio for 1 m/s² of braking before a press, with its standard error; whether any cause has p < .05 after Holm.
fn braking_before_a_press(study: &TempStudy) -> ([f64; 2], bool) {
    let text = std::fs::read_to_string(study.path("mine/results/analysis.json")).unwrap();
    let analysis: Value = serde_json::from_str(&text).unwrap();
    let rows = analysis["presses"]["before"].as_array().unwrap();
    let braking = rows.iter().find(|row| row["precursor"] == "braking_mps2");
    let test = &braking.unwrap()["test"];
    let per_unit = |key: &str| test[key].as_f64().unwrap() / test["sd"].as_f64().unwrap();
    let any = rows
        .iter()
        .any(|row| row["p_holm"].as_f64().is_some_and(|p| p < 0.05));
    ([per_unit("estimate"), per_unit("se_model")], any)
}

#[test]
fn the_cause_of_made_up_presses_is_found_at_its_size_and_none_where_there_is_none() {
    let study = TempStudy::new();
    let init = ["init", "mine", "--conditions", "calm,sporty", "--synthetic"];
    study.maveric(&init).ok();
    let presses = |per_minute: f64, braking: f64| {
        let effects = include_str!("../study_data/effects.toml");
        let presses = format!(
            "[presses]\nper_minute = {per_minute}\nperson_sd = 0.4\ncauses = {{ braking_mps2 = {braking} }}\n"
        );
        study.write("mine/effects.toml", format!("{effects}\n{presses}"));
    };
    presses(0.3, 0.7);
    let generate = "generate --design mine/study.toml --duration 120 --learn 4 --test 12";
    study.maveric(&generate.split(' ').collect::<Vec<_>>()).ok();
    let run = ["run", "--set", "epochs=2", "--set", "duration=300", "stats"];
    study.maveric_in("mine", &run).ok();
    let ([estimate, se], any) = braking_before_a_press(&study);
    assert!(
        any && (estimate - 0.7).abs() < 3.0 * se && se < 0.1,
        "{estimate} {se}"
    );
    presses(1.0, 0.0);
    study.maveric_in("mine", &run).ok();
    let ([estimate, se], any) = braking_before_a_press(&study);
    assert!(!any && estimate.abs() < 3.0 * se, "{estimate} {se}");
    // What was pressed in a seat is not made up.
    let table = study.path("mine/results/measurements_presses.csv");
    let pressed = std::fs::read_to_string(&table).unwrap();
    let events = "participant,step,page,moment,attempt,time_s,what,value,at\n";
    let events = study.write("mine/seat/events.csv", events);
    let rate = "rate --measures results/measurements.parquet --participants participants.csv --effects effects.toml --scales scales \
                --drives results/av/drives --out rated.csv --seed 7";
    let told = study.maveric_in("mine", &rate.split_whitespace().collect::<Vec<_>>());
    assert!(
        told.ok()
            .stderr
            .contains("seat/events.csv says what was pressed")
    );
    assert_eq!(std::fs::read_to_string(&table).unwrap(), pressed);
    std::fs::remove_file(events).unwrap();
    change(&study, "mine/effects.toml", "braking_mps2 =", "breaking =");
    let words = ["effects.toml", "presses.causes.breaking"];
    study.maveric_in("mine", &run).failed(1, &words);
}
