//! The dependency graph of ARCHITECTURE.md, read from `cargo metadata`.

#![allow(clippy::panic, reason = "a test stops at the first surprise")]

use serde_json::Value;
use std::{collections::BTreeMap, process::Command};

const SCIENCE: [&str; 5] = ["ingest", "measures", "model", "simulator", "participants"];

/// What each crate may use of the project.
fn allowed(name: &str) -> Vec<&'static str> {
    match name {
        "data" | "domain" | "stats" | "pipeline" | "laws" | "bag" => vec![],
        "ingest" => vec!["data", "domain", "bag"],
        "report" => vec!["domain", "stats"],
        // What judges cannot read what answered.
        "analysis" => vec!["domain", "stats", "measures"],
        "following" => vec!["domain", "laws", "model"],
        "simulator" => vec!["domain", "laws"],
        "steering" => vec!["domain", "model", "simulator"],
        "rehearsal" => vec!["domain", "stats", "analysis", "measures", "participants"],
        "study" => [
            &[
                "data",
                "domain",
                "stats",
                "report",
                "rehearsal",
                "analysis",
                "following",
                "steering",
            ][..],
            &SCIENCE[..],
        ]
        .concat(),
        // What runs in a page knows no file and no study.
        "seat-page" => vec!["domain", "measures", "model", "simulator", "steering"],
        "seat" => vec![
            "bag",
            "domain",
            "ingest",
            "model",
            "seat-page",
            "simulator",
            "study",
        ],
        "cli" => vec!["seat", "study", "pipeline"],
        // A leaf: nothing depends on it.
        "python" => [
            &["cli", "data", "study", "report", "steering"][..],
            &["domain", "stats", "analysis", "following", "laws", "bag"][..],
            &SCIENCE[..],
        ]
        .concat(),
        science if SCIENCE.contains(&science) => vec!["domain"],
        other => panic!("crate `{other}` has no floor in ARCHITECTURE.md: give it one"),
    }
}

/// Heavy dependencies and the crates that may name them.
const HOMES: [(&str, &[&str]); 13] = [
    ("pyo3", &["python"]),
    ("polars", &["ingest", "study"]),
    ("polars-io", &["ingest", "study"]),
    ("mcap", &["bag"]),
    ("plotters", &["report"]),
    ("resvg", &["report"]),
    ("pulp", &["model", "following"]),
    ("clap", &["cli"]),
    ("miette", &["cli"]),
    ("statrs", &["stats"]),
    ("wasm-bindgen", &["seat-page"]),
    ("axum", &["seat"]),
    ("rusqlite", &["seat"]),
];

fn dependencies() -> BTreeMap<String, Vec<String>> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../../Cargo.toml");
    let output = Command::new(cargo)
        .args([
            "metadata",
            "--format-version",
            "1",
            "--no-deps",
            "--offline",
            "--manifest-path",
            manifest,
        ])
        .output()
        .expect("cargo runs this test, so it can be run");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let metadata: Value =
        serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON");
    let text = |v: &Value| v.as_str().unwrap_or_default().to_owned();
    let packages = metadata["packages"].as_array().expect("a list of packages");
    packages
        .iter()
        .map(|p| {
            let normal = p["dependencies"]
                .as_array()
                .expect("a list")
                .iter()
                .filter(|d| d["kind"].is_null());
            (text(&p["name"]), normal.map(|d| text(&d["name"])).collect())
        })
        .collect()
}

#[test]
fn dependencies_only_point_down() {
    for (package, used) in dependencies() {
        let Some(name) = package.strip_prefix("maveric-") else {
            continue;
        };
        for other in used.iter().filter_map(|d| d.strip_prefix("maveric-")) {
            assert!(
                allowed(name).contains(&other),
                "`{name}` may not use `{other}`: see ARCHITECTURE.md"
            );
        }
    }
}

#[test]
fn heavy_dependencies_have_one_home() {
    for (package, used) in dependencies() {
        let Some(name) = package.strip_prefix("maveric-") else {
            continue;
        };
        for (heavy, homes) in HOMES {
            assert!(
                !used.iter().any(|d| d == heavy) || homes.contains(&name),
                "`{name}` may not name `{heavy}`"
            );
        }
    }
}

#[test]
fn all_twenty_one_packages_are_there() {
    let crates = dependencies()
        .into_keys()
        .filter(|n| n.starts_with("maveric-"))
        .count();
    assert_eq!(crates, 21);
}
