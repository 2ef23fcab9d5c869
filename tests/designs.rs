//! Studies that are not the paper's, walked with the program: what a `study.toml` says is what happens.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod support;

use path_slash::PathExt as _;
use support::TempStudy;
use support::own_logs::{
    PEOPLE, TABLE, TO_THE_NUMBERS, answers, change, measured, read, recorded, recorded_of, scale,
    speed, table,
};
use support::page::Page;

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
fn drives_in_parts_with_a_lane_and_a_place_in_it_measure_as_whole_ones_with_a_position_do() {
    let study = recorded(&["calm", "sporty"]);
    study.maveric_in("mine", &["run", "ingest"]).ok();
    assert_eq!(measured(&study).len(), 12);
    let whole = read(&study, "mine/m.csv");
    change(
        &study,
        "mine/mapping.toml",
        "ego_y = \"offset\"\n",
        "lane = \"lane\"\noffset = \"offset\"\n",
    );
    change(
        &study,
        "mine/mapping.toml",
        "[table]\n",
        "[table]\nlanes_from = \"right\"\noffset_grows = \"left\"\n",
    );
    for who in PEOPLE {
        for condition in ["own", "calm", "sporty"] {
            let name = format!("mine/logs/{who}-{condition}");
            let text = read(&study, &format!("{name}.csv"));
            let rows = text.lines().map(|row| {
                let (before, behind) = (row.splitn(3, ','), row.splitn(4, ',').last().unwrap());
                let cells: Vec<&str> = before.take(2).collect();
                let across = match row.split(',').nth(2).unwrap() {
                    "offset" => "lane,offset",
                    "0" => "1,0",
                    _ => "2,0",
                };
                format!("{},{across},{behind}", cells.join(","))
            });
            let rows: Vec<String> = rows.collect();
            let part = |rows: &[String]| rows.join("\n") + "\n";
            study.write(&format!("{name}.csv"), part(&rows[..600]));
            let rest = [&rows[..1], &rows[600..]].concat();
            study.write(&format!("{name}_2.csv"), part(&rest));
        }
    }
    let halves = study.maveric_in("mine", &["run", "ingest"]).ok().stderr;
    assert!(
        halves.contains("it may be a part of a recording that was split")
            && halves.contains("`parts = \"_{n}\"`"),
        "{halves}"
    );
    change(
        &study,
        "mine/mapping.toml",
        "[names]\n",
        "[names]\nparts = \"_{n}\"\n",
    );
    let joined = study.maveric_in("mine", &["run", "ingest"]).ok().stderr;
    assert!(
        joined.contains("12 logs (") && joined.contains("goes on in its part 2, 0.050 s later"),
        "{joined}"
    );
    assert_eq!(measured(&study).len(), 12);
    assert_eq!(read(&study, "mine/m.csv"), whole);
}

#[test]
fn a_condition_may_be_called_as_the_time_before_the_drives_is_and_keeps_its_answers() {
    let study = recorded(&["pre", "post"]);
    study
        .maveric_in("mine", &TO_THE_NUMBERS)
        .failed(1, &["answers.csv", "P01", "`comfort`", "`after:pre`"]);
    // The first five rows of everybody are those of before.
    let table = read(&study, "mine/surveys/answers.csv");
    let lines = table.lines().enumerate().map(|(n, line)| match n {
        0 => line.to_owned(),
        n if (n - 1) % 15 < 5 => line.to_owned(),
        _ => line.replace(",pre,", ",after:pre,"),
    });
    let lines: Vec<String> = lines.collect();
    study.write("mine/surveys/answers.csv", lines.join("\n") + "\n");
    study.maveric_in("mine", &TO_THE_NUMBERS).ok();
    let scores = read(&study, "mine/results/rating_scores.csv");
    let rows = |moment: &str| scores.lines().filter(|l| l.contains(moment)).count();
    assert_eq!(
        [rows(",after:pre,"), rows(",after:post,"), rows(",pre,")],
        [8, 8, 0],
        "{scores}"
    );
    let notes = study.maveric_in("mine", &["status"]).ok().stderr;
    assert!(!notes.contains("nobody"), "{notes}");
    study.maveric_in("mine", &["run"]).ok();
    let analysis: serde_json::Value =
        serde_json::from_str(&read(&study, "mine/results/analysis.json")).unwrap();
    let rows = analysis["descriptives"].as_array().unwrap().iter();
    let rated = rows.filter(|row| row["condition"] == "pre" && row["outcome"] == "comfort.total");
    let people: Vec<_> = rated.map(|row| row["n"].as_u64()).collect();
    assert_eq!(people, [Some(4)], "{analysis}");
}

