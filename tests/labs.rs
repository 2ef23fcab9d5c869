//! Three laboratories' studies, walked as somebody new would: `init`, `inspect`, `import --suggest`, `status`, `run`, the page. Every number
//! is computed here once more, from what was written into the files.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod support;
#[path = "../crates/study/src/stages/import/tests/workbook.rs"]
mod workbook;

use maveric_study::tables::Table;
use serde_json::Value;
use std::fmt::Write as _;
use support::{
    TempStudy,
    own_logs::{change, only_scales, read, scale},
    page::Page,
};
use workbook::workbook;

/// A study's folder as `init` makes it, with these questionnaires alone where there are any.
fn made(conditions: &[&str], scales: &[(&str, String)]) -> TempStudy {
    let study = TempStudy::new();
    let list = conditions.join(",");
    let init = ["init", "mine", "--conditions", &list, "--style", "none"];
    study.maveric(&init).ok();
    if !scales.is_empty() {
        only_scales(&study, "mine", scales);
    }
    study
}

/// A questionnaire of the study's own, by its title.
fn titled(id: &str, title: &str, items: u32, min: i32, max: i32) -> (String, String) {
    let text = scale(id, items, min, max, "mean");
    let own = format!("title = \"{id}\"");
    (
        id.to_owned(),
        text.replace(&own, &format!("title = \"{title}\"")),
    )
}

/// Turns the comments of a proposal that begin with these words into lines of it.
fn uncomment(text: &str, lines: &[&str]) -> String {
    let is_meant = |line: &str| lines.iter().any(|l| line.starts_with(&format!("# {l}")));
    let line = |line: &str| {
        if is_meant(line) {
            line[2..].to_owned()
        } else {
            line.to_owned()
        }
    };
    text.lines().map(|l| line(l) + "\n").collect()
}

