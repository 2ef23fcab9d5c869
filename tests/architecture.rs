//! The dependency graph of ARCHITECTURE.md, read from `cargo metadata`; and what every system computes and prints alike.

#![allow(clippy::panic, reason = "a test stops at the first surprise")]

use serde_json::Value;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::Command,
};

/// What each crate may use of the project.
fn allowed(name: &str) -> Vec<&'static str> {
    let crates = match name {
        "data" | "domain" | "stats" | "pipeline" | "laws" | "bag" => "",
        "measures" | "model" | "participants" => "domain",
        "ingest" => "data domain bag",
        "report" => "domain stats",
        // What judges cannot read what answered.
        "analysis" => "domain stats measures",
        "following" | "simulator" => "domain laws",
        "steering" => "domain model simulator",
        "rehearsal" => "domain stats analysis measures participants",
        // Words alone: what was decided comes from below.
        "pages" => "domain stats measures report analysis following rehearsal",
        "study" => {
            "data domain stats pages pipeline report rehearsal analysis following steering \
             ingest measures model simulator participants"
        }
        // What runs in a page knows no file and no study.
        "seat-page" => "domain measures model simulator steering",
        "seat" => "bag domain ingest model seat-page simulator study",
        "cli" => "domain seat study pipeline",
        // A leaf: nothing depends on it.
        "python" => {
            "cli data study report steering domain stats analysis following laws bag \
             ingest measures model simulator participants"
        }
        other => panic!("crate `{other}` has no floor in ARCHITECTURE.md: give it one"),
    };
    crates.split_whitespace().collect()
}

/// Heavy dependencies and the crates that may name them.
const HOMES: [(&str, &[&str]); 17] = [
    ("pyo3", &["python"]),
    ("calamine", &["study"]),
    ("encoding_rs", &["study"]),
    ("polars", &["ingest", "study"]),
    ("polars-io", &["ingest", "study"]),
    ("mcap", &["bag"]),
    ("plotters", &["report"]),
    ("docx-rs", &["pages"]),
    ("resvg", &["report"]),
    ("pulp", &["model", "following"]),
    ("clap", &["study", "cli"]),
    ("miette", &["cli"]),
    ("schemars", &["domain"]),
    ("statrs", &["stats", "model"]),
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
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
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
fn all_twenty_two_packages_are_there() {
    let crates = dependencies().into_keys().filter(|n| n.starts_with("maveric-")).count();
    assert_eq!(crates, 22);
}

/// What the system's own library computes, in other last digits on each system: `libm` has them all.
const OF_THE_SYSTEM: &str = "exp exp2 exp_m1 ln ln_1p log2 log10 powf sin cos tan sin_cos sinh cosh tanh asin acos atan atan2 asinh acosh \
                             atanh hypot cbrt";

/// Files of code below a folder that are no tests.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        if name == "tests" || name == "testing" {
            continue;
        }
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn every_system_gives_the_same_bytes_and_the_same_messages() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut files = Vec::new();
    for entry in std::fs::read_dir(root.join("crates")).expect("the crates") {
        sources(&entry.expect("an entry").path().join("src"), &mut files);
    }
    assert!(files.len() > 300, "{} files", files.len());
    let mut wrong = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a source file is text");
        let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
        let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        for (number, line) in lines.enumerate() {
            let calls = |name: &str| {
                line.contains(&format!(".{name}(")) || line.contains(&format!("f64::{name}"))
            };
            let said = if OF_THE_SYSTEM.split_whitespace().any(calls) {
                "write libm::…"
            } else if line.contains(".display()") {
                "prints `\\` on Windows: write path_slash's .to_slash_lossy()"
            } else {
                continue;
            };
            wrong.push(format!(
                "{}, code line {}: {said}: {}",
                file.to_string_lossy(),
                number + 1,
                line.trim()
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