#[test]
fn a_study_is_exported_and_traced_from_its_folder_without_a_path() {
    let study = recorded(&["calm", "sporty"]);
    study.write("key", "a secret of this test alone");
    study.maveric_in("mine", &TO_THE_NUMBERS).ok();
    let whole = [
        "export",
        "--key",
        "../key",
        "--out",
        "../shared",
        "--pipeline",
    ];
    study.maveric_in("mine", &whole).ok();
    let logs = |out: &str| {
        std::fs::read_dir(study.path(out).join("logs"))
            .unwrap()
            .count()
    };
    assert_eq!(logs("shared"), 12);
    let people = read(&study, "shared/participants.csv");
    assert_eq!(people.lines().count(), 1 + PEOPLE.len(), "{people}");
    assert_eq!(
        read(&study, "shared/surveys.csv").lines().count(),
        read(&study, "mine/surveys/answers.csv").lines().count()
    );
    assert!(study.path("shared/pipeline.toml").exists());
    // What is named is exported alone, its columns as study.toml has them.
    let named = [
        "export", "--logs", "logs", "--key", "../key", "--out", "../logs",
    ];
    study.maveric_in("mine", &named).ok();
    assert_eq!(logs("logs"), 12);
    assert!(!study.path("logs/surveys.csv").exists());
    let steps = study
        .maveric_in("mine", &["trace", "results/measurements.parquet"])
        .ok()
        .stdout;
    assert!(
        steps.contains("logs/P01-calm.csv") || steps.contains("ingest"),
        "{steps}"
    );
    // A shell empties the file before the program starts that is to fill it.
    study.write("mine/pipelines/study.toml", "");
    let text = study.maveric_in("mine", &["run", "--show"]).ok().stdout;
    assert!(text.contains("maveric\", \"measure\""), "{text}");
    study.write("mine/pipelines/study.toml", &text);
    let again = study.maveric_in("mine", &["run", "--show"]).ok().stdout;
    assert_eq!(again, text);
    // The study's own pipeline goes on where the design's left off: nothing runs again, and nothing there is somebody else's.
    study.maveric_in("mine", &["run"]).ok();
    assert!(!study.path("mine/pipelines/study.lock").exists());
    assert!(read(&study, "mine/.maveric/study.lock").contains("report"));
}

