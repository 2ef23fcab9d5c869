//! Runs on a cluster that is played by scripts: `sbatch`, `squeue` and `hq` of our own.
#![cfg(unix)]
#![expect(clippy::unwrap_used, clippy::panic, reason = "the helpers of tests are tests, too")]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use maveric_pipeline::*;

/// Starts each task of an array in the background once its jobs are done, as Slurm would; a
/// task is in the queue as long as its file is in `$FAKE/queue`.
const SBATCH: &str = r#"#!/bin/sh
after=
for word in "$@"; do
  case "$word" in
    --array=*) last=${word#--array=0-}; last=${last%%%*} ;;
    --dependency=*) echo "$word" >>"$FAKE/options"; after=$(echo "${word#--dependency=}" | tr , ' ') ;;
    --*) echo "$word" >>"$FAKE/options" ;;
    *) script=$word ;;
  esac
done
while ! mkdir "$FAKE/lock" 2>/dev/null; do sleep 0.01; done
job=$(($(cat "$FAKE/last" 2>/dev/null || echo 0) + 1)); echo $job >"$FAKE/last"
rmdir "$FAKE/lock"
for i in $(seq 0 "$last"); do touch "$FAKE/queue/${job}_$i"; done
for i in $(seq 0 "$last"); do
  ( for other in $after; do
      case $other in aftercorr:*) other=${other#aftercorr:}_$i ;; *) other=${other#afterok:}_ ;; esac
      while ls "$FAKE/queue/${other}"* >/dev/null 2>&1; do sleep 0.02; done
      if ls "$FAKE/failed/${other}"* >/dev/null 2>&1; then
        touch "$FAKE/failed/${job}_$i"; rm "$FAKE/queue/${job}_$i"; exit; fi
    done
    while [ -e "$FAKE/hold" ]; do sleep 0.02; done
    if [ -e "$FAKE/lose" ]; then rm "$FAKE/lose"; touch "$FAKE/failed/${job}_$i"
    else SLURM_ARRAY_TASK_ID=$i sh "$script" || touch "$FAKE/failed/${job}_$i"; fi
    rm "$FAKE/queue/${job}_$i"
  ) >/dev/null 2>&1 &
done
echo $job
"#;
const SQUEUE: &str = "#!/bin/sh\nls \"$FAKE/queue\" | sed 's/$/ R/'\n";
const SCANCEL: &str = "#!/bin/sh\nrm -f \"$FAKE/queue/${1}_\"*\n";
/// Runs the tasks of a job file one after the other: their numbers are in order.
const HQ: &str = r#"#!/bin/sh
case "$*" in
  *submit-file*) for plan in "$@"; do :; done
    cp "$plan" "$FAKE/plan.toml"
    ( sed -n 's/^command = \["\/bin\/sh", "\(.*\)"\]$/\1/p' "$plan" | while read -r script; do
        sh "$script"; done; touch "$FAKE/over" ) >/dev/null 2>&1 &
    echo '{"id": 5}' ;;
  *"job info"*) [ -e "$FAKE/over" ] && state=finished || state=running
    echo "[{\"id\": 5, \"tasks\": [{\"id\": 0, \"state\": \"$state\"}, {\"id\": 1, \"state\": \"$state\"}]}]" ;;
esac
"#;

const PIPELINE: &str = r#"
name = "test"
[params]
word = "end"
[[stage]]
name = "source"
cmd = ["sh", "-c", "for i in 1 2 3 4 5 6 7 8; do echo $i > parts/$i.txt; done; ls"]
outputs = ["parts/1.txt", "parts/2.txt", "parts/3.txt", "parts/4.txt", "parts/5.txt", "parts/6.txt", "parts/7.txt", "parts/8.txt"]
[[stage]]
name = "each"
matrix = { part = [1, 2, 3] }
cmd = ["sh", "-c", "cat parts/{part}.txt hidden 2>/dev/null > each/{part}; sleep 0.1; echo {word} >> each/{part}"]
inputs = ["parts/{part}.txt"]
outputs = ["each/{part}"]
resources = { cpus = 1, minutes = 5 }
[[stage]]
name = "shard"
shards = 2
over = "parts/*.txt"
cmd = ["sort", "-o", "shards/{shard}", "{files}", "/dev/null"]
outputs = ["shards/{shard}"]
[[stage]]
name = "all"
cmd = ["sh", "-c", "cat each/* shards/* > all/sum; test -e ../hidden || true; cat ../outside.txt; echo problem >&2"]
inputs = ["each", "shards", "../outside.txt"]
outputs = ["all"]
summary = true
"#;

