//! Whole runs of small shell pipelines in temporary folders.
#![expect(clippy::unwrap_used, reason = "the helpers of tests are tests, too")]

mod at_once;
mod failures;
mod fans;
mod stale;
mod whose_files;

use maveric_pipeline::*;
use std::fs;
use std::path::{Path, PathBuf};

/// A pipeline file and its place in a folder that goes with it.
struct Project {
    folder: tempfile::TempDir,
    text: String,
    overrides: Vec<(String, String)>,
    options: RunOptions,
}

impl Project {
    fn new(text: &str) -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
            text: text.to_owned(),
            overrides: Vec::new(),
            options: RunOptions::default(),
        }
    }

    /// A pipeline of one stage `a`, of which these are the other lines.
    fn of_stage(lines: &str) -> Self {
        Self::new(&format!("name = 'test'\n[[stage]]\nname = 'a'\n{lines}"))
    }

    fn root(&self) -> &Path {
        self.folder.path()
    }

    fn path(&self, path: &str) -> PathBuf {
        self.root().join(path)
    }

    fn place(&self) -> Place {
        Place {
            root: self.root().to_owned(),
            ledger: self.path("state/test.lock"),
            log_dir: self.path("logs"),
            program: None,
        }
    }

    fn place_with(&self, program: Program) -> Place {
        Place { program: Some(program), ..self.place() }
    }

    fn pipeline(&self) -> Pipeline {
        let settings = Settings { set: self.overrides.clone(), ..Settings::default() };
        Pipeline::parse(&self.text, Path::new("test.toml"), self.root(), &settings).unwrap()
    }

    fn run(&self) -> RunReport {
        self.try_run().unwrap()
    }

    fn try_run(&self) -> Result<RunReport, PipelineError> {
        run(&self.pipeline(), &self.place(), &self.options, &mut |_| {})
    }

    /// The stages that a run runs.
    fn ran(&self) -> Vec<String> {
        let report = self.run();
        assert_eq!(report.outcome, Outcome::Done, "{:?}", report.failures);
        in_state(&report, State::Done)
    }

    /// Why `stage` would run, in sentences.
    fn why(&self, stage: &str) -> Vec<String> {
        let status = why(&self.pipeline(), &self.place(), stage).unwrap();
        texts(&status[0].reasons)
    }

    fn read(&self, path: &str) -> String {
        fs::read_to_string(self.path(path)).unwrap()
    }

    fn write(&self, path: &str, text: &str) {
        fs::write(self.path(path), text).unwrap();
    }

    fn remove(&self, path: &str) {
        fs::remove_file(self.path(path)).unwrap();
    }
}

fn texts<T: ToString>(list: &[T]) -> Vec<String> {
    list.iter().map(ToString::to_string).collect()
}

fn in_state(report: &RunReport, state: State) -> Vec<String> {
    let found = report.stages.iter().filter(|s| s.state == state);
    found.map(|s| s.stage.clone()).collect()
}

/// seed -> one -> two, and a directory beside them.
const CHAIN: &str = r#"
name = "test"
[params]
seed = 1
word = "end"
[[stage]]
name = "one"
cmd = ["sh", "-c", "cat source.txt > one.txt; echo {seed} >> one.txt"]
inputs = ["source.txt"]
outputs = ["one.txt"]
[[stage]]
name = "two"
cmd = ["sh", "-c", "wc -l < one.txt > out/two.txt; echo {word} | tee -a out/two.txt"]
inputs = ["one.txt"]
outputs = ["out/two.txt"]
summary = true
[[stage]]
name = "folder"
cmd = ["sh", "-c", "mkdir -p parts && for i in $(cat source.txt); do echo $i > parts/$i; done"]
inputs = ["source.txt"]
outputs = ["parts"]
"#;

fn chain() -> Project {
    let project = Project::new(CHAIN);
    project.write("source.txt", "1\n2\n");
    project
}