/// The mapping that `inspect` proposes for a log, with whose drive a file is, and more words changed.
fn proposed(study: &TempStudy, log: &str, changes: &[(&str, &str)]) {
    let suggest = [
        "inspect",
        "--suggest-mapping",
        log,
        "--into",
        "proposed.toml",
    ];
    study.maveric_in("mine", &suggest).ok();
    let names = [
        "[names]",
        "file =",
        "drive =",
        "participant =",
        "condition =",
    ];
    let mut text = uncomment(&read(study, "mine/proposed.toml"), &names);
    for (from, to) in changes {
        assert!(text.contains(from), "no `{from}` in {text}");
        text = text.replacen(from, to, 1);
    }
    study.write("mine/mapping.toml", text);
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn variance(values: &[f64]) -> f64 {
    let mean = mean(values);
    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64
}

/// Student's t of differences from none.
fn t(differences: &[f64]) -> f64 {
    mean(differences) / (variance(differences) / differences.len() as f64).sqrt()
}

#[track_caller]
fn near(number: &Value, expected: f64, within: f64) {
    let number = number.as_f64().unwrap();
    assert!(
        (number - expected).abs() < within,
        "{number}, not {expected}"
    );
}

struct Analysis(Value);

impl Analysis {
    fn of(study: &TempStudy) -> Self {
        Self(serde_json::from_str(&read(study, "mine/results/analysis.json")).unwrap())
    }

    fn panel(&self, outcome: &str) -> &Value {
        let mut panels = self.0["panels"].as_array().unwrap().iter();
        panels.find(|panel| panel["outcome"] == outcome).unwrap()
    }

    /// Mean difference of two conditions, and its t where it was tested by one.
    #[track_caller]
    fn differs(&self, outcome: &str, [first, second]: [&str; 2], differences: &[f64], within: f64) {
        let panel = self.panel(outcome);
        assert_eq!(panel["n"], differences.len(), "{outcome}");
        let mut contrasts = panel["contrasts"].as_array().unwrap().iter();
        let contrast = contrasts.find(|c| c["first"] == first && c["second"] == second);
        let contrast = contrast.unwrap();
        near(&contrast["mean_difference"], mean(differences), within);
        if panel["test"] == "t" {
            near(&contrast["statistic"], t(differences), within * 100.0);
        }
    }
}

/// One value of every drive, by its name.
fn measured(study: &TempStudy, column: &str) -> Vec<(String, f64)> {
    let table = Table::read(&study.path("mine/results/measurements.parquet")).unwrap();
    let drives = table.text("drive").unwrap().into_iter().flatten();
    let values = table.numbers(column).unwrap();
    drives.zip(values.into_iter().map(Option::unwrap)).collect()
}

/// The columns that Qualtrics writes before the questions, with their texts and ids: `sample.csv` of the R package qualtRics
/// (tests/testthat/files), an export of a German account.
const QUALTRICS: [[&str; 3]; 17] = [
    ["StartDate", "Anfangsdatum", "startDate"],
    ["EndDate", "Enddatum", "endDate"],
    ["Status", "Antworttyp", "status"],
    ["IPAddress", "IP-Adresse", "ipAddress"],
    ["Progress", "Aktueller Stand", "progress"],
    ["Duration (in seconds)", "Dauer (in Sekunden)", "duration"],
    ["Finished", "Beendet", "finished"],
    ["RecordedDate", "Erfassungsdatum", "recordedDate"],
    ["ResponseId", "Antwort-ID", "_recordId"],
    [
        "RecipientLastName",
        "Nachname des Empfängers",
        "recipientLastName",
    ],
    [
        "RecipientFirstName",
        "Vorname des Empfängers",
        "recipientFirstName",
    ],
    ["RecipientEmail", "E-Mail des Empfängers", "recipientEmail"],
    [
        "ExternalReference",
        "Externe Datenreferenz",
        "externalDataReference",
    ],
    [
        "LocationLatitude",
        "Breitengrad des Standorts",
        "locationLatitude",
    ],
    [
        "LocationLongitude",
        "Längengrad des Standorts",
        "locationLongitude",
    ],
    [
        "DistributionChannel",
        "Verteilungskanal",
        "distributionChannel",
    ],
    ["UserLanguage", "Benutzersprache", "userLanguage"],
];

const CARS: [&str; 3] = ["komfort", "normal", "sport"];

/// What person `who` (from 0) answered to an item of the NASA-TLX after the car at `place`.
fn load(who: usize, place: usize, item: usize) -> usize {
    20 + 5 * who + [0, 9, 23][place] + (who * (place + 2)) % 5 + 3 * ((item + who) % 4)
}

/// Qualtrics' workbook of six people and a preview: a matrix question a car, of which the export tag is `TLX_komfort` and so on.
fn qualtrics() -> Vec<u8> {
    let items = || {
        CARS.iter()
            .flat_map(|car| (1..=6).map(move |item| (car, item)))
    };
    let text = |word: &str| word.to_owned();
    let mut rows: Vec<Vec<String>> = Vec::new();
    let names = items().map(|(car, item)| format!("TLX_{car}_{item}"));
    rows.push(QUALTRICS.iter().map(|c| text(c[0])).chain(names).collect());
    let texts = items().map(|(_, item)| format!("Wie war die Fahrt? - Aussage {item}"));
    rows.push(QUALTRICS.iter().map(|c| text(c[1])).chain(texts).collect());
    let id = |id: &str| format!("{{\"ImportId\":\"{id}\"}}");
    let ids = items().map(|(car, item)| {
        let question = CARS.iter().position(|c| c == car).unwrap() + 1;
        id(&format!("QID{question}_{item}"))
    });
    rows.push(QUALTRICS.iter().map(|c| id(c[2])).chain(ids).collect());
    for row in 0..7_usize {
        let who = row.checked_sub(1);
        let (status, label) =
            who.map_or(("1", "P99".to_owned()), |w| ("0", format!("P{:02}", w + 1)));
        let response = format!("R_2YPOQ602ER1jkf{row}");
        let before = [
            "2026-07-18 08:28:09",
            "2026-07-18 08:48:48",
            status,
            "130.92.34.66",
            "100",
            "1239",
            "1",
            "2026-07-18 08:48:48",
            &response,
            "",
            "",
            "",
            &label,
            "47.1151",
            "7.23160",
            "anonymous",
            "DE",
        ];
        let answer = |place: usize, item| load(who.unwrap_or(0), place, item).to_string();
        let answers = (0..3).flat_map(|place| (0..6).map(move |item| (place, item)));
        let answers = answers.map(|(place, item)| answer(place, item));
        rows.push(before.into_iter().map(text).chain(answers).collect());
    }
    let rows: Vec<Vec<&str>> = rows
        .iter()
        .map(|r| r.iter().map(String::as_str).collect())
        .collect();
    let rows: Vec<&[&str]> = rows.iter().map(Vec::as_slice).collect();
    workbook(&[("Sheet0", &rows)])
}

/// Ego's speed in km/h, which is held.
fn kmh(who: usize, place: usize) -> f64 {
    95.0 + 3.0 * who as f64 + (6 + who % 3) as f64 * place as f64
}

#[test]
fn three_recorded_cars_with_measures_of_ones_own_and_answers_of_a_qualtrics_workbook() {
    let (id, text) = titled("nasa_tlx", "NASA-TLX", 6, 0, 100);
    let study = made(&CARS, &[(&id, text)]);
    // The empty table that `init` made is filled.
    study
        .maveric_in("mine", &["design", "orders", "--people", "6"])
        .ok();
    let people = read(&study, "mine/participants.csv");
    assert!(
        people.starts_with("participant,population,age,gender,order\nP01,,,,"),
        "{people}"
    );
    assert_eq!(people.lines().count(), 7);
    for who in 0..6 {
        for (place, car) in ["own"].iter().chain(&CARS).enumerate() {
            let v = kmh(who, place);
            let mut log = "t,x,y,speed_kmh,gap_m,lead_speed_kmh\n".to_owned();
            for i in 0..1200 {
                let t = f64::from(i) / 20.0;
                let y = if (20.0..40.0).contains(&t) { 3.5 } else { 0.0 };
                let _ = writeln!(
                    log,
                    "{t},{},{y},{v},{},{}",
                    v / 3.6 * t,
                    30 + place,
                    v - 4.0
                );
            }
            study.write(&format!("mine/logs/P{:02}-{car}.csv", who + 1), log);
        }
    }
    let road = [
        ("{participant}_{condition}", "{participant}-{condition}"),
        ("lanes = 1", "lanes = 2"),
        ("lane_width_m = 3.66", "lane_width_m = 3.5"),
    ];
    proposed(&study, "logs/P01-komfort.csv", &road);
    // Two trials, 0.2 s to both sides of a take-over time of 2 + who / 10 s in the first car.
    let takeover = |who: usize, place: usize| {
        2.0 + 0.1 * who as f64 + (0.5 + 0.1 * (who % 4) as f64) * place as f64
    };
    let mut measures = "participant,condition,trial,takeover_s,glances\n".to_owned();
    for who in 0..6 {
        for (place, car) in CARS.iter().enumerate() {
            for (trial, off) in [(1, -0.2), (2, 0.2)] {
                let (seconds, glances) = (takeover(who, place) + off, who + place * place + trial);
                let _ = writeln!(
                    measures,
                    "P{:02},{car},{trial},{seconds:.1},{glances}",
                    who + 1
                );
            }
        }
    }
    study.write("mine/measures.csv", measures);
    let declared = "[[measure]]\nid = \"takeover_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\naggression = \"-\"\n\
                    [[measure]]\nid = \"glances\"\ntitle = \"Glances\"\nunit = \"1\"\n\n[contrasts]";
    change(&study, "mine/study.toml", "[contrasts]", declared);
    study.write("mine/surveys/answers.xlsx", qualtrics());
    change(
        &study,
        "mine/study.toml",
        "surveys/answers.csv",
        "surveys/answers.xlsx",
    );
    // Whoever forgets what wrote the answers, or scores them as they are, is told.
    study.maveric_in("mine", &["run"]).failed(
        1,
        &["is an export of Qualtrics", "software = \"qualtrics\""],
    );
    let score = [
        "score",
        "--surveys",
        "surveys/answers.xlsx",
        "--scales",
        "scales",
        "--out",
        "s.csv",
    ];
    study.maveric_in("mine", &score).failed(
        1,
        &[
            "surveys/answers.xlsx: is an export of Qualtrics",
            "`maveric import --suggest surveys/answers.xlsx",
        ],
    );
    change(
        &study,
        "mine/study.toml",
        "software = \"table\"",
        "software = \"qualtrics\"",
    );
    change(&study, "mine/study.toml", "# columns =", "columns =");
    let suggest = [
        "import",
        "--suggest",
        "surveys/answers.xlsx",
        "--scales",
        "scales",
        "--out",
        "surveys/columns.toml",
    ];
    study.maveric_in("mine", &suggest).ok();
    let columns = read(&study, "mine/surveys/columns.toml");
    assert!(
        columns.contains("\ncolumn = \"TLX_{condition}_{item}\"\n"),
        "{columns}"
    );
    let before = study.maveric_in("mine", &["status"]).ok().stderr;
    assert!(
        before.contains("komfort, drive: its log is not ingested yet (everybody)"),
        "{before}"
    );
    let ran = study.maveric_in("mine", &["run"]).ok();
    assert!(
        ran.stderr.contains("1 row of previews and tests: left out"),
        "{}",
        ran.stderr
    );
    assert!(
        !study
            .maveric_in("mine", &["status"])
            .ok()
            .stderr
            .contains("missing")
    );

    let analysis = Analysis::of(&study);
    let each = |value: &dyn Fn(usize) -> f64| (0..6).map(value).collect::<Vec<f64>>();
    let longer = each(&|who| takeover(who, 2) - takeover(who, 0));
    analysis.differs(
        "takeover_s",
        ["komfort", "sport"],
        &longer.iter().map(|d| -d).collect::<Vec<_>>(),
        1e-9,
    );
    let loads = |who: usize, place: usize| {
        mean(
            &(0..6)
                .map(|i| load(who, place, i) as f64)
                .collect::<Vec<_>>(),
        )
    };
    for [first, second] in [[0, 1], [0, 2], [1, 2]] {
        let differences = each(&|who| loads(who, first) - loads(who, second));
        analysis.differs(
            "nasa_tlx.total",
            [CARS[first], CARS[second]],
            &differences,
            1e-9,
        );
        // In km/h, as the measure is shown.
        let slower = each(&|who| kmh(who, first + 1) - kmh(who, second + 1));
        analysis.differs(
            "mean_velocity_mps",
            [CARS[first], CARS[second]],
            &slower,
            1e-3,
        );
        let more = each(&|_| (first * first) as f64 - (second * second) as f64);
        analysis.differs("glances", [CARS[first], CARS[second]], &more, 1e-9);
    }
    for (column, expected, within) in [
        ("min_headway_distance_m", None, 1e-6),
        ("lane_changes", Some(2.0), 1e-9),
        ("left_lane_fraction", Some(1.0 / 3.0), 2e-3),
    ] {
        let rows = measured(&study, column);
        assert_eq!(rows.len(), 24);
        for (drive, value) in rows {
            let car = drive.split('-').nth(1).unwrap();
            let place = ["own"].iter().chain(&CARS).position(|c| *c == car).unwrap();
            let expected = expected.unwrap_or(30.0 + place as f64);
            assert!(
                (value - expected).abs() < within,
                "{drive}: {column} is {value}, not {expected}"
            );
        }
    }
    Page::read(&study.path("mine/report/index.html"))
        .says(&[
            "6 participants in three conditions: Komfort, Normal and Sport",
            "Tested 6 24",
            "Take-over time (s) Komfort 6 2.25",
            "2 lanes of 3.50 m",
        ])
        .is_silent_of(&["What is not there", "P99"]);
}

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
    let scales = [
        titled("nasa_tlx", "NASA-TLX", 6, 1, 20),
        titled("trust", "Trust", 3, 1, 7),
    ];
    let scales = scales
        .each_ref()
        .map(|(id, text)| (id.as_str(), text.clone()));
    let study = made(&["komfort", "sport"], &scales);
    let load = |who: usize, sport: bool, item: usize| {
        4 + who % 5 + (item * (who + 1)) % 3 + if sport { 3 + (who * who) % 4 } else { 0 }
    };
    let trust = |who: usize, item: usize| 1 + (2 * who + item * (who % 2)) % 7;
    let codes = ["K", "S"]
        .into_iter()
        .flat_map(|c| (1..=6).map(move |i| format!("{c}TLX[SQ{i:03}]")));
    let before = [
        "id",
        "submitdate",
        "lastpage",
        "startlanguage",
        "seed",
        "token",
    ];
    let names = before.map(str::to_owned).into_iter().chain(codes);
    let mut rows: Vec<Vec<String>> = vec![
        names
            .chain((1..=3).map(|i| format!("VTRAUEN[SQ{i:03}]")))
            .collect(),
    ];
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
        let sport = (0..6).map(|item| {
            if left {
                String::new()
            } else {
                load(who, true, item).to_string()
            }
        });
        let trust = (0..3).map(|item| trust(who, item).to_string());
        rows.push(
            head.into_iter()
                .chain(komfort)
                .chain(sport)
                .chain(trust)
                .collect(),
        );
    }
    study.write("mine/surveys/results-survey623939.csv", limesurvey(&rows));
    let without_baseline = read(&study, "mine/study.toml");
    let (head, rest) = without_baseline.split_once("[baseline]").unwrap();
    let rest = &rest[rest.find("# [[measure]]").unwrap()..];
    study.write("mine/study.toml", format!("{head}{rest}"));
    let score = [
        "score",
        "--surveys",
        "surveys/results-survey623939.csv",
        "--scales",
        "scales",
        "--out",
        "s.csv",
    ];
    study.maveric_in("mine", &score).failed(
        1,
        &[
            "is an export of LimeSurvey",
            "maveric import --suggest surveys/results-survey623939.csv",
        ],
    );
    change(
        &study,
        "mine/study.toml",
        "surveys/answers.csv",
        "surveys/results-survey623939.csv",
    );
    change(
        &study,
        "mine/study.toml",
        "software = \"table\"",
        "software = \"limesurvey\"",
    );
    change(&study, "mine/study.toml", "# columns =", "columns =");
    // Nobody is listed yet: nobody takes part, and it is said what to do.
    let suggest = [
        "import",
        "--suggest",
        "surveys/results-survey623939.csv",
        "--scales",
        "scales",
        "--out",
        "surveys/columns.toml",
    ];
    study.maveric_in("mine", &suggest).ok();
    let columns = read(&study, "mine/surveys/columns.toml");
    assert!(
        columns.contains("8 rows, read as an export of LimeSurvey"),
        "{columns}"
    );
    // It abstains: what K and S are, and that VTRAUEN asks for trust, only the laboratory knows.
    let meant = uncomment(
        &columns,
        &[
            "[moments]",
            "K =",
            "S =",
            "[scales.",
            "column = \"{condition}",
            "column = \"VTRAUEN",
        ],
    );
    study.maveric_in("mine", &["run"]).failed(1, &[]);
    let meant = meant
        .replace("K = \"?\"", "K = \"komfort\"")
        .replace("S = \"?\"", "S = \"sport\"");
    study.write("mine/surveys/columns.toml", meant);
    study
        .maveric_in("mine", &["run"])
        .failed(1, &["participants.csv: has no row: nobody takes part"]);
    let ids: Vec<String> = (1..=8).map(|who| format!("VP{who:02}")).collect();
    study.write(
        "mine/participants.csv",
        format!("participant\n{}\n", ids.join("\n")),
    );
    study.maveric_in("mine", &["run"]).ok();

    let analysis = Analysis::of(&study);
    let loads = |who, sport| {
        mean(
            &(0..6)
                .map(|i| load(who, sport, i) as f64)
                .collect::<Vec<_>>(),
        )
    };
    let differences: Vec<f64> = (0..7)
        .map(|who| loads(who, false) - loads(who, true))
        .collect();
    let mut panel = analysis.panel("nasa_tlx.total").clone();
    // Eight rated one car, seven both.
    assert_eq!(panel["n"].take(), 7);
    analysis.differs("nasa_tlx.total", ["komfort", "sport"], &differences, 1e-9);
    let described = analysis.0["descriptives"].as_array().unwrap();
    let komfort: Vec<f64> = (0..8).map(|who| loads(who, false)).collect();
    let row = described
        .iter()
        .find(|row| row["condition"] == "komfort")
        .unwrap();
    assert_eq!(row["n"], 8);
    near(&row["mean"], mean(&komfort), 1e-9);
    near(&row["sd"], variance(&komfort).sqrt(), 1e-9);
    // Cronbach's alpha of what was asked before the drives.
    let items: Vec<Vec<f64>> = (0..3)
        .map(|i| (0..8).map(|who| trust(who, i) as f64).collect())
        .collect();
    let sums: Vec<f64> = (0..8)
        .map(|who| items.iter().map(|item| item[who]).sum())
        .collect();
    let parts: f64 = items.iter().map(|item| variance(item)).sum();
    let alpha = 3.0 / 2.0 * (1.0 - parts / variance(&sums));
    let table = Table::read(&study.path("mine/results/scores_reliabilities.csv")).unwrap();
    let at = table
        .text("scale")
        .unwrap()
        .iter()
        .position(|s| s.as_deref() == Some("trust"))
        .unwrap();
    let written = table.numbers("alpha").unwrap()[at].unwrap();
    assert!((written - alpha).abs() < 1e-9, "{written}, not {alpha}");
    let missing = read(&study, "mine/report/missing.csv");
    assert!(
        missing.contains("\nVP08,sport,no log,no log,no answers,\n"),
        "{missing}"
    );
    Page::read(&study.path("mine/report/index.html"))
        .says(&[
            "8 participants in two conditions: Komfort and Sport",
            "took part in the conditions (Komfort and Sport) and answered questionnaires about them",
            "NASA-TLX (rating, 1 to 20) Sport 7",
            "There are no drives",
            "All 16 rows; missing.csv beside this page has all of them",
        ])
        .is_silent_of(&["recordings are read", "recorded conditions"]);
    assert!(read(&study, "mine/report/index.html").contains("outcomes: NASA-TLX"));
}