const CHILD: &str = "MAVERIC_PIPELINE_TEST_CLUSTER";

/// A project in a folder in a folder, and beside it a cluster.
fn project(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for made in ["p", "bin", "fake/queue", "fake/failed"] {
        fs::create_dir_all(path.join(made)).unwrap();
    }
    for (name, text) in [("sbatch", SBATCH), ("squeue", SQUEUE), ("scancel", SCANCEL), ("hq", HQ)] {
        let program = path.join("bin").join(name);
        fs::write(&program, text).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    }
    fs::write(path.join("outside.txt"), "outside\n").unwrap();
    fs::write(path.join("p/hidden"), "undeclared\n").unwrap();
    fs::write(path.join("p/p.toml"), text.replace("all/sum", "all")).unwrap();
    folder
}

fn run_with(folder: &Path, executor: Executor, word: &str) -> Result<RunReport, PipelineError> {
    let root = folder.join("p");
    let settings =
        Settings { set: vec![("word".to_owned(), word.to_owned())], ..Settings::default() };
    let pipeline = Pipeline::read(&root.join("p.toml"), &root, &settings).unwrap();
    let place =
        Place { ledger: root.join("p.lock"), log_dir: root.join(".logs"), program: None, root };
    let options =
        RunOptions { executor, lost_after: Duration::from_secs(2), ..RunOptions::default() };
    run(&pipeline, &place, &options, &mut |event| {
        eprintln!("{event:?}");
    })
}

/// Not a test by itself: a run whose PATH has the cluster's programs.
#[test]
fn child() {
    if let Some(folder) = std::env::var_os(CHILD) {
        let executor = match std::env::var("EXECUTOR").unwrap().as_str() {
            "slurm" => Executor::Slurm,
            "hq" => Executor::HyperQueue,
            _ => Executor::Local,
        };
        let word = std::env::var("WORD").unwrap();
        let text = match run_with(Path::new(&folder), executor, &word) {
            Ok(report) => serde_json::to_string(&report).unwrap(),
            Err(error) => serde_json::json!({ "error": error.to_string() }).to_string(),
        };
        fs::write(Path::new(&folder).join("report.json"), text).unwrap();
    }
}

fn start(folder: &Path, executor: &str, word: &str) -> Child {
    let path = std::env::var("PATH").unwrap();
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "child", "--nocapture"])
        .env("PATH", format!("{}:{path}", folder.join("bin").display()))
        .env("FAKE", folder.join("fake"))
        .envs([("EXECUTOR", executor), ("WORD", word)])
        .env(CHILD, folder)
        .stdout(Stdio::null())
        .stderr(fs::File::create(folder.join("heard")).unwrap())
        .spawn()
        .unwrap()
}

fn report(folder: &Path, executor: &str, word: &str) -> serde_json::Value {
    let _ = fs::remove_file(folder.join("report.json"));
    start(folder, executor, word).wait().unwrap();
    let text = fs::read_to_string(folder.join("report.json"));
    let heard = || fs::read_to_string(folder.join("heard")).unwrap();
    serde_json::from_str(&text.unwrap_or_else(|_| panic!("{}", heard()))).unwrap()
}

type Texts = Vec<(String, String)>;

fn made(folder: &Path) -> Texts {
    let files = ["each/1", "each/2", "each/3", "shards/0", "shards/1", "all", "parts/8.txt"];
    let read = |file: &str| fs::read_to_string(folder.join("p").join(file)).unwrap();
    files.map(|file| (file.to_owned(), read(file))).into()
}

fn digests(folder: &Path) -> Texts {
    let ledger = Ledger::read(&folder.join("p/p.lock"), "test").unwrap();
    let digest = |record: Record| (record.stage, record.digest);
    ledger.run.into_values().map(digest).collect()
}

fn expected(word: &str) -> (Texts, Texts) {
    // A local run sees undeclared files: take them away to have what a cluster must make.
    let folder = project(PIPELINE);
    fs::remove_file(folder.path().join("p/hidden")).unwrap();
    assert_eq!(report(folder.path(), "local", word)["outcome"], "done");
    (made(folder.path()), digests(folder.path()))
}

