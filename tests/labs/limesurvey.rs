//! Questionnaires alone, from LimeSurvey.

use super::*;

/// LimeSurvey's text: a byte order mark, semicolons, every cell in quotation marks, sub-questions in brackets, an empty line at the end
/// (application/helpers/admin/export/CsvWriter.php and Writer.php of LimeSurvey).
fn limesurvey(rows: &[Vec<String>]) -> String {
    let line = |cells: &Vec<String>| {
        let cells: Vec<String> = cells.iter().map(|c| format!("\"{c}\"")).collect();
        cells.join(";") + "\r\n"
    };
    let lines: String = rows.iter().map(line).collect();
    format!("\u{feff}{lines}\r\n")
}

#[test]
fn questionnaires_alone_from_limesurvey_where_one_person_broke_off() {
    let scales = [titled("nasa_tlx", "NASA-TLX", 6, 1, 20), titled("trust", "Trust", 3, 1, 7)];
    let scales = scales.each_ref().map(|(id, text)| (id.as_str(), text.clone()));
    let study = made(&["komfort", "sport"], &scales);
    let load = |who: usize, sport: bool, item: usize| {
        4 + who % 5 + (item * (who + 1)) % 3 + if sport { 3 + (who * who) % 4 } else { 0 }
    };
    let trust = |who: usize, item: usize| 1 + (2 * who + item * (who % 2)) % 7;
    let codes =
        ["K", "S"].into_iter().flat_map(|c| (1..=6).map(move |i| format!("{c}TLX[SQ{i:03}]")));
    let before = ["id", "submitdate", "lastpage", "startlanguage", "seed", "token"];
    let names = before.map(str::to_owned).into_iter().chain(codes);
    let mut rows: Vec<Vec<String>> =
        vec![names.chain((1..=3).map(|i| format!("VTRAUEN[SQ{i:03}]"))).collect()];
    for who in 0..8 {
        let left = who == 7;
        let day = if left { "" } else { "2026-05-04 10:00:00" };
        let head = [
            (who + 1).to_string(),
            day.to_owned(),
            "5".to_owned(),
            "de".to_owned(),
            "123456789".to_owned(),
            format!("VP{:02}", who + 1),
        ];
        let komfort = (0..6).map(|item| load(who, false, item).to_string());
        let sport =
            (0..6).map(|item| if left { String::new() } else { load(who, true, item).to_string() });
        let trust = (0..3).map(|item| trust(who, item).to_string());
        rows.push(head.into_iter().chain(komfort).chain(sport).chain(trust).collect());
    }
    study.write("mine/surveys/results-survey623939.csv", limesurvey(&rows));
    let without_baseline = study.read("mine/study.toml");
    let (head, rest) = without_baseline.split_once("[baseline]").unwrap();
    let rest = &rest[rest.find("# [[measure]]").unwrap()..];
    study.write("mine/study.toml", format!("{head}{rest}"));
    score_as_they_are(&study, "surveys/results-survey623939.csv").failed(
        1,
        &[
            "is an export of LimeSurvey",
            "maveric import --suggest surveys/results-survey623939.csv",
        ],
    );
    change(&study, "mine/study.toml", "surveys/answers.csv", "surveys/results-survey623939.csv");
    let columns = suggested_columns(&study, "surveys/results-survey623939.csv", "limesurvey");
    assert!(columns.contains("8 rows, read as an export of LimeSurvey"), "{columns}");
    // It abstains: what K and S are, and that VTRAUEN asks for trust, only the laboratory knows.
    let meant = uncomment(
        &columns,
        &["[moments]", "K =", "S =", "[scales.", "column = \"{condition}", "column = \"VTRAUEN"],
    );
    study.mine("run").failed(1, &[]);
    // Nobody is listed yet: nobody takes part, and it is said what to do.
    let meant = meant.replace("K = \"?\"", "K = \"komfort\"").replace("S = \"?\"", "S = \"sport\"");
    study.write("mine/surveys/columns.toml", meant);
    study.mine("run").failed(1, &["participants.csv: has no row: nobody takes part"]);
    let ids: Vec<String> = (1..=8).map(|who| format!("VP{who:02}")).collect();
    study.write("mine/participants.csv", format!("participant\n{}\n", ids.join("\n")));
    study.mine("run").ok();

    let analysis = analysis(&study);
    let loads = |who, sport| mean(&[0, 1, 2, 3, 4, 5].map(|i| load(who, sport, i) as f64));
    let differences: Vec<f64> = (0..7).map(|who| loads(who, false) - loads(who, true)).collect();
    let workload = panel(&analysis, "nasa_tlx.total").unwrap();
    // Eight rated one car, seven both.
    assert_eq!(workload["n"], 7);
    differs(workload, ["komfort", "sport"], &differences, 1e-9);
    let described = analysis["descriptives"].as_array().unwrap();
    let komfort: Vec<f64> = (0..8).map(|who| loads(who, false)).collect();
    let row = described.iter().find(|row| row["condition"] == "komfort").unwrap();
    assert_eq!(row["n"], 8);
    near(&row["mean"], mean(&komfort), 1e-9);
    near(&row["sd"], variance(&komfort).sqrt(), 1e-9);
    // Cronbach's alpha of what was asked before the drives.
    let items: Vec<Vec<f64>> =
        (0..3).map(|i| (0..8).map(|who| trust(who, i) as f64).collect()).collect();
    let sums: Vec<f64> = (0..8).map(|who| items.iter().map(|item| item[who]).sum()).collect();
    let parts: f64 = items.iter().map(|item| variance(item)).sum();
    let alpha = 3.0 / 2.0 * (1.0 - parts / variance(&sums));
    let table = Table::read(&study.path("mine/results/scores_reliabilities.csv")).unwrap();
    let at =
        table.text("scale").unwrap().iter().position(|s| s.as_deref() == Some("trust")).unwrap();
    let written = table.numbers("alpha").unwrap()[at].unwrap();
    assert!((written - alpha).abs() < 1e-9, "{written}, not {alpha}");
    let missing = study.read("mine/report/missing.csv");
    tells(&missing, &["\nVP08,sport,no log,no log,no answers,\n"]);
    Page::read(&study.path("mine/report/index.html"))
        .says(&[
            "8 participants in two conditions: Komfort and Sport",
            "took part in the conditions (Komfort and Sport) and answered questionnaires about the conditions; of 1 of them nothing counts in some condition",
            "NASA-TLX (rating, 1 to 20) Sport 7",
            "There are no drives",
            "All 16 rows; missing.csv beside this page has all of them",
        ])
        .is_silent_of(&["recordings are read", "recorded conditions"]);
    assert!(study.read("mine/report/index.html").contains("outcomes: NASA-TLX"));
}