#[test]
fn a_table_of_people_that_was_emptied_lets_nobody_in_again() {
    let (id, text) = titled("trust", "Trust", 1, 1, 7);
    let study = made(&["komfort", "sport"], &[(&id, text)]);
    let answers = |people: &[&str]| {
        let rows = people
            .iter()
            .flat_map(|who| ["komfort", "sport"].map(|car| format!("{who},{car},trust,1,4\n")));
        format!(
            "participant,moment,scale,item,answer\n{}",
            rows.collect::<String>()
        )
    };
    study.write("mine/surveys/answers.csv", answers(&["P01", "P02", "P03"]));
    study.write("key", "a secret of this test alone");
    let export = ["export", "--key", "../key", "--out", "../shared"];
    let scores = || {
        study.maveric_in("mine", &["run", "score-ratings"]).ok();
        read(&study, "mine/results/rating_scores.csv")
    };
    study.write("mine/participants.csv", "participant\nP01\nP02\n");
    let listed = scores();
    assert!(
        listed.contains("P02,") && !listed.contains("P03,"),
        "{listed}"
    );
    study.write("mine/participants.csv", "participant\nP01\n");
    assert!(!scores().contains("P02,"));
    // The last one is taken out, too: nobody comes back by that.
    study.write("mine/participants.csv", "participant\n");
    let words = [
        "participants.csv: has no row: nobody takes part",
        "maveric design orders",
    ];
    study.maveric_in("mine", &["run"]).failed(1, &words);
    study.maveric_in("mine", &export).failed(1, &words);
    assert!(!study.path("shared").exists());
    study.write("mine/participants.csv", "participant\nP01\nP02\nP03\n");
    assert!(scores().contains("P03,"));
}

