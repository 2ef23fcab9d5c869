//! Cars that were recorded.

use super::*;
use std::fmt::Write as _;

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
const LEARNED: [&str; 7] =
    ["learned", "embedding", "network", "dial", "aggress", "the style", "synthetic"];

#[test]
fn three_recorded_cars_two_questionnaires_and_no_style() {
    let study = recorded(&["calm", "normal", "sporty"]);
    let ran = study.mine("run").ok();
    assert!(!ran.stderr.contains("train"), "{}", ran.stderr);
    let rows = measured(&study);
    assert_eq!(rows.len(), 16);
    for condition in ["own", "calm", "normal", "sporty"] {
        assert_eq!(rows.iter().filter(|(_, c)| c == condition).count(), 4);
    }
    // 101 km/h are 28.06 m/s, wherever the table says them.
    let speeds = study.read("mine/m.csv");
    let line = speeds.lines().find(|l| l.starts_with("P01-calm")).unwrap();
    assert!(line.contains("28.0"), "{line}");
    let ratings = study.read("mine/results/rating_scores.csv");
    assert!(ratings.contains(",calm,comfort,total,") && ratings.contains(",sporty,hurry,total,"));
    assert!(!ratings.contains(",pre,"));
    let found = analysis(&study);
    let velocity = panel(&found, "mean_velocity_mps").unwrap();
    assert_eq!((&velocity["n"], &velocity["test"]), (&4.into(), &"t".into()));
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
    let again = study.mine("run").ok();
    assert!(again.stdout.contains("nothing was run"), "{}", again.stdout);
    // A condition in which nobody drove or said anything is no study of that condition.
    let more = "[[condition]]\nid = \"wild\"\n\n[baseline]";
    change(&study, "mine/study.toml", "[baseline]", more);
    let refused = study.mine("run");
    assert_eq!(refused.status, Some(1));
    tells(&refused.stderr, &["nobody drove or rated the condition `wild`", "maveric status"]);
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
    let mut answers = study.read("mine/surveys/answers.csv");
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
    let broken_off: Vec<String> =
        study.read("mine/logs/P04-sporty.csv").lines().take(400).map(str::to_owned).collect();
    study.write("mine/logs/P04-sporty.csv", broken_off.join("\n"));
    study.write("mine/logs/P09-calm.csv", table(100.0, 30.0, "calm"));
    study.write("mine/logs/P01-wild.csv", table(100.0, 30.0, "wild"));
    let listed = study.read("mine/participants.csv");
    study.write("mine/participants.csv", format!("{listed}P10,,30,,\n"));
    let rules = "[exclude]\npeople = { P02 = \"withdrew consent\" }\ndrives = { P03-calm = \"simulator sickness\" }\n\
                 drive_shorter_than_s = 50\nstraight_lined = true\nfewer_conditions_than = 2\n";
    change(&study, "mine/study.toml", "[exclude]", rules);
    study.mine("run").ok();
    let rows = measured(&study);
    let of = |who: &str| rows.iter().filter(|(p, _)| p == who).count();
    assert_eq!((of("P01"), of("P02"), of("P03"), of("P04"), of("P09")), (4, 0, 3, 3, 0));
    let listed = study.read("mine/results/drives/exclusions.csv");
    tells(
        &listed,
        &[
            "left out by exclude.people: withdrew consent",
            "\nP03-calm,P03-calm.csv,left out by exclude.drives: simulator sickness,",
            "left out by exclude.drive_shorter_than_s: the drive is 20 s long, expected at least 50 s",
            "left out by unknown participant: P09 is not in the table of people",
            "`wild` is none of the design's: own, calm, normal, sporty",
        ],
    );
    let ratings = study.read("mine/results/rating_scores.csv");
    for gone in ["P02,", "P03,calm,", "P04,sporty,", "P09,", ",wild,"] {
        assert!(!ratings.contains(gone), "{gone}: {ratings}");
    }
    let scores = study.read("mine/results/scores.csv");
    assert!(!scores.contains("P02,") && !scores.contains("P05,") && scores.contains("P06,"));
    let found = analysis(&study);
    let flow = &found["flow"];
    assert_eq!(
        (&flow["recruited"], &flow["drove"], &flow["analysed"]),
        (&9.into(), &8.into(), &5.into())
    );
    let by_reason: Vec<(&str, usize)> = flow["left_out"]
        .as_array()
        .unwrap()
        .iter()
        .map(|l| (l["why"].as_str().unwrap(), l["who"].as_array().unwrap().len()))
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
        let panel = panel(&found, outcome).unwrap();
        let asked: Vec<&str> =
            panel["participants"].as_array().unwrap().iter().map(|p| p.as_str().unwrap()).collect();
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
    // Of a ride that is left out nothing counts, and whoever a rule leaves out is not waited for; a page names nobody of those who are named.
    let missing = study.read("mine/report/missing.csv");
    let short = "\"left out by exclude.drive_shorter_than_s: the drive is 20 s long, expected at least 50 s\"";
    tells(
        &missing,
        &[
            "\nP03,calm,,left out,left out,\n",
            &format!("\nP04,sporty,,{short},{short},\n"),
            "\nP10,calm,no log,no log,no answers,\n",
        ],
    );
    for who in ["P02,", "P05,", "P06,"] {
        assert!(!missing.contains(who), "{who} {missing}");
    }
    study.mine("status --missing missing.csv").ok();
    let out = "left out by exclude.drives: simulator sickness";
    let row = format!("\nP03,calm,,{out},{out},\n");
    tells(&study.read("mine/missing.csv"), &[&row]);
    let ran = study.mine("ingest --out again").ok();
    tells(
        &ran.stdout,
        &[
            "4 drives left out by exclude.people",
            "1 drive left out by exclude.drives",
            "1 drive left out by exclude.drive_shorter_than_s",
            "1 drive left out by unknown condition",
        ],
    );
    // What nobody made here is named, and left alone.
    std::fs::copy(
        study.path("mine/again/P01-own.parquet"),
        study.path("mine/again/P01-again.parquet"),
    )
    .unwrap();
    let foreign = ["P01-again.parquet", "does not list"];
    let measure = "measure --drives again --out m.csv";
    study.mine(measure).failed(1, &foreign);
    let ingest = ["ingest", "--out", "again"];
    study.maveric_in("mine", &ingest).failed(1, &foreign);
    assert!(study.path("mine/again/P01-again.parquet").exists());
}

#[test]
fn two_recorded_cars_without_a_drive_by_hand_and_a_factor_between_people() {
    let study = recorded(&["calm", "sporty"]);
    let text = study.read("mine/study.toml");
    let (head, rest) = text.split_once("[baseline]").unwrap();
    let rest = &rest[rest.find("# [[outcome]]").unwrap()..];
    study.write("mine/study.toml", format!("{head}[[factor]]\ncolumn = \"population\"\n\n{rest}"));
    let people = ["P01,town", "P02,town", "P03,lab", "P04,lab"].join(",30,,\n");
    study.write(
        "mine/participants.csv",
        format!("participant,population,age,gender,order\n{people},30,,\n"),
    );
    study.mine("run").ok();
    assert_eq!(measured(&study).len(), 8);
    let listed = study.read("mine/results/drives/exclusions.csv");
    tells(&listed, &["`own` is none of the design's: calm, sporty"]);
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
    change(&study, "mine/study.toml", "column = \"population\"", "column = \"popualtion\"");
    study
        .mine("ingest --out d")
        .failed(1, &["participants.csv", "`popualtion`", "did you mean `population`?"]);
}
