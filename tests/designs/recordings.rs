//! From recordings and answers to what is measured and given away.

use super::*;

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
    study.mine("run ingest").ok();
    let by_folder = measured(&study);
    assert_eq!(by_folder.len(), 12);
    let words = "columns = { condition = \"car\" }\nwords = { OWN = \"own\", CALM = \"calm\", SPORTY = \"sporty\" }\n";
    study.write("mine/mapping.toml", format!("[names]\n{words}{people}{TABLE}"));
    study.mine("run ingest").ok();
    // The drives are called by the column's words now; those of before are gone.
    assert_eq!(measured(&study), by_folder);
    assert!(study.path("mine/results/drives/P01-CALM.parquet").exists());
    assert!(!study.path("mine/results/drives/P01-calm.parquet").exists());
}

#[test]
fn drives_in_parts_with_a_lane_and_a_place_in_it_measure_as_whole_ones_with_a_position_do() {
    let study = recorded(&["calm", "sporty"]);
    study.mine("run ingest").ok();
    assert_eq!(measured(&study).len(), 12);
    let whole = study.read("mine/m.csv");
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
            let text = study.read(&format!("{name}.csv"));
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
    let halves = study.mine("run ingest").ok().stderr;
    tells(&halves, &["it may be a part of a recording that was split", "`parts = \"_{n}\"`"]);
    change(&study, "mine/mapping.toml", "[names]\n", "[names]\nparts = \"_{n}\"\n");
    let joined = study.mine("run ingest").ok().stderr;
    tells(&joined, &["12 logs (", "goes on in its part 2, 0.050 s later"]);
    assert_eq!(measured(&study).len(), 12);
    assert_eq!(study.read("mine/m.csv"), whole);
}

#[test]
fn a_condition_may_be_called_as_the_time_before_the_drives_is_and_keeps_its_answers() {
    let study = recorded(&["pre", "post"]);
    study.mine(TO_THE_NUMBERS).failed(1, &["answers.csv", "P01", "`comfort`", "`after:pre`"]);
    // The first five rows of everybody are those of before.
    let table = study.read("mine/surveys/answers.csv");
    let lines = table.lines().enumerate().map(|(n, line)| match n {
        0 => line.to_owned(),
        n if (n - 1) % 15 < 5 => line.to_owned(),
        _ => line.replace(",pre,", ",after:pre,"),
    });
    let lines: Vec<String> = lines.collect();
    study.write("mine/surveys/answers.csv", lines.join("\n") + "\n");
    study.mine(TO_THE_NUMBERS).ok();
    let scores = study.read("mine/results/rating_scores.csv");
    let rows = |moment: &str| scores.lines().filter(|l| l.contains(moment)).count();
    assert_eq!([rows(",after:pre,"), rows(",after:post,"), rows(",pre,")], [8, 8, 0], "{scores}");
    let notes = study.mine("status").ok().stderr;
    assert!(!notes.contains("nobody"), "{notes}");
    study.mine("run").ok();
    let analysis = analysis(&study);
    let rows = analysis["descriptives"].as_array().unwrap().iter();
    let rated = rows.filter(|row| row["condition"] == "pre" && row["outcome"] == "comfort.total");
    let people: Vec<_> = rated.map(|row| row["n"].as_u64()).collect();
    assert_eq!(people, [Some(4)], "{analysis}");
}

#[test]
fn a_study_is_exported_and_traced_from_its_folder_without_a_path() {
    let study = recorded(&["calm", "sporty"]);
    study.write("key", "a secret of this test alone");
    study.mine(TO_THE_NUMBERS).ok();
    let whole = "export --key ../key --out ../shared --pipeline";
    study.mine(whole).ok();
    let logs = |out: &str| std::fs::read_dir(study.path(out).join("logs")).unwrap().count();
    assert_eq!(logs("shared"), 12);
    let people = study.read("shared/participants.csv");
    assert_eq!(people.lines().count(), 1 + PEOPLE.len(), "{people}");
    assert_eq!(
        study.read("shared/surveys.csv").lines().count(),
        study.read("mine/surveys/answers.csv").lines().count()
    );
    assert!(study.path("shared/pipeline.toml").exists());
    // What is named is exported alone, its columns as study.toml has them.
    let named = "export --logs logs --key ../key --out ../logs";
    study.mine(named).ok();
    assert_eq!(logs("logs"), 12);
    assert!(!study.path("logs/surveys.csv").exists());
    let steps = study.mine("trace results/measurements.parquet").ok().stdout;
    assert!(steps.contains("logs/P01-calm.csv") || steps.contains("ingest"), "{steps}");
    // A shell empties the file before the program starts that is to fill it.
    study.write("mine/pipelines/study.toml", "");
    let text = study.mine("run --show").ok().stdout;
    assert!(text.contains("maveric\", \"measure\""), "{text}");
    study.write("mine/pipelines/study.toml", &text);
    let again = study.mine("run --show").ok().stdout;
    assert_eq!(again, text);
    // The study's own pipeline goes on where the design's left off: nothing runs again, and nothing there is somebody else's.
    study.mine("run").ok();
    assert!(!study.path("mine/pipelines/study.lock").exists());
    assert!(study.read("mine/.maveric/study.lock").contains("report"));
}

