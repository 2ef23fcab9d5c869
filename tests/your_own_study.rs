//! A study of one's own: the path of `docs/your-own-study.md`, walked with the small study that is shipped.

use crate::support::{TempStudy, argv, files, tells};

#[test]
fn from_logs_and_answers_to_the_report() {
    let study = TempStudy::of_sample();
    study.maveric(&["init", "mine"]).failed(1, &["mine", "not empty"]);
    let run = "run --set epochs=2 --set duration=60 -j 2";
    let ran = study.mine(run).ok();
    assert!(ran.stdout.contains("index.html"), "{}", ran.stdout);
    let page = study.read("mine/report/index.html");
    // The sample was made up, its logs say so, and so does the page.
    assert!(page.contains("ynthetic participants") && !page.contains("NaN"));
    assert!(page.contains("McDonald") && page.contains("Reliability"));
    let answered = study.read("mine/results/answers.csv");
    tells(&answered, &[",pre,adb,", ",mimic,jian_trust,", ",perpendicular,rosas,"]);
    // Ratings are scored without what was asked before the drives.
    let rated = study.read("mine/results/rating_scores.csv");
    assert!(!rated.contains(",pre,") && rated.contains(",cautious,similarity,similarity,"));
    let reliable = study.read("mine/results/scores_reliabilities.csv");
    assert!(
        reliable.lines().next().unwrap().ends_with("omega,mean,sd,floor,ceiling"),
        "{reliable}"
    );
    let items = study.read("mine/results/scores_items.csv");
    assert_eq!(items.lines().filter(|l| l.starts_with("mini_ipip,conscientiousness,")).count(), 4);
    let again = study.mine(run).ok();
    assert!(again.stdout.contains("nothing was run"), "{}", again.stdout);
}

#[test]
fn who_is_in_one_file_and_not_in_the_other_is_listed_and_faults_are_named() {
    let study = TempStudy::of_sample();
    let people = study.read("mine/participants.csv");
    let first = people.lines().nth(1).unwrap().split(',').next().unwrap().to_owned();
    study.write(
        "people.csv",
        format!("{}\nGhost,2,,,,,\n", people.replace(&format!("{first},"), "Other,").trim_end()),
    );
    let import =
        |file: &str| study.maveric(&["import", file, "--from", "otree", "--out", "surveys.csv"]);
    let said = import("mine/surveys/answers.csv").ok().stdout;
    assert!(said.contains("8 participants") || said.contains("participants"), "{said}");
    let score = argv("score --surveys surveys.csv --participants people.csv --out scores.csv");
    let ran = study.maveric(&score).ok();
    let listed = study.read("scores_exclusions.csv");
    for who in [
        "Ghost,questionnaires,participant Ghost answered no questionnaire",
        &format!("answers of {first}, who is not in the study, left out"),
    ] {
        assert!(listed.contains(who) && ran.stderr.contains("Ghost"), "{listed}");
    }

    let answers = study.read("mine/surveys/answers.csv");
    let first = answers.lines().nth(1).unwrap().split(',').next().unwrap();
    let column =
        |name: &str| answers.lines().next().unwrap().split(',').position(|c| c == name).unwrap();
    let with = |name: &str, value: &str| {
        let mut lines: Vec<String> = answers.lines().map(str::to_owned).collect();
        let mut cells: Vec<&str> = lines[1].split(',').collect();
        cells[column(name)] = value;
        lines[1] = cells.join(",");
        study.write("wrong.csv", lines.join("\n"));
        import("wrong.csv")
    };
    with("pre.1.player.adb_3", "9").failed(1, &[first, "adb", "item 3", "`9`", "1 to 5"]);
    with("pre.1.player.mdsi_40", "often").failed(1, &[first, "mdsi", "item 40", "`often`"]);
    study.write("wrong.csv", format!("{answers}{}\n", answers.lines().nth(1).unwrap()));
    import("wrong.csv").failed(1, &[first, "answered twice", "row 1"]);
    let scale = study.read("study_data/scales/adb.toml");
    study
        .write("study_data/scales/adb.toml", scale.replace("min = 1\nmax = 5", "min = 5\nmax = 1"));
    import("mine/surveys/answers.csv").failed(1, &["adb.toml", "min 5 is not below max 1"]);
    study.write("study_data/scales/adb.toml", scale.replace("items = 11", "items = 0"));
    study.maveric(&["codebook", "--out", "book"]).failed(1, &["adb.toml", "at least one item"]);
    assert!(!study.path("book").exists());
}

