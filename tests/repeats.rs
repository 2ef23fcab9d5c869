//! Several sessions and several rides in a condition: from logs and from made-up people, each ride counted and judged alone, to the page
//! and what is given away.

use crate::support::{
    TempStudy, argv,
    own_logs::{PEOPLE, SCALES, TABLE, analysis, change, panel, recorded, speed, table},
    page::Page,
};
use maveric_study::tables::Table;
use serde_json::Value;
use std::{collections::BTreeSet, fmt::Write as _};

/// What stands in the `[protocol]` that `init` writes, and before what it says of sessions and rides.
const PROTOCOL: &str = "consent = \"consent.md\"";
const REPEATS: &str = "rides_per_condition = 2\nsessions = { count = 2, days_between = [2, 14] }\nconsent = \"consent.md\"";
const CONDITIONS: [&str; 2] = ["calm", "sporty"];

/// How much faster than in the design of one ride a person drives, in km/h.
fn faster(session: usize, trial: usize) -> f64 {
    [[-1.0, 1.0], [4.0, 6.0]][session - 1][trial - 1]
}

/// The recorded study with two sessions, the drive by hand in each, and two rides in each condition of a session: 1 km/h below and above
/// those of one ride, and 5 km/h more in the second session.
fn repeated() -> TempStudy {
    let study = recorded(&CONDITIONS);
    change(&study, "mine/study.toml", PROTOCOL, REPEATS);
    let names = "[names]\nfile = \"{who}-{condition}-s{session}-t{trial}\"\ndrive = \"{who}-{condition}-{session}-{trial}\"\n\
                 participant = \"{who}\"\ncondition = \"{condition}\"\n";
    study.write("mine/mapping.toml", format!("{names}{TABLE}"));
    std::fs::remove_dir_all(study.path("mine/logs")).unwrap();
    let mut answers = "participant,moment,session,trial,scale,item,answer\n".to_owned();
    for (i, who) in PEOPLE.iter().enumerate() {
        for (place, condition) in ["own"].iter().chain(&CONDITIONS).enumerate() {
            for session in 1..=2 {
                for trial in 1..=if place == 0 { 1 } else { 2 } {
                    let kmh = match place {
                        0 => speed(i, 0) + 5.0 * (session - 1) as f64,
                        _ => speed(i, place) + faster(session, trial),
                    };
                    study.write(
                        &format!("mine/logs/{who}-{condition}-s{session}-t{trial}.csv"),
                        table(kmh, 30.0, condition),
                    );
                    for (scale, items, _) in SCALES.iter().filter(|_| place > 0) {
                        for item in 1..=*items {
                            // 1 and 3 in the first session: 2 in the mean, and 5 in the second.
                            let answer = if session == 1 { 2 * trial - 1 } else { 5 };
                            let _ = writeln!(
                                answers,
                                "{who},{condition},{session},{trial},{scale},{item},{answer}"
                            );
                        }
                    }
                }
            }
        }
    }
    study.write("mine/surveys/answers.csv", answers);
    study
}

/// Mean difference of sporty and calm.
fn difference(analysis: &Value, outcome: &str) -> f64 {
    let panel = panel(analysis, outcome).unwrap();
    assert_eq!(panel["n"], PEOPLE.len(), "{panel}");
    let contrast = &panel["contrasts"][0];
    let sign = if contrast["first"] == "sporty" { 1.0 } else { -1.0 };
    sign * contrast["mean_difference"].as_f64().unwrap()
}