#[test]
fn a_cluster_makes_what_a_local_run_makes_and_a_killed_follower_is_resumed() {
    let folder = project(PIPELINE);
    let path = folder.path();
    let ran = report(path, "slurm", "end");
    assert_eq!(ran["outcome"], "done", "{ran}");
    assert_eq!(ran["summaries"][0]["text"], "outside\n");
    assert_eq!((made(path), digests(path)), expected("end"));
    assert_eq!(fs::read_to_string(path.join("fake/last")).unwrap(), "4\n");
    let options = fs::read_to_string(path.join("fake/options")).unwrap();
    assert!(options.contains("--time=5") && options.contains("--job-name=test.each"));
    let log = fs::read_to_string(path.join("p/.logs/all.log")).unwrap();
    assert!(log.contains("problem"));
    assert!(!path.join("p/p.lock.jobs").exists() && !path.join("p/.logs/.cluster").exists());
    let again = report(path, "slurm", "end");
    let stages = again["stages"].as_array().unwrap();
    assert!(stages.iter().all(|stage| stage["state"] == "up_to_date"), "{again}");

    // Another word: the three of `each` and `all` are handed in; then the follower dies.
    fs::write(path.join("fake/hold"), "").unwrap();
    let mut follower = start(path, "slurm", "fin");
    let noted = || fs::read_to_string(path.join("p/p.lock.jobs")).unwrap_or_default();
    while !(noted().contains("\"5\"") && noted().contains("\"6\"")) {
        assert!(follower.try_wait().unwrap().is_none(), "it follows");
        std::thread::sleep(Duration::from_millis(5));
    }
    follower.kill().unwrap();
    follower.wait().unwrap();
    let local = report(path, "local", "fin");
    let refused = local["error"].as_str().unwrap();
    assert!(refused.contains("4 stages of this pipeline are still on the cluster (slurm)"));
    fs::remove_file(path.join("fake/hold")).unwrap();
    let resumed = report(path, "slurm", "fin");
    assert_eq!(resumed["outcome"], "done", "{resumed}");
    assert_eq!((made(path), digests(path)), expected("fin"));
    assert_eq!(fs::read_to_string(path.join("fake/last")).unwrap(), "6\n", "nothing ran twice");
}

#[test]
fn a_lost_and_a_failed_task_are_told_and_run_again() {
    let folder = project(PIPELINE);
    let path = folder.path();
    fs::write(path.join("fake/lose"), "").unwrap();
    let lost = report(path, "slurm", "end");
    let cause = &lost["failures"][0]["cause"];
    assert_eq!((&cause["kind"], &cause["job"]), (&"job_lost".into(), &"1_0".into()), "{lost}");
    let bad = PIPELINE.replace("echo {word} >>", "[ {part} = 2 ] && exit 3; echo {word} >>");
    fs::write(path.join("p/p.toml"), bad.replace("all/sum", "all")).unwrap();
    let failed = report(path, "slurm", "end");
    assert_eq!(failed["failures"][0]["stage"], "each.2", "{failed}");
    assert_eq!(failed["failures"][0]["cause"]["code"], 3);
    fs::write(path.join("p/p.toml"), PIPELINE.replace("all/sum", "all")).unwrap();
    let ran = report(path, "slurm", "end");
    assert_eq!(ran["outcome"], "done", "{ran}");
    assert_eq!((made(path), digests(path)), expected("end"));
}

#[test]
fn hyperqueue_gets_the_same_tasks() {
    let text = PIPELINE.split("[[stage]]").take(2).collect::<Vec<_>>().join("[[stage]]");
    let more = "[[stage]]\nname = 'copy'\ninputs = ['parts']\noutputs = ['copy']\n\
                cmd = ['cp', '-r', 'parts', 'copy']\n";
    let folder = project(&format!("{text}{more}"));
    let ran = report(folder.path(), "hq", "end");
    assert_eq!(ran["outcome"], "done", "{ran}");
    assert_eq!(fs::read_to_string(folder.path().join("p/copy/3.txt")).unwrap(), "3\n");
    let plan = fs::read_to_string(folder.path().join("fake/plan.toml")).unwrap();
    let plan: toml::Value = toml::from_str(&plan).unwrap();
    assert_eq!(plan["task"][1]["deps"][0].as_integer(), Some(0));
}

