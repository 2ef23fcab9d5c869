//! `maveric stats` as a process: bad tables, missing cells, and the reports that people read.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod support;

use std::fmt::Write as _;
use support::{Ran, TempStudy};

const WITHIN: [&str; 6] = ["--subject", "s", "--within", "w", "--value", "v"];

fn stats(study: &TempStudy, call: &[&str], table: &str) -> Ran {
    study.write("d.csv", table);
    study.maveric(&[&["stats", call[0], "d.csv"], &call[1..]].concat())
}

fn within(study: &TempStudy, command: &str, table: &str) -> Ran {
    stats(study, &[&[command], &WITHIN[..]].concat(), table)
}

fn json(study: &TempStudy, call: &[&str], table: &str) -> serde_json::Value {
    let ran = stats(study, &[call, &["--format", "json"]].concat(), table).ok();
    serde_json::from_str(&ran.stdout).unwrap()
}

#[test]
fn a_table_that_is_no_design_is_refused_with_its_own_message() {
    let study = TempStudy::new();
    for (table, words) in [
        (
            "s,w,v\na,x,1\na,y,2\n",
            &["1 complete subject", "at least 2"][..],
        ),
        ("s,w,v\na,x,1\nb,x,2\n", &["1 condition", "at least 2"]),
        (
            "s,w,v\na,x,1\na,x,3\na,y,2\nb,x,2\nb,y,4\n",
            &["subject `a`", "condition `x`", "two values"],
        ),
        (
            "s,w,v\na,x,1\na,y,fast\nb,x,2\nb,y,4\n",
            &["d.csv", "fast", "`v`"],
        ),
        ("s,w,v\na,x,1\na,y,inf\nb,x,2\nb,y,4\n", &["inf"]),
        ("s,w,v\na,x,1\na,y,-1e400\nb,x,2\nb,y,4\n", &["finite"]),
        ("s,w,v\n", &["d.csv", "no rows"]),
        ("", &["d.csv", "empty"]),
        ("s,w,value\na,x,1\na,y,2\nb,x,2\nb,y,4\n", &["`v`", "value"]),
    ] {
        for command in ["within", "compare"] {
            within(&study, command, table).failed(1, words);
        }
    }
}

#[test]
fn a_subject_with_a_missing_cell_is_named_and_counted() {
    let study = TempStudy::new();
    let table =
        "s,w,v\nann,x,1\nann,y,2\nben,x,2\nben,y,4.5\ncem,x,3\ncem,y,\ndee,x,1\ndee,y,3\neva,y,3\n";
    let ran = within(&study, "within", table).ok();
    assert!(ran.stderr.contains("cem, eva"), "{}", ran.stderr);
    assert!(
        ran.stdout.contains("2 of 5 subjects (cem, eva)"),
        "{}",
        ran.stdout
    );
    let value = json(&study, &[&["within"], &WITHIN[..]].concat(), table);
    assert_eq!(value["n"], 3);
    assert_eq!(value["dropped"], serde_json::json!(["cem", "eva"]));
}

#[test]
fn constant_data_have_reasons_and_no_numbers() {
    let study = TempStudy::new();
    let table = "s,w,v\na,x,2\na,y,2\na,z,2\nb,x,2\nb,y,2\nb,z,2\nc,x,2\nc,y,2\nc,z,2\n";
    let value = json(&study, &[&["within"], &WITHIN[..]].concat(), table);
    for (part, name) in [("rm_anova", "F"), ("friedman", "chi2"), ("mauchly", "W")] {
        assert!(value[part][name].is_null(), "{part}.{name}");
        let said = |key: &str| value["undefined"][key].is_string();
        assert!(
            said(part) || said(&format!("{part}.{name}")),
            "{part}.{name}"
        );
    }
    let ran = within(&study, "compare", table).ok();
    assert!(ran.stdout.contains("No value (–)"), "{}", ran.stdout);
}

#[test]
fn the_report_of_a_comparison_says_what_why_and_how_much() {
    let study = TempStudy::new();
    let mut table = String::from("s,w,v\n");
    for (i, row) in [
        [1.0, 4.0, 2.0],
        [2.0, 6.0, 3.0],
        [3.0, 6.5, 3.5],
        [1.5, 5.0, 4.0],
        [2.5, 5.0, 2.0],
    ]
    .iter()
    .enumerate()
    {
        for (condition, value) in ["slow", "fast", "other"].iter().zip(row) {
            let _ = writeln!(table, "P{i},{condition},{value}");
        }
    }
    let ran = within(&study, "compare", &table).ok();
    for words in [
        "5 subjects, 3 conditions",
        "Checks",
        "Why this test",
        "ηp² = ",
        "90% CI",
        "slow|fast",
        "95% CI",
        "p adjusted",
    ] {
        assert!(
            ran.stdout.contains(words),
            "no `{words}` in\n{}",
            ran.stdout
        );
    }
    // Columns line up: every row of the pairs is as wide as the header says or narrower.
    let rows: Vec<&str> = ran
        .stdout
        .lines()
        .filter(|line| line.contains('|') && line.ends_with(']'))
        .collect();
    assert_eq!(rows.len(), 3);
    assert!(
        rows.iter()
            .all(|row| row.chars().count() == rows[0].chars().count()),
        "{rows:?}"
    );
}

#[test]
fn the_correction_of_pairs_is_named_as_it_is() {
    let study = TempStudy::new();
    let table = "s,w,v\na,x,1\na,y,2\na,z,5\nb,x,2\nb,y,4\nb,z,5\nc,x,1\nc,y,3\nc,z,4\nd,x,2\nd,y,3\nd,z,6\n";
    let call =
        |more: &[&'static str]| json(&study, &[&["posthoc"], &WITHIN[..], more].concat(), table);
    let said = call(&["--test", "t", "--adjust", "bonferroni"]);
    assert!(
        said["apa"]["x|y"]
            .as_str()
            .unwrap()
            .contains("p_Bonferroni"),
        "{}",
        said["apa"]
    );
    let said = call(&["--test", "nemenyi"]);
    assert!(
        said["apa"]["x|z"]
            .as_str()
            .unwrap()
            .starts_with("q(3, ∞) = "),
        "{}",
        said["apa"]
    );
}
