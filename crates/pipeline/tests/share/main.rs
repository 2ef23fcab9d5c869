//! What a run leaves for others: the cache, and what `verify`, `trace`, `diff` and `clean`
//! tell of it; on the example of a pipeline that counts words.
#![expect(clippy::unwrap_used, reason = "the helpers of tests are tests, too")]

mod cache;
mod made;
mod told;

use std::fs;
use std::path::{Path, PathBuf};

use maveric_pipeline::*;

/// A copy of the example.
struct Novels {
    folder: tempfile::TempDir,
    set: Vec<(String, String)>,
    variant: Option<String>,
    options: RunOptions,
}

impl Novels {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        copy(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/novels")), folder.path());
        Self { folder, set: Vec::new(), variant: None, options: RunOptions::default() }
    }

    fn with_cache(cache: &Path) -> Self {
        let mut novels = Self::new();
        novels.options.cache = Some(cache.to_owned());
        novels
    }

    fn path(&self, path: &str) -> PathBuf {
        self.folder.path().join(path)
    }

    fn read(&self, path: &str) -> String {
        fs::read_to_string(self.path(path)).unwrap()
    }

    fn place(&self) -> Place {
        Place {
            root: self.folder.path().to_owned(),
            ledger: self.path("pipelines/words.lock"),
            log_dir: self.path("pipelines/.logs/words"),
            program: None,
        }
    }

    fn pipeline(&self) -> Pipeline {
        let file = self.path("pipelines/words.toml");
        let settings = Settings {
            set: self.set.clone(),
            variant: self.variant.clone(),
            ..Settings::default()
        };
        Pipeline::read(&file, self.folder.path(), &settings).unwrap()
    }

    fn run(&self) -> RunReport {
        let report = run(&self.pipeline(), &self.place(), &self.options, &mut |_| {}).unwrap();
        assert_eq!(report.outcome, Outcome::Done, "{:?}", report.failures);
        report
    }

    /// The stages that a run brings into this state.
    fn run_with(&self, state: State) -> Vec<String> {
        let report = self.run();
        let found = report.stages.iter().filter(|stage| stage.state == state);
        found.map(|stage| stage.stage.clone()).collect()
    }

    fn at(&self) -> RunAt {
        RunAt {
            ledger: Ledger::read(&self.place().ledger, "words").unwrap(),
            root: self.folder.path().to_owned(),
            variant: self.variant.clone(),
        }
    }

    fn digest_of(&self, stage: &str) -> String {
        self.at().ledger.variant(None)[stage].digest.clone()
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

const TABLE: &str =
    "book,year,words\npride,1813,a of the\nmoby,1851,the and i\ncities,1859,it of the\n";