#[test]
fn every_rule_leaves_out_the_same_people_and_drives_everywhere() {
    let people = ["P01", "P02", "P03", "P04", "P05", "P06", "P07", "P08", "P09"];
    let study = recorded_of(&people, &["calm", "sporty"]);
    study.write("key", "a secret of this test alone");
    let rules = "[exclude]\ndrive_shorter_than_s = 50\nstraight_lined = true\nfewer_conditions_than = 2\n\
                 people = { P02 = \"withdrew consent\" }\ndrives = { P03-sporty = \"lost the road\" }\n";
    change(&study, "mine/study.toml", "[exclude]", rules);
    // A scale with a reversed item, so that one answer throughout contradicts itself.
    let longer = scale("comfort", 6, 1, 7, "mean");
    let reversed = longer.replacen("[[subscales]]", "reversed = [2]\n[[subscales]]", 1);
    study.write("mine/scales/comfort.toml", reversed);
    let answers = answers(&people, &[("comfort", 6, 7), ("hurry", 2, 5)], &["calm", "sporty"]);
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
    let long = study.read("mine/logs/P06-calm.csv");
    let short: Vec<&str> = long.lines().take(401).collect();
    study.write("mine/logs/P06-calm.csv", short.join("\n") + "\n");
    study.mine("run").ok();
    let analysis = analysis(&study);
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
        ["exclude.people", "exclude.straight_lined", "exclude.fewer_conditions_than"]
    );
    // Two lose a condition with a drive, so that the rule for conditions takes them, too.
    let (gone, drives) = (left_out(&flow["left_out"]), left_out(&flow["drives"]));
    assert_eq!(gone, ["P02", "P03", "P04", "P05", "P06"], "{flow}");
    assert_eq!(drives, ["P03-sporty", "P06-calm"], "{flow}");
    assert_eq!((&flow["recruited"], &flow["analysed"]), (&9.into(), &4.into()));
    let notes = study.mine("status").ok().stderr;
    for who in people {
        let told = notes.contains(&format!("{who} is left out: "));
        assert_eq!(told, gone.iter().any(|g| g == who), "{who} in {notes}");
    }
    for drive in &drives {
        assert!(notes.contains(&format!("{drive} is left out: ")), "{notes}");
    }
    Page::read(&study.path("mine/report/index.html"))
        .says(&["Of 9 who were recruited, 5 were left out"]);
    let whole = "export --key ../key --out ../shared";
    study.mine(whole).ok();
    let analysed = 4;
    let shared = study.read("shared/participants.csv");
    assert_eq!(shared.lines().count(), 1 + analysed, "{shared}");
    let logs = std::fs::read_dir(study.path("shared/logs")).unwrap();
    assert_eq!(logs.count(), 3 * analysed);
    let answers = study.read("shared/surveys.csv");
    assert_eq!(answers.lines().count(), 1 + 3 * 8 * analysed);
    // Before the study is analysed, the rules that look at all of it leave out nobody: that is said.
    std::fs::remove_file(study.path("mine/results/analysis.json")).unwrap();
    let before = study.mine(whole).ok().stderr;
    tells(&before, &["analysis.json is not there: rules for sheets"]);
}

#[test]
fn each_rig_is_exported_and_ingested_by_its_own_mapping() {
    let study = recorded(&["calm", "sporty"]);
    study.write("key", "a secret of this test alone");
    let text = study.read("mine/mapping.toml");
    study.write("mine/mph.toml", text.replace("km/h", "mph"));
    std::fs::create_dir(study.path("mine/logs/mph")).unwrap();
    for from in ["own", "calm", "sporty"].map(|c| format!("P01-{c}.csv")) {
        let logs = study.path("mine/logs");
        std::fs::rename(logs.join(&from), logs.join("mph").join(&from)).unwrap();
    }
    let rigs = "[{ logs = \"logs/mph\", file = \"mph.toml\" }, { logs = \"logs\", file = \"mapping.toml\" }]";
    change(&study, "mine/study.toml", "mapping = \"mapping.toml\"", &format!("mapping = {rigs}"));
    let whole = "export --key ../key --out ../shared";
    study.mine(whole).ok();
    let logs = std::fs::read_dir(study.path("shared/logs")).unwrap();
    assert_eq!(logs.count(), 12);
    let fastest = |logs: &str| {
        let ingest = ["ingest", logs, "--out", "../d"];
        study.maveric_in("mine", &ingest).ok();
        let measure = "measure --drives ../d --out ../m.csv";
        study.mine(measure).ok();
        let table = maveric_study::tables::Table::read(&study.path("m.csv")).unwrap();
        let speeds = table.numbers("mean_velocity_mps").unwrap();
        speeds.into_iter().flatten().fold(0.0, f64::max)
    };
    let (by_mph, by_kmh) = (fastest("logs/mph"), fastest("logs"));
    assert!(by_mph > 1.3 * by_kmh, "{by_mph} {by_kmh}");
}
