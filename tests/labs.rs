//! Three laboratories' studies, walked as somebody new would: `init`, `inspect`, `import --suggest`, `status`, `run`, the page. Every number
//! is computed here once more, from what was written into the files.

mod limesurvey;
mod qualtrics;
mod split_logs;
#[path = "../crates/study/src/stages/import/tests/workbook.rs"]
mod workbook;

use crate::support::{
    Ran, TempStudy,
    own_logs::{analysis, change, only_scales, panel, scale},
    page::Page,
    tells,
};
use maveric_study::tables::Table;
use serde_json::Value;
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
    (id.to_owned(), text.replace(&own, &format!("title = \"{title}\"")))
}

/// Turns the comments of a proposal that begin with these words into lines of it.
fn uncomment(text: &str, lines: &[&str]) -> String {
    let is_meant = |line: &str| lines.iter().any(|l| line.starts_with(&format!("# {l}")));
    let line = |line: &str| {
        if is_meant(line) { line[2..].to_owned() } else { line.to_owned() }
    };
    text.lines().map(|l| line(l) + "\n").collect()
}

/// The mapping that `inspect` proposes for a log, with whose drive a file is, and more words changed.
fn proposed(study: &TempStudy, log: &str, changes: &[(&str, &str)]) {
    let line = format!("inspect --suggest-mapping {log} --into proposed.toml");
    study.mine(&line).ok();
    let names = ["[names]", "file =", "drive =", "participant =", "condition ="];
    let mut text = uncomment(&study.read("mine/proposed.toml"), &names);
    for (from, to) in changes {
        assert!(text.contains(from), "no `{from}` in {text}");
        text = text.replacen(from, to, 1);
    }
    study.write("mine/mapping.toml", text);
}

/// Scores an export of survey software without saying of which.
fn score_as_they_are(study: &TempStudy, answers: &str) -> Ran {
    let line = format!("score --surveys {answers} --out s.csv");
    study.mine(&line)
}

/// The columns that `import` proposes for an export of `software`, which the design names from now on.
fn suggested_columns(study: &TempStudy, answers: &str, software: &str) -> String {
    let named = format!("software = \"{software}\"");
    change(study, "mine/study.toml", "software = \"table\"", &named);
    change(study, "mine/study.toml", "# columns =", "columns =");
    let out = "surveys/columns.toml";
    let line = format!("import --suggest {answers} --out {out}");
    study.mine(&line).ok();
    study.read("mine/surveys/columns.toml")
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
    assert!((number - expected).abs() < within, "{number}, not {expected}");
}

/// Mean difference of two conditions, and its t where it was tested by one.
#[track_caller]
fn differs(panel: &Value, [first, second]: [&str; 2], differences: &[f64], within: f64) {
    assert_eq!(panel["n"], differences.len(), "{panel}");
    let mut contrasts = panel["contrasts"].as_array().unwrap().iter();
    let contrast = contrasts.find(|c| c["first"] == first && c["second"] == second);
    let contrast = contrast.unwrap();
    near(&contrast["mean_difference"], mean(differences), within);
    if panel["test"] == "t" {
        near(&contrast["statistic"], t(differences), within * 100.0);
    }
}

/// One value of every drive, by its name.
fn measured(study: &TempStudy, column: &str) -> Vec<(String, f64)> {
    let table = Table::read(&study.path("mine/results/measurements.parquet")).unwrap();
    let drives = table.text("drive").unwrap().into_iter().flatten();
    let values = table.numbers(column).unwrap();
    drives.zip(values.into_iter().map(Option::unwrap)).collect()
}

/// Ego's speed in km/h, which is held.
fn kmh(who: usize, place: usize) -> f64 {
    95.0 + 3.0 * who as f64 + (6 + who % 3) as f64 * place as f64
}