#[test]
fn a_table_of_people_that_was_emptied_lets_nobody_in_again() {
    let (id, text) = titled("trust", "Trust", 1, 1, 7);
    let study = made(&["komfort", "sport"], &[(&id, text)]);
    let answers = |people: &[&str]| {
        let rows = people
            .iter()
            .flat_map(|who| ["komfort", "sport"].map(|car| format!("{who},{car},trust,1,4\n")));
        format!("participant,moment,scale,item,answer\n{}", rows.collect::<String>())
    };
    study.write("mine/surveys/answers.csv", answers(&["P01", "P02", "P03"]));
    study.write("key", "a secret of this test alone");
    let export = "export --key ../key --out ../shared";
    let scores = || {
        study.mine("run score-ratings").ok();
        study.read("mine/results/rating_scores.csv")
    };
    study.write("mine/participants.csv", "participant\nP01\nP02\n");
    let listed = scores();
    assert!(listed.contains("P02,") && !listed.contains("P03,"), "{listed}");
    study.write("mine/participants.csv", "participant\nP01\n");
    assert!(!scores().contains("P02,"));
    // The last one is taken out, too: nobody comes back by that.
    study.write("mine/participants.csv", "participant\n");
    let words = ["participants.csv: has no row: nobody takes part", "maveric design orders"];
    study.mine("run").failed(1, &words);
    study.mine(export).failed(1, &words);
    assert!(!study.path("shared").exists());
    study.write("mine/participants.csv", "participant\nP01\nP02\nP03\n");
    assert!(scores().contains("P03,"));
}
