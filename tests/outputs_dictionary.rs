//! What a run writes: every file and column explained, a manuscript that compiles, and a page that answers first.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod support;

use maveric_study::{
    dictionary::{OUTPUTS, outputs_page},
    tables::Table,
};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    process::Command,
    sync::OnceLock,
};
use support::{TempStudy, root};

/// One run for all tests: making it takes most of their time.
fn run() -> &'static TempStudy {
    static RUN: OnceLock<TempStudy> = OnceLock::new();
    RUN.get_or_init(|| {
        let study = TempStudy::new();
        study.maveric(&["run", "pipelines/smoke.toml"]).ok();
        study
    })
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn the_page_of_outputs_is_the_one_that_the_code_gives() {
    let path = root().join("docs/outputs.md");
    let made = outputs_page();
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(
        committed, made,
        "UPDATE_GOLDEN=1 writes docs/outputs.md anew"
    );
}

#[test]
fn every_file_of_a_run_and_every_column_has_its_entry() {
    let results = run().path("study_data/generated/smoke");
    let mut unknown = BTreeSet::new();
    for path in files(&results) {
        let shown = path
            .strip_prefix(&results)
            .unwrap()
            .to_string_lossy()
            .replace('\\', "/");
        let Some(entry) = OUTPUTS.iter().find(|o| o.is(&shown)) else {
            unknown.insert(shown);
            continue;
        };
        let ending = path
            .extension()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if !matches!(ending.as_str(), "csv" | "parquet") {
            continue;
        }
        for column in Table::read(&path).unwrap().columns() {
            if entry.column(&column).is_none() {
                unknown.insert(format!("{}: column {column}", entry.name));
            }
        }
    }
    assert!(
        unknown.is_empty(),
        "no entry in the dictionary: {unknown:#?}"
    );
}

#[test]
fn a_column_that_nobody_explained_would_be_found() {
    let drives = OUTPUTS
        .iter()
        .find(|o| o.is("av/drives/drives.csv"))
        .unwrap();
    assert!(drives.column("duration_s").is_some() && drives.column("duration_ms").is_none());
    let embeddings = OUTPUTS.iter().find(|o| o.is("embeddings.csv")).unwrap();
    assert!(embeddings.column("w12").is_some() && embeddings.column("x1").is_none());
}

/// Macros of `numbers.tex`, in order.
fn macros(tex: &str) -> Vec<&str> {
    let lines = tex
        .lines()
        .filter_map(|line| line.strip_prefix("\\newcommand{\\"));
    lines.filter_map(|rest| rest.split('}').next()).collect()
}

#[test]
fn a_small_paper_compiles_with_the_numbers_methods_and_results_of_the_page() {
    let report = run().path("reports/smoke");
    let manuscript = report.join("manuscript");
    let numbers = std::fs::read_to_string(manuscript.join("numbers.tex")).unwrap();
    let found = macros(&numbers);
    let once: BTreeSet<&str> = found.iter().copied().collect();
    assert_eq!(once.len(), found.len(), "a macro is defined twice");
    assert!(found.len() > 100, "{} macros", found.len());
    assert!(
        found
            .iter()
            .all(|name| name.chars().all(|c| c.is_ascii_alphabetic()))
    );
    let csv = std::fs::read_to_string(manuscript.join("numbers.csv")).unwrap();
    assert!(found.iter().all(|name| csv.contains(&format!("\n{name},"))));
    for part in ["results.md", "methods.md", "references.bib"] {
        assert!(
            !std::fs::read_to_string(manuscript.join(part))
                .unwrap()
                .trim()
                .is_empty(),
            "{part}"
        );
    }
    // Every macro is used, the tables as they are, one figure as PDF.
    let used: Vec<String> = found
        .iter()
        .map(|name| format!("\\{name}{{}}\\par"))
        .collect();
    let tables =
        ["descriptives", "contrasts", "bias"].map(|t| format!("\\input{{../tables/{t}.tex}}"));
    let paper = format!(
        "\\documentclass{{article}}\n\\usepackage[T1]{{fontenc}}\n\\usepackage{{booktabs,textcomp,graphicx}}\n\\input{{numbers}}\n\\begin{{document}}\n\
         \\input{{methods}}\n\\input{{results}}\n{}\n\\includegraphics{{../figures/difference-panels.pdf}}\n{}\n\
         \\bibliographystyle{{plain}}\\bibliography{{references}}\n\\end{{document}}\n",
        tables.join("\n"),
        used.join("\n")
    );
    std::fs::write(manuscript.join("paper.tex"), paper).unwrap();
    let latex = ["tectonic", "pdflatex"].into_iter().find(|program| {
        Command::new(program)
            .arg("--version")
            .output()
            .is_ok_and(|o| o.status.success())
    });
    let Some(latex) = latex else {
        eprintln!(
            "skipped: neither tectonic nor pdflatex is here, so the small paper was not compiled; its macros were checked"
        );
        return;
    };
    let mut command = Command::new(latex);
    if latex == "pdflatex" {
        command.args(["-interaction=nonstopmode", "-halt-on-error"]);
    }
    let ran = command
        .arg("paper.tex")
        .current_dir(&manuscript)
        .output()
        .unwrap();
    let said =
        String::from_utf8_lossy(&ran.stdout).into_owned() + &String::from_utf8_lossy(&ran.stderr);
    let end: String = said
        .lines()
        .rev()
        .take(30)
        .collect::<Vec<_>>()
        .into_iter()
        .rev()
        .collect::<Vec<_>>()
        .join("\n");
    assert!(ran.status.success(), "{latex}: {end}");
    assert!(!said.contains("Undefined control sequence"), "{end}");
    assert!(manuscript.join("paper.pdf").is_file());
}

