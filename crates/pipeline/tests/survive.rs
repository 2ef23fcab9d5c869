//! After whatever happened to a run, the next one is right.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "the helpers of tests are tests, too")]

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

use maveric_pipeline::*;

/// Two chains that meet, of plain programs without a shell, some of which make directories.
const PIPELINE: &str = r#"
name = "kill"
[params]
line = 20
[[stage]]
name = "head"
cmd = ["cp", "source.txt", "out/a1"]
inputs = ["source.txt"]
outputs = ["out/a1"]
[[stage]]
name = "sort"
cmd = ["sort", "-r", "-o", "out/a2", "out/a1"]
inputs = ["out/a1"]
outputs = ["out/a2"]
[[stage]]
name = "split"
cmd = ["split", "-l", "{line}", "out/a1", "parts/p"]
inputs = ["out/a1"]
outputs = ["parts/paa", "parts/pab", "parts/pac"]
[[stage]]
name = "copy"
cmd = ["cp", "-r", "parts", "whole"]
inputs = ["parts"]
outputs = ["whole"]
[[stage]]
name = "each"
matrix = { part = ["paa", "pab", "pac"] }
cmd = ["sort", "-n", "-o", "each/{part}", "parts/{part}"]
inputs = ["parts/{part}"]
outputs = ["each/{part}"]
[[stage]]
name = "merge"
cmd = ["sort", "-m", "-o", "merged", "each/paa", "each/pab", "each/pac", "out/a2"]
inputs = ["each", "out/a2", "whole"]
outputs = ["merged"]
[[stage]]
name = "shard"
shards = 2
over = "whole/*"
cmd = ["sort", "-u", "-o", "shards/{shard}", "{files}", "out/a1"]
inputs = ["out/a1"]
outputs = ["shards/{shard}"]
"#;

/// Names the folder in which the test program itself is the run that is killed.
const CHILD: &str = "MAVERIC_PIPELINE_TEST_CHILD";

fn place(root: &Path) -> Place {
    Place {
        root: root.to_owned(),
        ledger: root.join("state/kill.lock"),
        log_dir: root.join("logs"),
        program: None,
    }
}

fn run_in(root: &Path, text: &str, line: u32) -> Result<RunReport, PipelineError> {
    let options = RunOptions { jobs: Some(2.try_into().unwrap()), ..RunOptions::default() };
    run_with(root, text, line, &options)
}

fn run_with(
    root: &Path,
    text: &str,
    line: u32,
    options: &RunOptions,
) -> Result<RunReport, PipelineError> {
    let settings =
        Settings { set: vec![("line".to_owned(), line.to_string())], ..Settings::default() };
    let pipeline = Pipeline::parse(text, Path::new("kill.toml"), root, &settings).unwrap();
    run(&pipeline, &place(root), options, &mut |_| {})
}

fn ran_in(root: &Path, line: u32) -> RunReport {
    let report = run_in(root, PIPELINE, line).unwrap();
    assert_eq!(report.outcome, Outcome::Done, "{:?}", report.failures);
    report
}

fn project() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let lines: Vec<String> = (0..50).map(|i| (i * 37 % 101).to_string()).collect();
    let text = lines.join("\n") + "\n";
    fs::write(folder.path().join("source.txt"), text).unwrap();
    folder
}

/// Every file that is no run's own, by its path below the root.
fn files(root: &Path) -> BTreeMap<String, Vec<u8>> {
    fn add(folder: &Path, root: &Path, files: &mut BTreeMap<String, Vec<u8>>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(root).unwrap().to_str().unwrap().to_owned();
            let is_apart = name == "state" || name == "logs" || name.starts_with("moved-aside-");
            if is_apart || path.is_symlink() {
            } else if path.is_dir() {
                add(&path, root, files);
            } else {
                files.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    let mut found = BTreeMap::new();
    add(root, root, &mut found);
    found
}

/// What each stage was made from and has made, without times.
fn made(root: &Path) -> BTreeMap<String, (String, BTreeMap<String, String>)> {
    let ledger = Ledger::read(&place(root).ledger, "kill").unwrap();
    assert!(ledger.left.is_empty());
    let entry = |record: Record| (record.stage, (record.digest, record.outputs));
    ledger.run.into_values().map(entry).collect()
}

/// A generator of our own: the moments must be the same in every run of the test.
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    *state >> 33
}

/// Not a test by itself: the run that the next test kills, as a process of its own.
#[test]
fn child() {
    if let Some(root) = std::env::var_os(CHILD) {
        let (root, line) = (Path::new(&root), std::env::var("LINE").unwrap());
        run_in(root, PIPELINE, line.parse().unwrap()).unwrap();
    }
}

fn start(root: &Path, line: u32) -> std::process::Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "child"])
        .env(CHILD, root)
        .env("LINE", line.to_string())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn a_run_killed_at_fifty_random_moments_ends_with_the_bytes_of_an_undisturbed_one() {
    let undisturbed = [20, 21].map(|line| {
        let folder = project();
        ran_in(folder.path(), line);
        (files(folder.path()), made(folder.path()))
    });
    assert_eq!(undisturbed[0].0.len(), 15);
    let whole_run = (0..3).map(|_| {
        let folder = project();
        let started = Instant::now();
        assert!(start(folder.path(), 20).wait().unwrap().success());
        started.elapsed()
    });
    let whole_run = whole_run.min().unwrap();
    let mut state = 7;
    let (mut killed, mut midway) = (0, 0);
    let folder = project();
    for round in 0..50_u32 {
        // Another parameter each time, so that there is always something to do.
        let line = 20 + round % 2;
        let mut child = start(folder.path(), line);
        let moment = next(&mut state) % 1_000;
        std::thread::sleep(whole_run.mul_f64(moment as f64 / 1_000.0));
        child.kill().unwrap();
        killed += u32::from(!child.wait().unwrap().success());
        midway += u32::from(folder.path().join("state/kill.lock.journal").exists());
        let report = ran_in(folder.path(), line);
        let expected = &undisturbed[usize::try_from(round % 2).unwrap()];
        assert!(files(folder.path()) == expected.0, "round {round}");
        assert!(made(folder.path()) == expected.1, "round {round}");
        let usual = |w: &Warning| matches!(w, Warning::Replaced { .. } | Warning::CutOff { .. });
        assert!(report.warnings.iter().all(usual), "{:?}", report.warnings);
    }
    eprintln!("{killed} of 50 were killed before their end, {midway} in the middle of stages");
    assert!(killed > 10 && midway > 3, "{killed} {midway}");
    let state: Vec<_> = fs::read_dir(folder.path().join("state")).unwrap().collect();
    assert!(state.len() <= 4, "nothing is left behind: {state:?}");
}

