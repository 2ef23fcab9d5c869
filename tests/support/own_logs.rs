//! Logs and answers of a laboratory's own, written by hand: tables in km/h, with a lane offset.

use super::TempStudy;
use serde_json::Value;
use std::fmt::Write as _;

/// How the tables are read, but for the names.
pub const TABLE: &str = "\n[road]\nlanes = 2\nlane_width_m = 3.66\nposted_speed_mps = 24.5872\nframe = \"map\"\n\
    [table]\nlayout = \"pair\"\ngap_kind = \"bumper_to_bumper\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"km/h\"\n\
    [table.columns]\ntime = \"t\"\nego_x = \"x\"\nego_y = \"offset\"\nego_speed = \"speed\"\ngap = \"gap\"\nlead_speed = \"lead_speed\"\n";

/// One drive as a table: a minute behind a slower car, then round it by the left lane and back. `kmh` is ego's speed, `car` stands
/// in a column of its own.
pub fn table(kmh: f64, gap_m: f64, car: &str) -> String {
    let mut text = "t,x,offset,speed,gap,lead_speed,car\n".to_owned();
    let mps = kmh / 3.6;
    for i in 0..1200 {
        let t = f64::from(i) / 20.0;
        let left = (20.0..40.0).contains(&t);
        let offset = if left { 3.66 } else { 0.0 };
        let gap = gap_m + 2.0 * (t / 7.0).sin();
        let _ = writeln!(text, "{t},{},{offset},{kmh},{gap},{},{car}", mps * t, kmh - 4.0);
    }
    text
}

/// Answers to the items of some scales, a row an item: everybody before the drives and after each condition.
pub fn answers(people: &[&str], scales: &[(&str, usize, usize)], conditions: &[&str]) -> String {
    let mut text = "participant,moment,scale,item,answer\n".to_owned();
    for (i, who) in people.iter().enumerate() {
        for (j, moment) in std::iter::once(&"pre").chain(conditions).enumerate() {
            for (scale, items, most) in scales {
                for item in 1..=*items {
                    let answer = 1 + (i + 2 * j + item) % most;
                    let _ = writeln!(text, "{who},{moment},{scale},{item},{answer}");
                }
            }
        }
    }
    text
}

/// A questionnaire of one subscale.
pub fn scale(id: &str, items: u32, min: i32, max: i32, scoring: &str) -> String {
    let all: Vec<String> = (1..=items).map(|i| i.to_string()).collect();
    format!(
        "id = \"{id}\"\ntitle = \"{id}\"\nreference = \"ours\"\nitems = {items}\nmin = {min}\nmax = {max}\nscoring = \"{scoring}\"\n\
         [[subscales]]\nid = \"total\"\ntitle = \"{id}\"\nitems = [{}]\n",
        all.join(", ")
    )
}

/// Keeps only these questionnaires of a study's folder.
pub fn only_scales(study: &TempStudy, folder: &str, scales: &[(&str, String)]) {
    let place = study.path(&format!("{folder}/scales"));
    std::fs::remove_dir_all(&place).unwrap();
    for (id, text) in scales {
        study.write(&format!("{folder}/scales/{id}.toml"), text);
    }
}

pub const PEOPLE: [&str; 4] = ["P01", "P02", "P03", "P04"];
/// What they are asked: id, items, highest answer.
pub const SCALES: [(&str, usize, usize); 2] = [("comfort", 3, 7), ("hurry", 2, 5)];

/// The results of the study in `mine`.
pub fn analysis(study: &TempStudy) -> Value {
    study.json("mine/results/analysis.json")
}

/// What an analysis has of an outcome.
pub fn panel<'a>(analysis: &'a Value, outcome: &str) -> Option<&'a Value> {
    let mut panels = analysis["panels"].as_array().unwrap().iter();
    panels.find(|panel| panel["outcome"] == outcome)
}

/// Changes a file of the study.
pub fn change(study: &TempStudy, path: &str, from: &str, to: &str) {
    let text = study.read(path);
    assert!(text.contains(from), "{path} has no {from}:\n{text}");
    study.write(path, text.replace(from, to));
}

/// Ego's speed in km/h: people differ in it, and in what a condition changes.
pub fn speed(who: usize, place: usize) -> f64 {
    95.0 + 3.0 * who as f64 + (6 + who % 3) as f64 * place as f64
}

/// A study whose cars were recorded: logs in km/h, two questionnaires of its own, the condition in the file's name.
pub fn recorded(conditions: &[&str]) -> TempStudy {
    recorded_of(&PEOPLE, conditions)
}

/// As [`recorded`], of these people.
pub fn recorded_of(people: &[&str], conditions: &[&str]) -> TempStudy {
    let study = TempStudy::new();
    let list = conditions.join(",");
    study.maveric(&["init", "mine", "--conditions", &list, "--style", "none"]).ok();
    let own =
        [("comfort", scale("comfort", 3, 1, 7, "mean")), ("hurry", scale("hurry", 2, 1, 5, "sum"))];
    only_scales(&study, "mine", &own);
    study.write("mine/surveys/answers.csv", answers(people, &SCALES, conditions));
    let names = "[names]\nfile = \"{who}-{condition}\"\ndrive = \"{who}-{condition}\"\nparticipant = \"{who}\"\ncondition = \"{condition}\"\n";
    study.write("mine/mapping.toml", format!("{names}{TABLE}"));
    let rows: Vec<String> =
        people.iter().map(|p| format!("{p},,30,,{}", conditions.join(" "))).collect();
    study.write(
        "mine/participants.csv",
        format!("participant,population,age,gender,order\n{}\n", rows.join("\n")),
    );
    for (i, who) in people.iter().enumerate() {
        for (place, condition) in ["own"].iter().chain(conditions).enumerate() {
            study.write(
                &format!("mine/logs/{who}-{condition}.csv"),
                table(speed(i, place), 30.0 + (i * place) as f64, condition),
            );
        }
    }
    study
}

/// As far as the scores.
pub const TO_THE_NUMBERS: &str = "run measure score score-ratings";

/// Participant and condition of every drive that can be measured.
pub fn measured(study: &TempStudy) -> Vec<(String, String)> {
    study.mine("measure --drives results/drives --out m.csv").ok();
    let text = study.read("mine/m.csv");
    let cells = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (cells[1].to_owned(), cells[2].to_owned())
    };
    text.lines().skip(1).map(cells).collect()
}