#[test]
fn what_is_given_away_names_nobody() {
    let study = TempStudy::of_sample();
    study.maveric(&argv("import mine/surveys/answers.csv --from otree --out long.csv")).ok();
    // A remark and an address that have no business in an export, and an exact age.
    let people = study.read("mine/participants.csv");
    let ids: Vec<&str> = people.lines().skip(1).map(|l| l.split(',').next().unwrap()).collect();
    let named: Vec<String> = ids
        .iter()
        .map(|id| format!("{id},2,external,47,female,,,secret@example.org,remark"))
        .collect();
    study.write(
        "people.csv",
        format!(
            "participant,study,population,age,gender,professional,order,mail,remark\n{}\n",
            named.join("\n")
        ),
    );
    study.write("key", "a secret of this test alone");
    let export = |key: &str, out: &str| {
        let inputs = "--logs mine/logs/study2 --participants people.csv --surveys long.csv";
        study.maveric(&argv(&format!("export {inputs} --key {key} --out {out}")))
    };
    export("key", "shared").ok();
    let written = files(&study.path("shared"));
    assert!(written.len() >= 4 + 3);
    for path in &written {
        let bytes = std::fs::read(path).unwrap();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let mut secrets = ids.clone();
        if path.extension().is_some_and(|e| e == "csv") {
            secrets.extend(["secret@example.org", "remark", ",47,"]);
        }
        for secret in secrets {
            let inside = bytes.windows(secret.len()).any(|w| w == secret.as_bytes());
            assert!(!inside && !name.contains(secret), "{secret} is in {name}");
        }
    }
    assert!(study.read("shared/participants.csv").contains(",40-49,female,"));
    // The wide table says what the long one does.
    study.maveric(&argv("import shared/surveys_wide.csv --from otree --out back.csv")).ok();
    assert_eq!(
        study.read("back.csv").lines().count(),
        study.read("shared/surveys.csv").lines().count()
    );
    let sorted = |path: &str| {
        let text = study.read(path);
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines.sort();
        lines
    };
    assert_eq!(sorted("back.csv"), sorted("shared/surveys.csv"));
    // A log still is the drive that it was.
    let ingest = |logs: &str, out: &str| {
        study.maveric(&["ingest", logs, "--out", out]).ok();
        study.maveric(&["measure", "--drives", out, "--out", &format!("{out}.csv")]).ok();
        let table = study.read(&format!("{out}.csv"));
        let mut rows: Vec<String> = table
            .lines()
            .skip(1)
            .map(|l| {
                l.split(',')
                    .skip(4)
                    .map(|v| v.chars().take(4).collect::<String>())
                    .collect::<Vec<_>>()
                    .join(",")
            })
            .collect();
        rows.sort();
        rows
    };
    assert_eq!(ingest("mine/logs/study2", "before"), ingest("shared/logs", "after"));
    export("nowhere", "none").failed(1, &["nowhere"]);
    study.write("short", "abc");
    export("short", "none").failed(1, &["3 characters"]);
    study.maveric(&["export", "--key", "key", "--out", "none"]).failed(1, &["nothing to export"]);
    assert!(!study.path("none").exists());
}

#[test]
fn the_codebook_has_every_item_of_every_scale() {
    let study = TempStudy::new();
    study.maveric(&["codebook", "--out", "book"]).ok();
    let table = study.read("book/codebook.csv");
    tells(
        &table,
        &[
            "mini_ipip,conscientiousness,8,mini_ipip_8,likert,1,5,true,Often forget to put things back",
        ],
    );
    assert!(
        table.contains("jian_trust,overall,1,jian_trust_1,likert,1,7,true,")
            && table.contains("jian_trust,distrust,1,jian_trust_1,likert,1,7,false,")
    );
    let page = study.read("book/codebook.md");
    for scale in [
        "adb",
        "mdsi",
        "mini_ipip",
        "jian_trust",
        "rosas",
        "godspeed_intelligence",
        "similarity",
        "aggressiveness",
    ] {
        assert!(page.contains(&format!("(`{scale}`)")), "{scale}");
    }
    assert!(page.contains("alpha: Houston") && page.contains("it is not in the public domain"));
}