#[test]
fn rides_of_mapped_logs_are_averaged_within_the_first_session_and_each_is_left_out_alone() {
    let study = repeated();
    study.mine("run").ok();
    let drives = Table::read(&study.path("mine/results/drives/drives.csv")).unwrap();
    // A drive by hand and four rides a session.
    assert_eq!(drives.rows(), PEOPLE.len() * 2 * 5);
    assert_eq!(drives.numbers("session").unwrap()[0], Some(1.0));
    let measured = Table::read(&study.path("mine/results/measurements.parquet")).unwrap();
    let trials = measured.numbers("trial").unwrap().into_iter().flatten();
    assert_eq!(trials.filter(|t| *t > 1.5).count(), PEOPLE.len() * 4);
    let scores = study.read("mine/results/rating_scores.csv");
    assert!(
        scores.starts_with("participant,moment,session,trial,scale,subscale,value,")
            && scores.contains("P01,calm,1,2,comfort,total,3")
            && scores.contains("P01,calm,2,1,comfort,total,5"),
        "{scores}"
    );
    // By hand: the mean of what a person gains from the calm to the sporty car, (6 + 7 + 8 + 6) / 4 km/h; rides 1 km/h to both sides cancel.
    let whole = difference(&analysis(&study), "mean_velocity_mps");
    assert!((whole - 27.0 / 4.0).abs() < 1e-6, "{whole}");
    let calm = analysis(&study)["descriptives"]
        .as_array()
        .unwrap()
        .iter()
        .find(|row| row["outcome"] == "comfort.total" && row["condition"] == "calm")
        .unwrap()["mean"]
        .as_f64();
    assert_eq!(calm, Some(2.0));
    // One of P01's two calm rides is left out by name: the other, 1 km/h faster than the mean, stays, and so does P01.
    change(
        &study,
        "mine/study.toml",
        "\n[protocol]",
        "drives = { \"P01-calm\" = \"the camera failed\" }\n\n[protocol]",
    );
    study.mine("run").ok();
    let without = difference(&analysis(&study), "mean_velocity_mps");
    assert!((without - (27.0 - 1.0) / 4.0).abs() < 1e-6, "{without}");
    let scores = study.read("mine/results/rating_scores.csv");
    assert!(!scores.contains("P01,calm,1,1,") && scores.contains("P01,calm,1,2,"), "{scores}");
}

#[test]
fn what_is_given_away_says_of_which_session_and_ride_an_answer_is() {
    let study = repeated();
    study.write("mine/key.txt", "a secret of more than sixteen letters");
    study.mine("export --out given --key key.txt").ok();
    let answers = study.read("mine/given/surveys.csv");
    assert!(
        answers.starts_with("participant,moment,session,trial,")
            && answers.contains(",calm,2,2,comfort,"),
        "{answers}"
    );
    let given = std::fs::read_dir(study.path("mine/given/logs")).unwrap();
    let given = given.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(given.filter(|name| name.ends_with("calm_s2_t2.mcap")).count(), PEOPLE.len());
}

#[test]
fn a_ride_too_many_is_left_out_by_name_and_a_number_that_is_none_is_refused_with_its_file() {
    let study = repeated();
    study.write("mine/logs/P01-calm-s1-t3.csv", table(100.0, 30.0, "calm"));
    let ran = study.mine("run ingest").ok();
    let told = study.read("mine/results/drives/exclusions.csv");
    assert!(
        told.contains("session 1, trial 3 of `calm`, expected sessions up to 2 and trials up to 2")
            && told.contains("protocol.rides_per_condition"),
        "{told}\n{}",
        ran.stderr
    );
    study.write("mine/logs/P01-calm-s0-t1.csv", table(100.0, 30.0, "calm"));
    study
        .mine("ingest logs/P01-calm-s0-t1.csv --out d")
        .failed(1, &["P01-calm-s0-t1.csv", "session `0`", "a whole number from 1"]);
}

#[test]
fn what_is_missing_is_named_with_its_session_and_trial() {
    let study = repeated();
    std::fs::remove_file(study.path("mine/logs/P02-calm-s2-t1.csv")).unwrap();
    let missing = ["status", "--missing", "missing.csv"];
    study.maveric_in("mine", &missing).ok();
    let text = study.read("mine/missing.csv");
    assert!(
        text.starts_with("participant,moment,session,trial,")
            && text.contains("P02,calm,2,1,no log"),
        "{text}"
    );
}