#[test]
fn every_rule_leaves_out_the_same_people_and_drives_everywhere() {
    let people = [
        "P01", "P02", "P03", "P04", "P05", "P06", "P07", "P08", "P09",
    ];
    let study = recorded_of(&people, &["calm", "sporty"]);
    study.write("key", "a secret of this test alone");
    let rules = "[exclude]\ndrive_shorter_than_s = 50\nstraight_lined = true\nfewer_conditions_than = 2\n\
                 people = { P02 = \"withdrew consent\" }\ndrives = { P03-sporty = \"lost the road\" }\n";
    change(&study, "mine/study.toml", "[exclude]", rules);
    // A scale with a reversed item, so that one answer throughout contradicts itself.
    let longer = scale("comfort", 6, 1, 7, "mean");
    let reversed = longer.replacen("[[subscales]]", "reversed = [2]\n[[subscales]]", 1);
    study.write("mine/scales/comfort.toml", reversed);
    let answers = answers(
        &people,
        &[("comfort", 6, 7), ("hurry", 2, 5)],
        &["calm", "sporty"],
    );
    let rows = answers.lines().filter_map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        match cells[..] {
            ["P04", moment, "comfort", item, _] => Some(format!("P04,{moment},comfort,{item},5")),
            // P05 neither drove nor rated one of the cars.
            ["P05", "sporty", ..] => None,
            _ => Some(line.to_owned()),
        }
    });
    let rows: Vec<String> = rows.collect();
    study.write("mine/surveys/answers.csv", rows.join("\n") + "\n");
    std::fs::remove_file(study.path("mine/logs/P05-sporty.csv")).unwrap();
    let long = read(&study, "mine/logs/P06-calm.csv");
    let short: Vec<&str> = long.lines().take(401).collect();
    study.write("mine/logs/P06-calm.csv", short.join("\n") + "\n");
    study.maveric_in("mine", &["run"]).ok();
    let analysis: serde_json::Value =
        serde_json::from_str(&read(&study, "mine/results/analysis.json")).unwrap();
    let flow = &analysis["flow"];
    let left_out = |rows: &serde_json::Value| {
        let ids = rows.as_array().unwrap().iter();
        let ids = ids.flat_map(|row| row["who"].as_array().unwrap());
        let mut ids: Vec<String> = ids.map(|id| id.as_str().unwrap().to_owned()).collect();
        ids.sort();
        ids
    };
    let rules = flow["left_out"].as_array().unwrap().iter();
    let rules: Vec<&str> = rules.map(|row| row["rule"].as_str().unwrap()).collect();
    assert_eq!(
        rules,
        [
            "exclude.people",
            "exclude.straight_lined",
            "exclude.fewer_conditions_than"
        ]
    );
    // Two lose a condition with a drive, so that the rule for conditions takes them, too.
    let (gone, drives) = (left_out(&flow["left_out"]), left_out(&flow["drives"]));
    assert_eq!(gone, ["P02", "P03", "P04", "P05", "P06"], "{flow}");
    assert_eq!(drives, ["P03-sporty", "P06-calm"], "{flow}");
    assert_eq!(
        (&flow["recruited"], &flow["analysed"]),
        (&9.into(), &4.into())
    );
    let notes = study.maveric_in("mine", &["status"]).ok().stderr;
    for who in people {
        let told = notes.contains(&format!("{who} is left out: "));
        assert_eq!(told, gone.iter().any(|g| g == who), "{who} in {notes}");
    }
    for drive in &drives {
        assert!(notes.contains(&format!("{drive} is left out: ")), "{notes}");
    }
    Page::read(&study.path("mine/report/index.html"))
        .says(&["Of 9 who were recruited, 5 were left out"]);
    let whole = ["export", "--key", "../key", "--out", "../shared"];
    study.maveric_in("mine", &whole).ok();
    let analysed = 4;
    let shared = read(&study, "shared/participants.csv");
    assert_eq!(shared.lines().count(), 1 + analysed, "{shared}");
    let logs = std::fs::read_dir(study.path("shared/logs")).unwrap();
    assert_eq!(logs.count(), 3 * analysed);
    let answers = read(&study, "shared/surveys.csv");
    assert_eq!(answers.lines().count(), 1 + 3 * 8 * analysed);
    // Before the study is analysed, the rules that look at all of it leave out nobody: that is said.
    std::fs::remove_file(study.path("mine/results/analysis.json")).unwrap();
    let before = study.maveric_in("mine", &whole).ok().stderr;
    assert!(
        before.contains("analysis.json is not there: rules for sheets"),
        "{before}"
    );
}

#[test]
fn each_rig_is_exported_and_ingested_by_its_own_mapping() {
    let study = recorded(&["calm", "sporty"]);
    study.write("key", "a secret of this test alone");
    let text = read(&study, "mine/mapping.toml");
    study.write("mine/mph.toml", text.replace("km/h", "mph"));
    std::fs::create_dir(study.path("mine/logs/mph")).unwrap();
    for from in ["own", "calm", "sporty"].map(|c| format!("P01-{c}.csv")) {
        let logs = study.path("mine/logs");
        std::fs::rename(logs.join(&from), logs.join("mph").join(&from)).unwrap();
    }
    let rigs = "[{ logs = \"logs/mph\", file = \"mph.toml\" }, { logs = \"logs\", file = \"mapping.toml\" }]";
    change(
        &study,
        "mine/study.toml",
        "mapping = \"mapping.toml\"",
        &format!("mapping = {rigs}"),
    );
    let whole = ["export", "--key", "../key", "--out", "../shared"];
    study.maveric_in("mine", &whole).ok();
    let logs = std::fs::read_dir(study.path("shared/logs")).unwrap();
    assert_eq!(logs.count(), 12);
    let fastest = |logs: &str| {
        study
            .maveric_in("mine", &["ingest", logs, "--out", "../d"])
            .ok();
        study
            .maveric_in(
                "mine",
                &["measure", "--drives", "../d", "--out", "../m.csv"],
            )
            .ok();
        let table = maveric_study::tables::Table::read(&study.path("m.csv")).unwrap();
        let speeds = table.numbers("mean_velocity_mps").unwrap();
        speeds.into_iter().flatten().fold(0.0, f64::max)
    };
    let (by_mph, by_kmh) = (fastest("logs/mph"), fastest("logs"));
    assert!(by_mph > 1.3 * by_kmh, "{by_mph} {by_kmh}");
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
        said.contains("sporty, drive: no log (everybody)") && !said.contains("calm, drive"),
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
            "[[outcome]]\nscale = \"comfort.total\"\ndrop_items = [4]\n",
            [
                "`outcome[1].drop_items`: found 4",
                "an item of `comfort.total`: 1, 2, 3",
            ],
        ),
        (
            "[[outcome]]\nscale = \"comfort.total\"\ndrop_items = [1, 2, 3]\n",
            ["every item of `comfort.total`", "so that one is left"],
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
    let drive = sound.replace("people = { P02 = ", "drives = { P03-clam = ");
    study.write("mine/study.toml", drive);
    let words = [
        "`exclude.drives`: found `P03-clam`",
        "did you mean `P03-calm`?",
    ];
    study.maveric_in("mine", &["run"]).failed(1, &words);
}