#[test]
fn a_step_of_a_fan_out_waits_for_its_own_step_before_and_for_no_other() {
    let text = "name = 'test'\n[params]\nword = 'x'\n\
                [[stage]]\nname = 'first'\nmatrix = { i = [1, 2, 3] }\noutputs = ['first/{i}']\n\
                cmd = ['sh', '-c', 'echo {i}{word} > first/{i}']\n\
                [[stage]]\nname = 'second'\nmatrix = { i = [1, 2, 3] }\ninputs = ['first/{i}']\n\
                cmd = ['cp', 'first/{i}', 'second/{i}']\noutputs = ['second/{i}']\n";
    let folder = project(text);
    let ran = report(folder.path(), "slurm", "y");
    assert_eq!(ran["outcome"], "done", "{ran}");
    let made = fs::read_to_string(folder.path().join("p/second/3")).unwrap();
    assert_eq!(made, "3y\n");
    let options = fs::read_to_string(folder.path().join("fake/options")).unwrap();
    assert!(options.contains("--dependency=aftercorr:1\n"), "{options}");
}

#[test]
fn a_file_that_no_run_made_is_not_handed_to_a_cluster() {
    let folder = project(PIPELINE);
    let path = folder.path();
    fs::create_dir_all(path.join("p/parts")).unwrap();
    fs::write(path.join("p/parts/1.txt"), "mine").unwrap();
    let ran = report(path, "slurm", "end");
    assert_eq!(ran["failures"][0]["cause"]["kind"], "foreign", "{ran}");
    assert_eq!(fs::read_to_string(path.join("p/parts/1.txt")).unwrap(), "mine");
}

/// A source, a copy of it with a word, and a copy of that.
const COPIES: &str = "name = 'test'\n[params]\nword = 'x'\n\
                      [[stage]]\nname = 'a'\ninputs = ['in.txt']\noutputs = ['a.txt']\n\
                      cmd = ['sh', '-c', 'cat in.txt > a.txt; echo {word} >> a.txt']\n\
                      [[stage]]\nname = 'b'\ninputs = ['a.txt']\noutputs = ['b.txt']\n\
                      cmd = ['cp', 'a.txt', 'b.txt']\n";

/// The project with a run whose two jobs have been accepted and wait.
fn waiting() -> (tempfile::TempDir, Child) {
    waiting_with(COPIES, 2)
}

/// The same of another pipeline, with so many jobs.
fn waiting_with(text: &str, jobs: u32) -> (tempfile::TempDir, Child) {
    let folder = project(text);
    let path = folder.path();
    fs::write(path.join("p/in.txt"), "1\n").unwrap();
    fs::create_dir(path.join("p/data")).unwrap();
    fs::write(path.join("p/data/1.txt"), "1\n").unwrap();
    let last = format!("\"job\":\"{jobs}\",\"numbered\"");
    fs::write(path.join("fake/hold"), "").unwrap();
    let mut follower = start(path, "slurm", "w");
    let noted = || fs::read_to_string(path.join("p/p.lock.jobs")).unwrap_or_default();
    while !noted().contains(&last) {
        assert!(follower.try_wait().unwrap().is_none(), "it follows");
        std::thread::sleep(Duration::from_millis(5));
    }
    (folder, follower)
}