#[test]
fn made_up_people_come_twice_and_ride_twice_in_each_condition_each_time_in_another_world() {
    let study = TempStudy::new();
    let init = ["init", "mine", "--conditions", "calm,sporty", "--synthetic"];
    study.maveric(&init).ok();
    let outcomes = "[[outcome]]\nmeasure = \"mean_velocity_mps\"\n[[outcome]]\nscale = \"jian_trust.overall\"\nlabel = \"Trust\"\n\n";
    let declared = format!("{outcomes}[contrasts]");
    change(&study, "mine/study.toml", "[contrasts]", &declared);
    let probed = format!("{REPEATS}\nride_s = 120\nprobe = {{ scale = \"misc\", every_s = 30 }}");
    change(&study, "mine/study.toml", PROTOCOL, &probed);
    let misc = include_str!("../study_data/further_scales/misc.toml");
    study.write("mine/scales/misc.toml", misc);
    let generate = "generate --design mine/study.toml --duration 120 --learn 4 --test 3";
    study.maveric(&argv(generate)).ok();
    let logs: BTreeSet<String> = std::fs::read_dir(study.path("mine/logs/study2"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(logs.len(), 3 * 2, "{logs:?}");
    assert!(logs.contains("S2P01-own.mcap") && logs.contains("S2P01-own_s2_t1.mcap"), "{logs:?}");
    let run = "run --set epochs=2 --set duration=120";
    study.mine(run).ok();
    // A style a person and condition, of the first session's drive; four rides in each.
    let conditions = study.read("mine/results/conditions.csv");
    assert_eq!(conditions.lines().count(), 1 + 3 * 2);
    let rides = Table::read(&study.path("mine/results/av/drives/drives.csv")).unwrap();
    assert_eq!(rides.rows(), 3 * 2 * 4);
    let measured = Table::read(&study.path("mine/results/measurements.parquet")).unwrap();
    let speeds = measured.numbers("mean_velocity_mps").unwrap();
    let speeds: BTreeSet<u64> = speeds.into_iter().flatten().map(f64::to_bits).collect();
    assert_eq!(speeds.len(), measured.rows(), "no two drives are the same");
    let ratings = study.read("mine/results/ratings.csv");
    assert!(
        ratings.starts_with("participant,moment,session,trial,scale,item,answer,condition,at_s\n")
            && ratings.contains("S2P01,after,2,2,jian_trust,"),
        "{ratings}"
    );
    // During each ride of two minutes three questions are asked whose answers can come in time.
    let asked: Vec<&str> = ratings.lines().filter(|row| row.contains(",probe,")).collect();
    assert_eq!(asked.len(), 3 * 2 * 4 * 3);
    let at: BTreeSet<&str> = asked.iter().map(|row| row.rsplit(',').next().unwrap()).collect();
    assert_eq!(at, BTreeSet::from(["30.0", "60.0", "90.0"]));
    Page::read(&study.path("mine/report/index.html")).says(&["Trust", "Calm and Sporty"]);
    let manuscript = |file: &str| study.read(&format!("mine/report/manuscript/{file}"));
    let (methods, results) = (manuscript("methods.md"), manuscript("results.md"));
    assert!(methods.contains("Everybody rides 2 times"), "{methods}");
    assert!(
        results.contains("## The second session") && results.contains("*ICC*(2,1) = "),
        "{results}"
    );
    // What is given away says the same, under pseudonyms.
    study.write("mine/key.txt", "a secret of more than sixteen letters");
    study.mine("export --out given --key key.txt").ok();
    let given = std::fs::read_dir(study.path("mine/given/logs")).unwrap();
    let given = given.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert!(given.into_iter().any(|name| name.ends_with("_s2_t1.mcap")));
}