#[test]
fn status_says_what_the_seat_lacks_unless_people_drive_elsewhere() {
    let study = TempStudy::new();
    let init = [
        "init",
        "mine",
        "--conditions",
        "calm,sporty",
        "--style",
        "none",
    ];
    study.maveric(&init).ok();
    let lacks = "the seat cannot open this study: ";
    let told = |study: &TempStudy| study.maveric_in("mine", &["status"]).ok().stderr;
    assert!(!told(&study).contains(lacks));
    change(
        &study,
        "mine/study.toml",
        "# after = [\"jian_trust\"]",
        "after = [\"mod\"]",
    );
    let line = format!("{lacks}[protocol] asks scale `mod`, and there are ");
    assert!(told(&study).contains(&line), "{}", told(&study));
    let json = study
        .maveric_in("mine", &["status", "--format", "json"])
        .ok();
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(json["seat"].as_array().unwrap().len(), 1, "{json}");
    // Logs of another rig: nobody needs the seat.
    study.write("mine/logs/P01-calm.csv", "time,speed\n");
    assert!(!told(&study).contains(lacks));
    std::fs::create_dir(study.path("mine/seat")).unwrap();
    assert!(told(&study).contains(&line));
}

#[test]
fn a_person_whose_part_is_misspelt_is_named_and_one_of_another_part_is_told() {
    let study = recorded(&["calm", "sporty"]);
    let text = read(&study, "mine/study.toml");
    let people = "[people]\ntest = { part = \"test\" }\n";
    let text = if text.contains("[people]") {
        text.replace("[people]", people)
    } else {
        format!("{people}{text}")
    };
    study.write("mine/study.toml", text);
    let table = |part: &str| format!("participant,part\nP01,test\nP02,{part}\nP03,test\n");
    study.write("mine/participants.csv", table("Test"));
    study.maveric_in("mine", &["status"]).failed(
        1,
        &[
            "participants.csv",
            "row 2",
            "`part`",
            "`Test`",
            "`test`, as [people]",
        ],
    );
    study.write("mine/participants.csv", table("pilot"));
    let said = study.maveric_in("mine", &["status"]).ok().stderr;
    assert!(
        said.contains("P02: neither learned from nor tested"),
        "{said}"
    );
}