/// Half a minute of a German rig's recording a file: decimal commas, the lane by its number, the place in it.
fn halves(who: usize, place: usize, hole: bool) -> [String; 2] {
    let head =
        "Zeit [s];Geschwindigkeit [km/h];Abstand [m];v_Vordermann [km/h];Spur;Querablage [m]\n";
    let mut halves = [head.to_owned(), head.to_owned()];
    let v = kmh(who, place);
    for i in (0..1200).filter(|i| !(hole && (600..610).contains(i))) {
        let t = f64::from(i) / 20.0;
        // Across the line at 20 s and at 40 s, within 4 s each.
        let over = |at: f64| ((t - at + 2.0) / 4.0).clamp(0.0, 1.0);
        let y = 3.5 * (over(20.0) - over(40.0));
        let lane = if y >= 1.75 { 2 } else { 1 };
        let row = format!(
            "{t:.2};{v:.1};{:.3};{:.1};{lane};{:.3}\n",
            gap(place, t),
            v - 4.0,
            y - 3.5 * f64::from(lane - 1) + 0.1 * t.sin()
        );
        halves[usize::from(i >= 600)] += &row.replace('.', ",");
    }
    halves
}

fn gap(place: usize, t: f64) -> f64 {
    30.0 + 2.0 * place as f64 + 2.0 * (t / 7.0).sin()
}

