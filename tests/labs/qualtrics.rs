//! Three recorded cars, measures of their own, and answers in a workbook of Qualtrics.

use super::*;
use std::fmt::Write as _;

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
    ["RecipientLastName", "Nachname des Empfängers", "recipientLastName"],
    ["RecipientFirstName", "Vorname des Empfängers", "recipientFirstName"],
    ["RecipientEmail", "E-Mail des Empfängers", "recipientEmail"],
    ["ExternalReference", "Externe Datenreferenz", "externalDataReference"],
    ["LocationLatitude", "Breitengrad des Standorts", "locationLatitude"],
    ["LocationLongitude", "Längengrad des Standorts", "locationLongitude"],
    ["DistributionChannel", "Verteilungskanal", "distributionChannel"],
    ["UserLanguage", "Benutzersprache", "userLanguage"],
];

const CARS: [&str; 3] = ["komfort", "normal", "sport"];

/// What person `who` (from 0) answered to an item of the NASA-TLX after the car at `place`.
fn load(who: usize, place: usize, item: usize) -> usize {
    20 + 5 * who + [0, 9, 23][place] + (who * (place + 2)) % 5 + 3 * ((item + who) % 4)
}

/// Qualtrics' workbook of six people and a preview: a matrix question a car, of which the export tag is `TLX_komfort` and so on.
fn qualtrics() -> Vec<u8> {
    let items = || CARS.iter().flat_map(|car| (1..=6).map(move |item| (car, item)));
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
    let rows: Vec<Vec<&str>> =
        rows.iter().map(|r| r.iter().map(String::as_str).collect()).collect();
    let rows: Vec<&[&str]> = rows.iter().map(Vec::as_slice).collect();
    workbook(&[("Sheet0", &rows)])
}

#[test]
fn three_recorded_cars_with_measures_of_ones_own_and_answers_of_a_qualtrics_workbook() {
    let (id, text) = titled("nasa_tlx", "NASA-TLX", 6, 0, 100);
    let study = made(&CARS, &[(&id, text)]);
    // The empty table that `init` made is filled.
    study.mine("design orders --people 6").ok();
    let people = study.read("mine/participants.csv");
    assert!(people.starts_with("participant,population,age,gender,order\nP01,,,,"), "{people}");
    assert_eq!(people.lines().count(), 7);
    for who in 0..6 {
        for (place, car) in ["own"].iter().chain(&CARS).enumerate() {
            let v = kmh(who, place);
            let mut log = "t,x,y,speed_kmh,gap_m,lead_speed_kmh\n".to_owned();
            for i in 0..1200 {
                let t = f64::from(i) / 20.0;
                let y = if (20.0..40.0).contains(&t) { 3.5 } else { 0.0 };
                let _ = writeln!(log, "{t},{},{y},{v},{},{}", v / 3.6 * t, 30 + place, v - 4.0);
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
                let _ = writeln!(measures, "P{:02},{car},{trial},{seconds:.1},{glances}", who + 1);
            }
        }
    }
    study.write("mine/measures.csv", measures);
    let declared = "[[measure]]\nid = \"takeover_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\naggression = \"-\"\n\
                    [[measure]]\nid = \"glances\"\ntitle = \"Glances\"\nunit = \"1\"\n\n[contrasts]";
    change(&study, "mine/study.toml", "[contrasts]", declared);
    study.write("mine/surveys/answers.xlsx", qualtrics());
    change(&study, "mine/study.toml", "surveys/answers.csv", "surveys/answers.xlsx");
    // Whoever forgets what wrote the answers, or scores them as they are, is told.
    study.mine("run").failed(1, &["is an export of Qualtrics", "software = \"qualtrics\""]);
    score_as_they_are(&study, "surveys/answers.xlsx").failed(
        1,
        &[
            "surveys/answers.xlsx: is an export of Qualtrics",
            "`maveric import --suggest surveys/answers.xlsx",
        ],
    );
    let columns = suggested_columns(&study, "surveys/answers.xlsx", "qualtrics");
    assert!(columns.contains("\ncolumn = \"TLX_{condition}_{item}\"\n"), "{columns}");
    let before = study.mine("status").ok().stderr;
    tells(&before, &["komfort, drive: its log is not ingested yet (everybody)"]);
    let ran = study.mine("run").ok();
    tells(&ran.stderr, &["1 row of previews and tests: left out"]);
    let after = study.mine("status").ok().stderr;
    assert!(!after.contains("missing"), "{after}");

    let analysis = analysis(&study);
    let each = |value: &dyn Fn(usize) -> f64| (0..6).map(value).collect::<Vec<f64>>();
    let shorter = each(&|who| takeover(who, 0) - takeover(who, 2));
    differs(panel(&analysis, "takeover_s").unwrap(), ["komfort", "sport"], &shorter, 1e-9);
    let loads =
        |who: usize, place: usize| mean(&[0, 1, 2, 3, 4, 5].map(|i| load(who, place, i) as f64));
    for [first, second] in [[0, 1], [0, 2], [1, 2]] {
        let differences = each(&|who| loads(who, first) - loads(who, second));
        differs(
            panel(&analysis, "nasa_tlx.total").unwrap(),
            [CARS[first], CARS[second]],
            &differences,
            1e-9,
        );
        // In km/h, as the measure is shown.
        let slower = each(&|who| kmh(who, first + 1) - kmh(who, second + 1));
        differs(
            panel(&analysis, "mean_velocity_mps").unwrap(),
            [CARS[first], CARS[second]],
            &slower,
            1e-3,
        );
        let more = each(&|_| (first * first) as f64 - (second * second) as f64);
        differs(panel(&analysis, "glances").unwrap(), [CARS[first], CARS[second]], &more, 1e-9);
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
