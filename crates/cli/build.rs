//! Which commit this is, for `maveric --version`.

use std::{path::Path, process::Command};

fn main() {
    let version = std::env::var("CARGO_PKG_VERSION").unwrap_or_default();
    // Only for a program that is handed out: otherwise each commit would compile the program and all its tests anew.
    let release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let commit = if release { packaged().or_else(checked_out) } else { None };
    let commit = commit.map_or_else(String::new, |commit| format!(" ({commit})"));
    println!("cargo::rustc-env=MAVERIC_VERSION={version}{commit}");
    println!("cargo::rerun-if-changed=build.rs");
}

/// The commit that a package of the registry was made from.
fn packaged() -> Option<String> {
    let text = std::fs::read_to_string(".cargo_vcs_info.json").ok()?;
    let hash = text.split("\"sha1\":").nth(1)?.split('"').nth(1)?;
    hash.get(..9).map(str::to_owned)
}

/// Commit and date of the checkout, with `+` where files differ from it.
fn checked_out() -> Option<String> {
    let head = git(&["rev-parse", "--git-path", "logs/HEAD"])?;
    if Path::new(&head).exists() {
        println!("cargo::rerun-if-changed={head}");
    }
    let commit = git(&["log", "-1", "--abbrev=9", "--format=%h, %cs"])?;
    let changed = git(&["status", "--porcelain", "--untracked-files=no"])?;
    let (hash, date) = commit.split_once(',')?;
    Some(format!("{hash}{},{date}", if changed.is_empty() { "" } else { "+" }))
}

fn git(words: &[&str]) -> Option<String> {
    let output = Command::new("git").args(words).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