#[test]
fn split_logs_of_lane_and_offset_with_german_heads() {
    let study = made(&["komfort", "sport"], &[]);
    let cars = ["own", "komfort", "sport"];
    for who in 0..6 {
        for (place, car) in cars.iter().enumerate() {
            let name = format!("mine/logs/VP{:02}/VP{:02}-{car}", who + 1, who + 1);
            let [first, second] = halves(who, place, who == 2);
            study.write(&format!("{name}.csv"), first);
            study.write(&format!("{name}_2.csv"), second);
        }
    }
    let people: Vec<String> = (1..=6).map(|who| format!("VP{who:02}\n")).collect();
    study.write(
        "mine/participants.csv",
        format!("participant\n{}", people.concat()),
    );
    let names = (
        "{participant}_{condition}\"\n",
        "{participant}-{condition}\"\nparts = \"_{n}\"\n",
    );
    proposed(
        &study,
        "logs/VP01/VP01-komfort.csv",
        &[names, ("lane_width_m = 3.66", "lane_width_m = 3.5")],
    );
    let mapping = read(&study, "mine/mapping.toml");
    for key in [
        "ego_speed = \"Geschwindigkeit [km/h]\"",
        "gap = \"Abstand [m]\"",
        "lead_speed = \"v_Vordermann [km/h]\"",
        "lane = \"Spur\"",
        "offset = \"Querablage [m]\"",
        "speed = \"km/h\"",
        "decimal_comma = true",
    ] {
        assert!(mapping.contains(key), "no `{key}` in {mapping}");
    }
    let ran = study.maveric_in("mine", &["run"]).ok().stderr;
    assert!(
        ran.contains("15 logs (") && ran.contains("goes on in its part 2, 0.050 s later"),
        "{ran}"
    );
    assert!(
        ran.contains("3 logs (") && ran.contains("goes on in its part 2, 0.550 s later"),
        "{ran}"
    );
    let speeds = measured(&study, "mean_velocity_mps");
    assert_eq!(speeds.len(), 18);
    for (drive, mps) in &speeds {
        let who: usize = drive[2..4].parse().unwrap();
        let place = cars.iter().position(|c| drive.ends_with(c)).unwrap();
        assert!(
            (mps - kmh(who - 1, place) / 3.6).abs() < 1e-6,
            "{drive}: {mps}"
        );
    }
    let whole = |drive: &str| !drive.starts_with("VP03");
    for (drive, changes) in measured(&study, "lane_changes") {
        assert!((changes - 2.0).abs() < 1e-9, "{drive}: {changes}");
    }
    for (drive, share) in measured(&study, "left_lane_fraction")
        .iter()
        .filter(|(d, _)| whole(d))
    {
        assert!((share - 1.0 / 3.0).abs() < 2e-3, "{drive}: {share}");
    }
    for (drive, least) in measured(&study, "min_headway_distance_m")
        .iter()
        .filter(|(d, _)| whole(d))
    {
        let place = cars.iter().position(|c| drive.ends_with(c)).unwrap();
        let gaps = (0..1200).map(|i| gap(place, f64::from(i) / 20.0));
        let smallest = gaps.fold(f64::INFINITY, f64::min);
        assert!(
            (least - smallest).abs() < 2e-3,
            "{drive}: {least}, not {smallest}"
        );
    }
    let analysis = Analysis::of(&study);
    let differences: Vec<f64> = (0..6).map(|who| kmh(who, 1) - kmh(who, 2)).collect();
    analysis.differs(
        "mean_velocity_mps",
        ["komfort", "sport"],
        &differences,
        1e-3,
    );
    Page::read(&study.path("mine/report/index.html"))
        .says(&["Tested 6 18", "goes on in its part 2, 0.550 s later"])
        .is_silent_of(&["What is not there"]);
}
