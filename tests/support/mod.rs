//! A study in a temporary folder, and the program as a process.

#![allow(
    dead_code,
    unreachable_pub,
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "each test file uses its own part of this, and a test stops at the first surprise"
)]

pub mod own_logs;
pub mod page;

use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
};

pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// A folder with this project's `study_data` and `pipelines`, in which pipelines run.
pub struct TempStudy {
    folder: tempfile::TempDir,
}

/// A command line, word by word.
pub fn argv(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

/// A text has every one of these words.
#[track_caller]
pub fn tells(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "no `{word}` in: {text}");
    }
}

/// Every file of a folder and of those below it, in order.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            paths.extend(files(&path));
        } else {
            paths.push(path);
        }
    }
    paths.sort();
    paths
}

/// Copies a folder with all that is in it.
pub fn copy(from: &Path, to: &Path) {
    copy_but(from, to, &|_| false);
}

/// Copies a folder without what is left out by its name, at any depth.
fn copy_but(from: &Path, to: &Path, left_out: &dyn Fn(&str) -> bool) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap();
        if left_out(&name.to_string_lossy()) {
            continue;
        }
        if path.is_dir() {
            copy_but(&path, &to.join(name), left_out);
        } else {
            std::fs::copy(&path, to.join(name)).unwrap();
        }
    }
}

/// What a run left in this project's own folders.
fn is_left_by_a_run(name: &str) -> bool {
    let is_lock = Path::new(name).extension().is_some_and(|e| e == "lock");
    name == "generated" || name.starts_with('.') || is_lock
}

impl TempStudy {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for part in ["study_data", "pipelines"] {
            let to = folder.path().join(part);
            copy_but(&root().join(part), &to, &is_left_by_a_run);
        }
        Self { folder }
    }

    /// With a folder `mine` that `init` made, filled with the sample that is shipped: logs and answers of made-up people.
    pub fn of_sample() -> Self {
        let study = Self::new();
        study.maveric(&["init", "mine"]).ok();
        let (sample, mine) = (study.path("study_data/sample"), study.path("mine"));
        for part in ["logs", "surveys"] {
            copy(&sample.join(part), &mine.join(part));
        }
        let people = "participants.csv";
        std::fs::copy(sample.join(people), mine.join(people)).unwrap();
        study
    }

    pub fn path(&self, path: &str) -> PathBuf {
        self.folder.path().join(path)
    }

    pub fn write(&self, path: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    }

    pub fn read(&self, path: &str) -> String {
        std::fs::read_to_string(self.path(path)).unwrap()
    }

    pub fn json(&self, path: &str) -> serde_json::Value {
        serde_json::from_str(&self.read(path)).unwrap()
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_maveric"));
        command.args(args).current_dir(self.folder.path()).env("NO_COLOR", "1");
        command
    }

    pub fn maveric(&self, args: &[&str]) -> Ran {
        Ran::from(self.command(args).output().unwrap())
    }

    /// The program run in the folder `mine`, by this command line.
    pub fn mine(&self, line: &str) -> Ran {
        self.maveric_in("mine", &argv(line))
    }

    /// The program run in a folder below this one, such as a study's own.
    pub fn maveric_in(&self, folder: &str, args: &[&str]) -> Ran {
        let mut command = self.command(args);
        Ran::from(command.current_dir(self.path(folder)).output().unwrap())
    }
}

/// How a run of the program ended.
#[derive(Debug)]
pub struct Ran {
    pub status: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        Self {
            status: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

impl Ran {
    #[track_caller]
    pub fn ok(self) -> Self {
        assert_eq!(self.status, Some(0), "{}\n{}", self.stdout, self.stderr);
        self
    }

    /// It failed with `status`, said every one of `words` on stderr, printed nothing and did not panic.
    #[track_caller]
    pub fn failed(self, status: i32, words: &[&str]) -> Self {
        assert_eq!(self.status, Some(status), "{}\n{}", self.stdout, self.stderr);
        assert!(self.stdout.is_empty(), "stdout: {}", self.stdout);
        tells(&self.stderr, words);
        assert!(
            !self.stderr.contains("panicked") && !self.stderr.contains("RUST_BACKTRACE"),
            "{}",
            self.stderr
        );
        self
    }
}
