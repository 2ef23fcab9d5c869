//! A disk that fills up, where a file system of its own may be mounted.

use crate::support::TempStudy;
use crate::where_there::trial;
use libtest_mimic::Trial;
use std::{fmt::Write as _, path::Path, process::Command};

/// The test, if a disk can be made for it.
pub(crate) fn tests() -> Vec<Trial> {
    let mounted = on_small_disk(&TempStudy::new(), "16k", "true");
    let missing =
        mounted.is_none().then(|| "no file system of its own may be mounted here".to_owned());
    let name = "a_full_disk_is_an_error_that_says_so_and_leaves_nothing_half_written";
    vec![trial(name, missing, full_disk)]
}

/// What is in a folder, hidden files and those below included.
fn listed(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        found.push(path.display().to_string());
        found.extend(listed(&path));
    }
    found.sort();
    found
}

/// Runs a command line in a file system of `size` at `disk`, and lists what it left with what was said; `None` where no such disk may be made.
fn on_small_disk(study: &TempStudy, size: &str, command: &str) -> Option<(String, String)> {
    let script = format!(
        "mount -t tmpfs -o size={size} tmpfs disk || exit 77; mkdir disk/out; echo before > disk/out/kept.txt; \
         {command} 2>err.txt; echo status $?; find disk -type f | sort"
    );
    std::fs::create_dir_all(study.path("disk")).unwrap();
    let unshared = Command::new("unshare")
        .args(["-rm", "sh", "-c", &script])
        .current_dir(study.path("."))
        .output();
    let output = unshared.ok().filter(|o| o.status.code() == Some(0))?;
    let said = study.read("err.txt");
    Some((String::from_utf8_lossy(&output.stdout).into_owned(), said))
}

fn full_disk() {
    let study = TempStudy::new();
    let maveric = env!("CARGO_BIN_EXE_maveric");
    let rows = (0..600).fold(String::new(), |mut rows, i| {
        let t = f64::from(i) / 10.0;
        let _ = writeln!(rows, "{t},{},20,{},20,0,30", 20.0 * t, 20.0 * t + 34.7);
        rows
    });
    let table = "t,x_follower,v_follower,x_leader,v_leader,leader_length,spacing\n";
    study.write("oa_pair_r_f2_c.csv", format!("{table}{rows}"));
    let calls = [
        ("64k", "generate --learn 2 --test 1 --duration 60 --out disk/out/logs"),
        (
            "16k",
            "ingest oa_pair_r_f2_c.csv --mapping study_data/mappings/openacc.toml --out disk/out/drives",
        ),
        ("20k", "init disk/out/mine --conditions a,b"),
    ];
    for (size, call) in calls {
        let (left, said) = on_small_disk(&study, size, &format!("{maveric} {call}")).unwrap();
        assert!(said.contains("No space left on device"), "{call}: {said}");
        assert!(said.contains("disk/"), "{call} names no file: {said}");
        // What stands there is whole: what was begun is gone.
        assert!(left.starts_with("status 1\n") && left.contains("disk/out/kept.txt"), "{left}");
        assert!(!left.contains(".maveric") && !left.contains(".tmp"), "{left}");
    }
    assert!(listed(&study.path("disk")).is_empty(), "mounted over");
}