#[test]
fn a_drive_as_csv_has_its_rows_and_names_no_lead_where_nobody_is_there() {
    let study = run();
    let drives = study.path("study_data/generated/smoke/drives/study2");
    let drive = files(&drives)
        .into_iter()
        .find(|p| p.extension().is_some_and(|e| e == "parquet"))
        .unwrap();
    let out = study.path("drive.csv");
    study
        .maveric(&[
            "inspect",
            drive.to_str().unwrap(),
            "--csv",
            out.to_str().unwrap(),
        ])
        .ok();
    let table = Table::read(&out).unwrap();
    assert_eq!(table.rows(), Table::read(&drive).unwrap().rows());
    let entry = OUTPUTS
        .iter()
        .find(|o| o.is("drives/study2/x.parquet"))
        .unwrap();
    assert!(table.columns().iter().all(|c| entry.column(c).is_some()));
    let (present, gap) = (
        table.text("lead_present").unwrap(),
        table.numbers("lead_dx_m").unwrap(),
    );
    assert!(
        present
            .iter()
            .zip(&gap)
            .all(|(p, g)| (p.as_deref() == Some("true")) == g.is_some())
    );
}

#[test]
fn a_style_reaches_a_figure_of_one_test_and_a_page_and_a_wrong_one_is_refused() {
    let study = run();
    let style = study.write(
        "style.toml",
        "[palette]\nink = \"#123456\"\n[size]\none_column_mm = 90\n[labels]\nx = \"Age (years)\"\n[conditions.mimic]\nlabel = \"Own style\"\n",
    );
    study.write("two.csv", "x,y\n1,2\n2,3\n3,5\n4,4\n5,8\n6,7\n");
    let style = style.to_str().unwrap();
    let figure = |name: &str| {
        study
            .maveric(&[
                "stats",
                "correlate",
                "two.csv",
                "--x",
                "x",
                "--y",
                "y",
                "--figure",
                name,
                "--style",
                style,
            ])
            .ok();
        std::fs::read(study.path(name)).unwrap()
    };
    let svg = String::from_utf8(figure("a.svg")).unwrap();
    assert!(svg.contains("#123456") && !svg.contains("#222222"));
    assert!(svg.contains(">Age (years)</text>"), "{svg}");
    assert!(figure("a.pdf").starts_with(b"%PDF"));
    let report = [
        "report",
        "study_data/generated/smoke",
        "--out",
        "reports/styled",
        "--style",
        style,
    ];
    study.maveric(&report).ok();
    let page = std::fs::read_to_string(study.path("reports/styled/index.html")).unwrap();
    assert!(page.contains("#123456") && page.contains("Own style"));
    study.write("bad.toml", "[palette]\nink = \"dark\"\n");
    study
        .maveric(&[
            "report",
            "study_data/generated/smoke",
            "--out",
            "reports/x",
            "--style",
            "bad.toml",
        ])
        .failed(1, &["bad.toml", "palette.ink", "#rrggbb"]);
}

#[test]
fn the_page_answers_first_and_folds_what_is_behind() {
    let page = std::fs::read_to_string(run().path("reports/smoke/index.html")).unwrap();
    let at = |what: &str| page.find(what).unwrap_or_else(|| panic!("no {what}"));
    for card in [
        "own-style",
        "nearer",
        "dial",
        "noticed",
        "style",
        "across",
        "preferred",
        "personality",
        "paper",
    ] {
        assert!(
            at(&format!("id=\"card-{card}\"")) < at("id=\"contents\""),
            "{card}"
        );
    }
    // Four people: nothing goes with anything.
    assert!(page.contains("too few to say"));
    assert!(!page.contains("jian_trust: overall") && page.contains("<abbr title="));
    assert!(at("id=\"section-1\"") < at("class=\"supplement\""));
}
