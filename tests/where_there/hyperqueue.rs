//! A real HyperQueue, where `hq` is on the PATH: the small study on two workers, one of which is killed while it works; and many
//! tasks, as many as `MAVERIC_HQ_TASKS` says.

use crate::support::{Ran, TempStudy, files};
use crate::where_there::{runs, trial};
use libtest_mimic::Trial;
use std::{
    collections::BTreeMap,
    path::Path,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

/// The tests, with the program that they need.
pub(crate) fn tests() -> Vec<Trial> {
    let killed = "the_small_study_comes_out_the_same_when_a_worker_is_killed_at_work";
    let many = "every_one_of_many_tasks_makes_its_own_and_none_is_left_to_do";
    vec![trial(killed, runs("hq").err(), killed_at_work), trial(many, runs("hq").err(), many_tasks)]
}

/// A server and its workers, which end with it.
struct Cluster {
    folder: tempfile::TempDir,
    server: Child,
    workers: Vec<Child>,
}

impl Cluster {
    fn start(workers: usize) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let server = started(folder.path(), &["server", "start", "--host", "localhost"]);
        let until = Instant::now() + Duration::from_secs(30);
        while !folder.path().join("hq-current/access.json").exists() {
            assert!(Instant::now() < until, "the server does not start");
            std::thread::sleep(Duration::from_millis(50));
        }
        let worker = ["worker", "start", "--cpus", "1", "--heartbeat", "1s"];
        let workers = (0..workers).map(|_| started(folder.path(), &worker));
        Self { workers: workers.collect(), server, folder }
    }

    fn maveric(&self, study: &TempStudy, args: &[&str]) -> Command {
        let mut command = study.command(args);
        command.env("HQ_SERVER_DIR", self.folder.path());
        command
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        for child in self.workers.iter_mut().chain([&mut self.server]) {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

fn started(folder: &Path, args: &[&str]) -> Child {
    Command::new("hq")
        .args(args)
        .env("HQ_SERVER_DIR", folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Whether a process has started others that still run.
fn works(pid: u32) -> bool {
    let children = std::fs::read_to_string(format!("/proc/{pid}/task/{pid}/children"));
    if let Ok(children) = children {
        return !children.trim().is_empty();
    }
    let parent = |entry: std::fs::DirEntry| {
        let stat = std::fs::read_to_string(entry.path().join("stat")).ok()?;
        let behind = stat.rsplit_once(')')?.1;
        behind.split_whitespace().nth(1)?.parse::<u32>().ok()
    };
    let processes = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    processes.filter_map(parent).any(|p| p == pid)
}

/// Every file below a folder with its bytes.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let name = |path: &Path| path.strip_prefix(folder).unwrap().display().to_string();
    let paths = files(folder).into_iter();
    paths.map(|path| (name(&path), std::fs::read(&path).unwrap())).collect()
}

/// What the small study's run made, but for logs and what a run notes of itself.
fn made(study: &TempStudy) -> BTreeMap<String, Vec<u8>> {
    let mut results = contents(&study.path("study_data/generated/smoke"));
    results.extend(contents(&study.path("reports/smoke")));
    results.retain(|name, _| !name.contains(".logs/"));
    results
}

fn killed_at_work() {
    let mut cluster = Cluster::start(2);
    let study = TempStudy::new();
    let run = ["run", "pipelines/smoke.toml", "--executor", "hq"];
    let running = cluster
        .maveric(&study, &run)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let until = Instant::now() + Duration::from_mins(2);
    while !works(cluster.workers[0].id()) {
        assert!(Instant::now() < until, "the worker never worked");
        std::thread::sleep(Duration::from_millis(5));
    }
    // What the worker had started may go on beside its second copy, as on a node that was given up.
    cluster.workers[0].kill().unwrap();
    Ran::from(running.wait_with_output().unwrap()).ok();
    let local = TempStudy::new();
    local.maveric(&["run", "pipelines/smoke.toml"]).ok();
    let (here, there) = (made(&local), made(&study));
    assert!(here.len() > 50, "{} files", here.len());
    assert_eq!(here.keys().collect::<Vec<_>>(), there.keys().collect::<Vec<_>>());
    let differ: Vec<&String> =
        here.iter().filter(|(name, bytes)| there[*name] != **bytes).map(|f| f.0).collect();
    assert!(differ.is_empty(), "{differ:?} differ");
}

fn many_tasks() {
    let cluster = Cluster::start(2);
    let tasks = std::env::var("MAVERIC_HQ_TASKS").map_or(200, |n| n.parse().unwrap());
    let study = TempStudy::new();
    study.write(
        "many.toml",
        format!(
            "name = 'many'\n[[stage]]\nname = 'task'\nshards = {tasks}\noutputs = ['many/{{shard}}']\n\
             cmd = ['sh', '-c', 'echo {{shard}} > many/{{shard}}']\n"
        ),
    );
    let run = || {
        let start = Instant::now();
        let args = ["run", "many.toml", "--executor", "hq"];
        let ran = Ran::from(cluster.maveric(&study, &args).output().unwrap()).ok();
        eprintln!("{tasks} tasks: {:.2} s", start.elapsed().as_secs_f64());
        ran
    };
    run();
    let made = contents(&study.path("many"));
    let expected = (0..tasks).map(|i: u32| (i.to_string(), format!("{i}\n").into_bytes()));
    assert_eq!(made, expected.collect());
    let again = run();
    assert!(again.stdout.contains("nothing was run"), "{}", again.stdout);
}