#[test]
fn a_full_disk_ends_a_run_and_the_next_one_is_right() {
    let expected = project();
    ran_in(expected.path(), 20);
    for full in ["state/kill.lock.journal", "logs/sort.log"] {
        let folder = project();
        let path = folder.path().join(full);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        symlink("/dev/full", &path).unwrap();
        let error = run_in(folder.path(), PIPELINE, 20).unwrap_err();
        let error = std::error::Error::source(&error).unwrap().to_string();
        assert!(error.contains("No space left"), "{full}: {error}");
        fs::remove_file(&path).unwrap();
        ran_in(folder.path(), 20);
        assert!(files(folder.path()) == files(expected.path()), "{full}");
        assert!(made(folder.path()) == made(expected.path()), "{full}");
    }
}

#[test]
fn a_stage_that_cannot_write_all_of_its_file_fails_and_runs_again() {
    let folder = project();
    let text = "name = 'kill'\n[params]\nline = 1\n[[stage]]\nname = 'a'\noutputs = ['o']\n\
                cmd = ['sh', '-c', 'printf half > o; cat source.txt > target && printf all > o']\n";
    symlink("/dev/full", folder.path().join("target")).unwrap();
    let report = run_in(folder.path(), text, 1).unwrap();
    assert_eq!(report.outcome, Outcome::Failed);
    assert_eq!(files(folder.path())["o"], b"half");
    fs::remove_file(folder.path().join("target")).unwrap();
    let report = run_in(folder.path(), text, 1).unwrap();
    assert_eq!(report.outcome, Outcome::Done);
    assert_eq!(files(folder.path())["o"], b"all");
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

#[test]
fn a_clock_that_was_wrong_neither_hides_a_change_nor_makes_one() {
    let folder = project();
    let source = folder.path().join("source.txt");
    let set = |time| fs::File::options().write(true).open(&source).unwrap().set_modified(time);
    let day = Duration::from_hours(24);
    let ran = |report: RunReport| report.stages.iter().filter(|s| s.state == State::Done).count();
    assert_eq!(ran(ran_in(folder.path(), 20)), 10);
    for time in [SystemTime::UNIX_EPOCH + day, SystemTime::now() + 400 * day] {
        set(time).unwrap();
        assert_eq!(ran(ran_in(folder.path(), 20)), 0);
        let longer = fs::read_to_string(&source).unwrap().replacen("37\n", "38\n", 1);
        fs::write(&source, &longer).unwrap();
        set(time).unwrap();
        assert!(ran(ran_in(folder.path(), 20)) > 0, "same size and time, other content");
        fs::write(&source, longer.replacen("38\n", "37\n", 1)).unwrap();
        set(time).unwrap();
        assert!(ran(ran_in(folder.path(), 20)) > 0);
    }
}

#[test]
fn a_ledger_that_was_deleted_or_put_back_is_believed_over_a_journal() {
    let folder = project();
    ran_in(folder.path(), 20);
    let ledger = place(folder.path()).ledger;
    let journal = folder.path().join("state/kill.lock.journal");
    let mut child = start(folder.path(), 21);
    while !journal.exists() && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    child.kill().unwrap();
    child.wait().unwrap();
    fs::remove_file(&ledger).unwrap();
    // Nobody knows any more who made what is there: it stays, and is put aside if that is asked for.
    let report = run_in(folder.path(), PIPELINE, 20).unwrap();
    assert_eq!(report.outcome, Outcome::Failed);
    let aside = RunOptions { move_aside: true, ..RunOptions::default() };
    let report = run_with(folder.path(), PIPELINE, 20, &aside).unwrap();
    assert!(report.stages.iter().all(|s| s.state == State::Done));
}