/// Lets the jobs run to their ends while nobody follows.
fn run_unwatched(folder: &Path, mut follower: Child) {
    follower.kill().unwrap();
    follower.wait().unwrap();
    fs::remove_file(folder.join("fake/hold")).unwrap();
    while fs::read_dir(folder.join("fake/queue")).unwrap().count() > 0 {
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn told(folder: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(folder.join("report.json")).unwrap()).unwrap()
}

#[test]
fn what_ended_unwatched_is_taken_over_unless_it_was_edited_since() {
    for edited in [false, true] {
        let (folder, follower) = waiting();
        let path = folder.path();
        run_unwatched(path, follower);
        if edited {
            fs::write(path.join("p/b.txt"), "1\nw\nby hand\n").unwrap();
            let failed = report(path, "slurm", "w");
            let failures = failed["failures"].as_array().unwrap();
            assert_eq!(failures.len(), 1, "{failed}");
            assert_eq!(failures[0]["cause"]["kind"], "outputs_changed");
        }
        let ran = report(path, "slurm", "w");
        assert_eq!(ran["outcome"], "done", "{ran}");
        let made = fs::read_to_string(path.join("p/b.txt")).unwrap();
        assert_eq!(made, "1\nw\n");
        let last = fs::read_to_string(path.join("fake/last")).unwrap();
        assert_eq!(last, if edited { "3\n" } else { "2\n" });
    }
}

#[test]
fn jobs_that_wait_for_one_that_is_taken_back_are_taken_back_too() {
    let (folder, follower) = waiting();
    let path = folder.path();
    fs::write(path.join("p/in.txt"), "2\n").unwrap();
    run_unwatched(path, follower);
    let ran = report(path, "slurm", "w");
    assert_eq!(ran["outcome"], "done", "{ran}");
    let made = fs::read_to_string(path.join("p/b.txt")).unwrap();
    assert_eq!(made, "2\nw\n");
    assert_eq!(fs::read_to_string(path.join("fake/last")).unwrap(), "4\n");
}

#[test]
fn a_source_that_changes_while_its_job_waits_is_recorded_under_neither_content() {
    let (folder, mut follower) = waiting();
    let path = folder.path();
    fs::write(path.join("p/in.txt"), "2\n").unwrap();
    fs::remove_file(path.join("fake/hold")).unwrap();
    follower.wait().unwrap();
    let failed = told(path);
    let cause = &failed["failures"][0]["cause"];
    assert_eq!(cause["kind"], "inputs_changed", "{failed}");
    assert_eq!(cause["paths"][0], "in.txt");
    fs::write(path.join("p/in.txt"), "1\n").unwrap();
    let ran = report(path, "slurm", "w");
    assert_eq!(ran["outcome"], "done", "{ran}");
    let made = fs::read_to_string(path.join("p/b.txt")).unwrap();
    assert_eq!(made, "1\nw\n");
}

#[test]
fn a_file_that_came_while_a_job_waited_is_told_and_stays_at_the_next_run_too() {
    let (folder, mut follower) = waiting();
    let path = folder.path();
    fs::write(path.join("p/a.txt"), "mine").unwrap();
    fs::remove_file(path.join("fake/hold")).unwrap();
    follower.wait().unwrap();
    for failed in [told(path), report(path, "slurm", "w")] {
        let failure = &failed["failures"][0];
        assert_eq!(failure["cause"]["kind"], "foreign", "{failed}");
        assert_eq!(failed["stages"][1]["state"], "wanted", "{failed}");
        assert!(failure["repeat"].is_null(), "{failed}");
        let mine = fs::read_to_string(path.join("p/a.txt")).unwrap();
        assert_eq!(mine, "mine");
    }
    fs::remove_file(path.join("p/a.txt")).unwrap();
    let ran = report(path, "slurm", "w");
    assert_eq!(ran["outcome"], "done", "{ran}");
}

#[test]
fn a_file_that_comes_while_a_shard_waits_is_not_taken_for_read() {
    let text = "name = 'test'\n[params]\nword = 'x'\n[[stage]]\nname = 'a'\nshards = 1\n\
                over = 'data/*.txt'\ncmd = ['sort', '-o', 'all.txt', '{files}']\n\
                outputs = ['all.txt']\n";
    let (folder, mut follower) = waiting_with(text, 1);
    let path = folder.path();
    fs::write(path.join("p/data/2.txt"), "2\n").unwrap();
    fs::remove_file(path.join("fake/hold")).unwrap();
    follower.wait().unwrap();
    let failed = told(path);
    let cause = &failed["failures"][0]["cause"];
    assert_eq!(cause["kind"], "inputs_changed", "{failed}");
    assert_eq!(cause["paths"][0], "data/2.txt");
    let ran = report(path, "slurm", "w");
    assert_eq!(ran["outcome"], "done", "{ran}");
    let made = fs::read_to_string(path.join("p/all.txt")).unwrap();
    assert_eq!(made, "1\n2\n");
}

#[test]
fn a_file_that_came_while_a_job_waited_stays_however_the_job_ended() {
    let lose = |path: &Path| fs::write(path.join("fake/lose"), "").unwrap();
    for (end, next) in [("lost", "slurm"), ("lost unwatched", "local"), ("taken back", "slurm")] {
        let (folder, mut follower) = waiting();
        let path = folder.path();
        fs::write(path.join("p/a.txt"), "mine").unwrap();
        match end {
            "lost" => {
                lose(path);
                fs::remove_file(path.join("fake/hold")).unwrap();
                follower.wait().unwrap();
                let failed = told(path);
                assert_eq!(failed["failures"][0]["cause"]["kind"], "job_lost", "{failed}");
            }
            "lost unwatched" => {
                lose(path);
                run_unwatched(path, follower);
            }
            _ => {
                follower.kill().unwrap();
                follower.wait().unwrap();
                fs::write(path.join("p/in.txt"), "2\n").unwrap();
            }
        }
        for _ in 0..2 {
            let failed = report(path, next, "w");
            let cause = &failed["failures"][0]["cause"];
            assert_eq!(cause["kind"], "foreign", "{end}: {failed}");
            let mine = fs::read_to_string(path.join("p/a.txt")).unwrap();
            assert_eq!(mine, "mine", "{end}");
        }
    }
}

#[test]
fn what_a_job_put_in_place_before_it_was_given_up_is_made_again_without_a_word() {
    let (folder, follower) = waiting();
    let path = folder.path();
    run_unwatched(path, follower);
    fs::write(path.join("p/in.txt"), "2\n").unwrap();
    let ran = report(path, "local", "w");
    assert_eq!(ran["outcome"], "done", "{ran}");
    assert_eq!(ran["warnings"].as_array().unwrap().len(), 0, "{ran}");
    let made = fs::read_to_string(path.join("p/b.txt")).unwrap();
    assert_eq!(made, "2\nw\n");
}

#[test]
fn a_file_that_is_put_into_a_folder_after_its_job_has_ended_is_moved_aside() {
    let text = "name = 'test'\n[params]\nword = 'x'\n[[stage]]\nname = 'a'\n\
                inputs = ['in.txt']\noutputs = ['out']\n\
                cmd = ['sh', '-c', 'mkdir out; cp in.txt out/a.txt']\n";
    let (folder, follower) = waiting_with(text, 1);
    let path = folder.path();
    run_unwatched(path, follower);
    fs::write(path.join("p/out/notes.md"), "mine").unwrap();
    let failed = report(path, "slurm", "w");
    let cause = &failed["failures"][0]["cause"];
    assert_eq!(cause["kind"], "outputs_changed", "{failed}");
    let ran = report(path, "slurm", "w");
    assert_eq!(ran["outcome"], "done", "{ran}");
    let aside = ran["warnings"][0]["folders"][0].as_str().unwrap();
    let moved = path.join("p").join(aside).join("out/notes.md");
    assert_eq!(fs::read_to_string(moved).unwrap(), "mine");
    assert!(!path.join("p/out/notes.md").exists());
}

#[test]
fn outputs_that_are_links_are_as_the_job_made_them() {
    let text = "name = 'test'\n[params]\nword = 'x'\n[[stage]]\nname = 'a'\n\
                inputs = ['in.txt']\noutputs = ['out', 'latest', 'latest.txt']\n\
                cmd = ['sh', '-c', 'mkdir out; cp in.txt out/a.txt; \
                ln -s out latest; ln -s out/a.txt latest.txt']\n";
    let folder = project(text);
    let path = folder.path();
    fs::write(path.join("p/in.txt"), "1\n").unwrap();
    for state in ["done", "up_to_date"] {
        let ran = report(path, "slurm", "w");
        assert_eq!(ran["stages"][0]["state"], state, "{ran}");
    }
    assert!(path.join("p/latest").is_symlink());
}

#[test]
fn of_several_outputs_those_in_the_way_are_named() {
    let text = "name = 'test'\n[params]\nword = 'x'\n[[stage]]\nname = 'a'\n\
                outputs = ['a.txt', 'out']\ncmd = ['sh', '-c', 'echo 1 > a.txt; mkdir out']\n";
    let (folder, mut follower) = waiting_with(text, 1);
    let path = folder.path();
    fs::write(path.join("p/a.txt"), "mine").unwrap();
    fs::create_dir(path.join("disk")).unwrap();
    std::os::unix::fs::symlink("../disk", path.join("p/out")).unwrap();
    fs::remove_file(path.join("fake/hold")).unwrap();
    follower.wait().unwrap();
    let failed = told(path);
    let cause = &failed["failures"][0]["cause"];
    assert_eq!(cause["kind"], "foreign", "{failed}");
    assert_eq!(cause["paths"], serde_json::json!(["a.txt"]), "{failed}");
}
