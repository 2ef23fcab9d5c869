//! From a workbook of answers to scores: 100 people, 12 conditions, a questionnaire of 40 items.
//!
//! `cargo bench -p maveric-study --bench answers`.
#![expect(clippy::unwrap_used, reason = "a benchmark fails as tests do")]

#[path = "../src/stages/import/tests/workbook.rs"]
mod workbook;

use maveric_study::{
    Stage, Watch,
    stages::{
        import::Import,
        score::{Moments, ScoreAnswers},
    },
};
use std::{fmt::Write as _, path::Path, sync::LazyLock};
use tempfile::TempDir;

/// A folder with the workbook, the questionnaire, the design and the map of columns.
static STUDY: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    std::fs::create_dir(folder.path().join("scales")).unwrap();
    let items: Vec<String> = (1..=40).map(|item| item.to_string()).collect();
    let scale = format!(
        "id = \"long\"\ntitle = \"Long\"\nreference = \"made up\"\nitems = 40\nmin = 1\nmax = 7\nscoring = \"mean\"\n\
         [[subscales]]\nid = \"long\"\ntitle = \"Long\"\nitems = [{}]\n",
        items.join(", ")
    );
    write("scales/long.toml", scale.as_bytes());
    let conditions: Vec<String> = (1..=12).map(|n| format!("c{n:02}")).collect();
    let mut design = "[study]\ntitle = \"t\"\n".to_owned();
    for id in &conditions {
        let _ = writeln!(design, "[[condition]]\nid = \"{id}\"\ncar = {{ recorded = true }}");
    }
    write("study.toml", design.as_bytes());
    let map = "[scales.long]\ncolumn = \"{condition}_long_{item}\"\n";
    write("columns.toml", map.as_bytes());
    let names = conditions.iter().flat_map(|c| items.iter().map(move |i| format!("{c}_long_{i}")));
    let mut rows = vec![std::iter::once("participant".to_owned()).chain(names).collect::<Vec<_>>()];
    for person in 1..=100_usize {
        let answers = (0..12 * 40).map(|at| (1 + (person * (at + 3) + at / 7) % 7).to_string());
        rows.push(std::iter::once(format!("P{person:03}")).chain(answers).collect());
    }
    let people: String = rows.iter().map(|row| row[0].clone() + "\n").collect();
    write("participants.csv", people.as_bytes());
    let rows: Vec<Vec<&str>> =
        rows.iter().map(|row| row.iter().map(String::as_str).collect()).collect();
    let rows: Vec<&[&str]> = rows.iter().map(Vec::as_slice).collect();
    write("answers.xlsx", &workbook::workbook(&[("Sheet1", &rows)]));
    folder
});

fn main() {
    divan::main();
}

fn run<S: Stage>(stage: &S) {
    stage.run(Watch::unwatched()).unwrap();
}

/// The workbook as the table that is scored.
fn import(folder: &Path) {
    run(&Import {
        file: folder.join("answers.xlsx"),
        from: None,
        design: Some(folder.join("study.toml")),
        columns: Some(folder.join("columns.toml")),
        sheet: None,
        scales: Some(folder.join("scales")),
        suggest: false,
        out: Some(folder.join("answers.csv")),
    });
}

fn score(folder: &Path) {
    run(&ScoreAnswers {
        design: Some(folder.join("study.toml")),
        surveys: vec![folder.join("answers.csv")],
        participants: None,
        scales: Some(folder.join("scales")),
        drives: Vec::new(),
        moments: Moments::After,
        out: folder.join("scores.csv"),
    });
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn from_a_workbook_to_scores() {
    import(STUDY.path());
    score(STUDY.path());
}