#[test]
fn a_design_says_the_power_that_a_rehearsal_of_it_found_and_recorded_cars_cannot_be_rehearsed() {
    let study = recorded(&["calm", "sporty"]);
    let describe = ["design", "describe"];
    let said = study.maveric_in("mine", &describe).ok().stdout;
    assert!(
        said.contains("## Sample size") && said.contains("cannot be rehearsed"),
        "{said}"
    );
    let rehearse = [
        "rehearse",
        "--participants",
        "6,8",
        "--effects-times",
        "1",
        "--studies",
        "4",
    ];
    let rehearse = [&rehearse[..], &["--out", "rehearsal"]].concat();
    study.maveric_in("mine", &rehearse).failed(
        1,
        &["study.toml", "`condition.calm.car`", "maveric stats power"],
    );
    let init = [
        "init",
        "dial",
        "--conditions",
        "calm,sporty",
        "--style",
        "adb.total",
        "--synthetic",
    ];
    study.maveric(&init).ok();
    let outcomes = "[[outcome]]\nmeasure = \"mean_velocity_mps\"\n\n[contrasts]";
    change(&study, "dial/study.toml", "[contrasts]", outcomes);
    let said = study.maveric_in("dial", &describe).ok().stdout;
    assert!(
        said.contains("Not settled: no rehearsal of this design was found"),
        "{said}"
    );
    study.maveric_in("dial", &rehearse).ok();
    let said = study.maveric_in("dial", &describe).ok().stdout;
    for words in [
        "4 made-up studies of each size, analysed as declared here. Its effects are assumed, not known",
        "Power, Mean velocity, Calm against Sporty: ",
        " with 6 people, ",
        " with 8 people.",
    ] {
        assert!(said.contains(words), "no `{words}` in {said}");
    }
    // What is declared decides, not the best of all tests, and an effect that is not there has no power.
    let declared = "[[hypothesis]]\nsays = \"Calm is faster than sporty\"\noutcome = \"mean_velocity_mps\"\ncontrast = [\"calm\", \"sporty\"]\n\
                    direction = \"+\"\n\n[contrasts]";
    change(&study, "dial/study.toml", "[contrasts]", declared);
    let ran = study.maveric_in("dial", &rehearse).ok();
    let words = "n = 8: “Calm is faster than sporty” is shown in 0.00 of studies";
    assert!(ran.stdout.contains(words), "{}", ran.stdout);
    Page::read(&study.path("dial/rehearsal/index.html"))
        .says(&[
            "Would 8 people show what the design declares?",
            "“Calm is faster than sporty” would be shown in 0.0% of studies",
            "Line of the style",
        ])
        .is_silent_of(&["aggression line", "what the paper’s design can show"]);
    let said = study.maveric_in("dial", &describe).ok().stdout;
    let words =
        "Power, “Calm is faster than sporty” is shown: 0.00 with 6 people, 0.00 with 8 people.";
    assert!(said.contains(words), "no `{words}` in {said}");
}

#[test]
fn a_study_that_lends_styles_is_rehearsed_with_six_people_and_refused_with_five() {
    let study = TempStudy::new();
    let shipped = support::root().join("study_data");
    let paper = std::fs::read_to_string(shipped.join("designs/paper.toml")).unwrap();
    let paper = paper.replace("\"../", &format!("\"{}/", shipped.to_slash_lossy()));
    let lent = paper.replace("{ across = true }", "{ other = \"matched\" }");
    study.write("d/study.toml", lent);
    let rehearse = |people: &str| {
        let call = ["rehearse", "--participants", people, "--studies", "2"];
        let call = [&call[..], &["--effects-times", "1", "--out", "rehearsal"]].concat();
        study.maveric_in("d", &call)
    };
    rehearse("5,8").failed(
        1,
        &[
            "`condition.perpendicular.car` lends somebody else's style",
            "a study of 5 has 4 who could lend theirs, expected 5 or more",
            "--participants 6",
        ],
    );
    rehearse("6").ok();
    let found = read(&study, "d/rehearsal/rehearsal.json");
    assert!(found.contains("perpendicular"), "{found}");
}

#[test]
fn answers_out_of_range_and_outcomes_that_nobody_answered_are_refused_by_name() {
    let study = recorded(&["calm", "sporty"]);
    let sound = read(&study, "mine/surveys/answers.csv");
    let first = sound.lines().nth(1).unwrap();
    let (head, _) = first.rsplit_once(',').unwrap();
    study.write(
        "mine/surveys/answers.csv",
        sound.replacen(first, &format!("{head},9"), 1),
    );
    let ran = study.maveric_in("mine", &["run", "score"]);
    assert_eq!(ran.status, Some(1));
    for words in ["P01", "comfort", "9", "1 to 7"] {
        assert!(ran.stderr.contains(words), "no `{words}` in {}", ran.stderr);
    }
    // A questionnaire that is declared and was never asked after a condition.
    study.write("mine/surveys/answers.csv", sound);
    let asked = "id = \"ease\"\ntitle = \"Ease\"\nreference = \"ours\"\nitems = 1\nmin = 1\nmax = 5\nscoring = \"mean\"\n\
                 [[subscales]]\nid = \"total\"\ntitle = \"Ease\"\nitems = [1]\n";
    study.write("mine/scales/ease.toml", asked);
    let outcome = "[[outcome]]\nscale = \"ease.total\"\n\n[contrasts]";
    change(&study, "mine/study.toml", "[contrasts]", outcome);
    let ran = study.maveric_in("mine", &["run"]);
    assert_eq!(ran.status, Some(1));
    let words = "names `ease.total`, which nobody answered after any condition";
    assert!(ran.stderr.contains(words), "{}", ran.stderr);
    assert!(!study.path("mine/results/analysis.json").exists());
}
