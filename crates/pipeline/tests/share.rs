//! What a run leaves for others: the cache, and what `verify`, `trace`, `diff` and `clean`
//! tell of it; on the example of a pipeline that counts words.
#![expect(clippy::unwrap_used, reason = "the helpers of tests are tests, too")]

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
        copy(
            Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/novels")),
            folder.path(),
        );
        Self {
            folder,
            set: Vec::new(),
            variant: None,
            options: RunOptions::default(),
        }
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

/// Counted by hand, too.
const TABLE: &str =
    "book,year,words\npride,1813,a of the\nmoby,1851,the and i\ncities,1859,it of the\n";

#[test]
fn the_example_counts_words_and_runs_only_what_a_change_reaches() {
    let mut novels = Novels::new();
    let report = novels.run();
    assert_eq!(report.stages.len(), 9);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    #[cfg(target_os = "linux")]
    assert!(
        report
            .stages
            .iter()
            .all(|stage| stage.peak_memory.is_some())
    );
    assert_eq!(novels.read("made/table.csv"), TABLE);
    let words = ["moby", "pride", "cities"].map(|book| {
        novels
            .read(&format!("texts/{book}.txt"))
            .split_whitespace()
            .count()
    });
    let all: usize = words.iter().sum();
    assert!(
        report.summaries[0]
            .text
            .starts_with(&format!("{all} words in all\n"))
    );

    // One text: its count, its shard, and nothing of the others.
    let text = novels.read("texts/pride.txt");
    fs::write(
        novels.path("texts/pride.txt"),
        format!("{text}Of of of of.\n"),
    )
    .unwrap();
    let ran = novels.run_with(State::Done);
    let [count, row, shard, table] = ran.as_slice() else {
        panic!("{ran:?}");
    };
    assert_eq!(
        [count, row, table],
        ["count.pride", "row.pride.1813", "table"]
    );
    assert!(shard.starts_with("length."));

    // One cell of the table: the row that has it.
    let books = novels.read("books.csv").replace("1859", "1860");
    fs::write(novels.path("books.csv"), books).unwrap();
    let reasons = why(&novels.pipeline(), &novels.place(), "row.cities.1860").unwrap();
    assert!(reasons[0].reasons[0].to_string().contains("no record"));
    assert_eq!(novels.run_with(State::Done), ["row.cities.1860", "table"]);
    // A parameter: what uses it.
    novels.set = vec![("top".to_owned(), "2".to_owned())];
    assert_eq!(novels.run_with(State::Done).len(), 4);
    // All stages of a fan-out are a target.
    novels.options.targets = vec!["count".to_owned()];
    novels.options.force = true;
    assert_eq!(
        novels.run_with(State::Done),
        ["count.moby", "count.pride", "count.cities"]
    );
}

#[test]
fn a_colleague_with_the_same_inputs_takes_everything_from_the_cache() {
    let cache = tempfile::tempdir().unwrap();
    let with_cache = || {
        let mut novels = Novels::new();
        novels.options.cache = Some(cache.path().to_owned());
        novels
    };
    let (mine, theirs) = (with_cache(), with_cache());
    assert_eq!(mine.run_with(State::Done).len(), 9);
    let report = theirs.run();
    assert!(
        report
            .stages
            .iter()
            .all(|stage| stage.state == State::Restored)
    );
    assert!(report.summaries[0].text.contains("words in all"));
    assert_eq!(theirs.read("made/table.csv"), TABLE);
    assert_eq!(theirs.run_with(State::UpToDate).len(), 9);
    assert_eq!(mine.digest_of("table"), theirs.digest_of("table"));

    // Damaged: said, thrown out, made again and put in again.
    let mut damaged = 0;
    let content = cache.path().join("v1/content");
    for entry in fs::read_dir(&content)
        .unwrap()
        .flatten()
        .flat_map(|e| fs::read_dir(e.path()).unwrap())
    {
        let path = entry.unwrap().path();
        if fs::read_to_string(&path).unwrap() == TABLE {
            fs::write(&path, "damaged").unwrap();
            damaged += 1;
        }
    }
    assert_eq!(damaged, 1);
    let next = with_cache();
    let report = next.run();
    assert_eq!(report.warnings.len(), 1);
    assert!(
        report.warnings[0]
            .to_string()
            .contains("damaged for stage `table`")
    );
    assert_eq!(next.read("made/table.csv"), TABLE);
    let last = with_cache();
    assert_eq!(last.run_with(State::Restored).len(), 9);

    // A cache that cannot be written costs a warning.
    let mut without = Novels::new();
    without.options.cache = Some(without.path("books.csv"));
    assert_eq!(without.run().warnings.len(), 9);
}

#[test]
fn an_entry_of_the_cache_that_could_write_anywhere_is_not_believed() {
    let cache = tempfile::tempdir().unwrap();
    let with_cache = || {
        let mut novels = Novels::new();
        novels.options.cache = Some(cache.path().to_owned());
        novels.options.targets = vec!["table".to_owned()];
        novels
    };
    let first = with_cache();
    first.run();
    let entries = || {
        let folders = fs::read_dir(cache.path().join("v1/made"))
            .unwrap()
            .flatten();
        let files = folders.flat_map(|e| fs::read_dir(e.path()).unwrap());
        files.map(|e| e.unwrap().path()).collect::<Vec<_>>()
    };
    let table = entries()
        .into_iter()
        .find(|path| fs::read_to_string(path).unwrap().contains("made/table.csv"))
        .unwrap();
    let good = fs::read_to_string(&table).unwrap();
    let entry: serde_json::Value = serde_json::from_str(&good).unwrap();
    let hash = entry["files"][0]["content"].as_str().unwrap().to_owned();
    let with = |pointer: &str, value: serde_json::Value| {
        let mut entry = entry.clone();
        *entry.pointer_mut(pointer).unwrap() = value;
        entry.to_string()
    };
    for bad in [
        with("/files/0/output", "../outside".into()),
        with("/files/0/output", "/tmp/outside".into()),
        with("/files/0/output", "books.csv".into()),
        with("/files/0/within", "/../../outside".into()),
        with("/files/0/within", "x/../outside".into()),
        with("/files/0/content", "../../../../books.csv".into()),
        with("/files/0/content", hash[1..].into()),
        with("/outputs", serde_json::json!({})),
        with("/outputs", serde_json::json!({"books.csv": hash})),
        with("/digest", hash.clone().into()),
        "{".to_owned(),
    ] {
        fs::write(&table, &bad).unwrap();
        let next = with_cache();
        let books = next.read("books.csv");
        let report = next.run();
        assert_eq!(report.warnings.len(), 1, "{bad}: {:?}", report.warnings);
        assert!(
            report.warnings[0]
                .to_string()
                .contains("damaged for stage `table`")
        );
        assert_eq!(
            (next.read("made/table.csv"), next.read("books.csv")),
            (TABLE.to_owned(), books)
        );
        assert!(!next.path("../outside").exists() && !Path::new("/tmp/outside").exists());
    }
    assert_eq!(
        with_cache().run_with(State::Restored).len(),
        9,
        "it was put in again"
    );
}

#[test]
fn verify_reads_everything_again() {
    let novels = Novels::new();
    let found = verify(&novels.pipeline(), &novels.place()).unwrap();
    assert_eq!((found.compared, found.never_run.len()), (0, 9));
    novels.run();
    let found = verify(&novels.pipeline(), &novels.place()).unwrap();
    assert!(found.findings.is_empty() && found.compared > 9, "{found:?}");
    fs::write(novels.path("made/table.csv"), "edited").unwrap();
    fs::remove_file(novels.path("texts/moby.txt")).unwrap();
    let found = verify(&novels.pipeline(), &novels.place())
        .unwrap()
        .findings;
    let told: Vec<_> = found
        .iter()
        .map(|f| (f.stage.as_str(), f.role, f.state))
        .collect();
    assert!(
        told.contains(&("table", Role::Output, FileState::Changed)),
        "{told:?}"
    );
    assert!(
        told.contains(&("count.moby", Role::Input, FileState::Missing)),
        "{told:?}"
    );
}

#[test]
fn trace_walks_back_to_the_rows_and_files() {
    let novels = Novels::new();
    novels.run();
    let trace = |path: &str| trace(&novels.at().ledger, &novels.place(), path);
    let found = trace("made/table.csv").unwrap();
    assert_eq!(found.stages.len(), 9);
    assert_eq!(found.stages[0].stage, "table");
    let sources: Vec<_> = found
        .sources
        .iter()
        .map(|source| source.path.as_str())
        .collect();
    assert_eq!(
        sources,
        ["texts/cities.txt", "texts/moby.txt", "texts/pride.txt"]
    );
    let of_one = trace("./made/rows/pride.csv").unwrap();
    let names: Vec<_> = of_one.stages.iter().map(|s| s.stage.as_str()).collect();
    assert_eq!(names, ["row.pride.1813", "count.pride"]);
    let lines = of_one.lines();
    assert_eq!(
        lines[1],
        "<- stage row.pride.1813 (row on line 3 of books.csv)"
    );
    fs::write(novels.path("texts/pride.txt"), "other").unwrap();
    let lines = trace("made/rows/pride.csv").unwrap().lines();
    assert!(
        lines
            .last()
            .unwrap()
            .ends_with("texts/pride.txt (changed since)")
    );
    let error = trace("made/tabel.csv").unwrap_err();
    assert_eq!(
        error.suggestion().as_deref(),
        Some("did you mean `made/table.csv`?")
    );
    let root = novels.folder.path();
    assert_eq!(below_root(&root.join("made/../a.csv"), root), "a.csv");
}

#[test]
fn diff_names_parameters_inputs_and_numbers() {
    let (mut first, mut second) = (Novels::new(), Novels::new());
    first.set = vec![("out".to_owned(), "made/here".to_owned())];
    second.set = vec![("out".to_owned(), "there".to_owned())];
    first.run();
    second.run();
    let same = diff(&first.at(), &second.at()).unwrap();
    assert_eq!(same.same, 9, "another folder is no difference: {same:?}");
    let books = second.read("books.csv").replace("1813", "1814");
    fs::write(second.path("books.csv"), books).unwrap();
    let text = second.read("texts/moby.txt");
    fs::write(second.path("texts/moby.txt"), format!("{text} whale whale")).unwrap();
    second.run();
    let found = diff(&first.at(), &second.at()).unwrap();
    assert_eq!(found.only_first, ["row.pride.1813"]);
    let lines = found.lines().join("\n");
    assert!(lines.contains("input `texts/moby.txt` changed"), "{lines}");
    assert!(
        lines.contains("{out}/table.csv: 1 of 3 numbers differ"),
        "{lines}"
    );
    assert!(lines.contains("pride, year: 1813 -> 1814"), "{lines}");
    fs::write(second.path("there/table.csv"), "edited").unwrap();
    let lines = diff(&first.at(), &second.at()).unwrap().lines().join("\n");
    assert!(
        lines.contains("no longer what the second run had made"),
        "{lines}"
    );
}

#[test]
fn clean_removes_what_was_made_here_and_nothing_else() {
    let novels = Novels::new();
    novels.run();
    fs::write(novels.path("made/rows/pride.csv"), "edited").unwrap();
    fs::write(novels.path("made/notes.txt"), "mine").unwrap();
    let clean = |targets: &[&str], force, dry_run| {
        let targets: Vec<String> = targets.iter().map(|t| (*t).to_owned()).collect();
        clean(
            &novels.pipeline(),
            &novels.place(),
            &targets,
            force,
            dry_run,
        )
        .unwrap()
    };
    assert_eq!(clean(&[], false, true).removed.len(), 8);
    assert_eq!(novels.read("made/table.csv"), TABLE);
    assert_eq!(clean(&["table"], false, false).removed, ["made/table.csv"]);
    let cleaned = clean(&[], false, false);
    assert_eq!(
        (cleaned.removed.len(), cleaned.kept.as_slice()),
        (7, &["made/rows/pride.csv".to_owned()][..])
    );
    assert!(!novels.path("made/counts").exists());
    assert_eq!(clean(&[], true, false).removed, ["made/rows/pride.csv"]);
    assert_eq!(novels.read("made/notes.txt"), "mine");
    assert!(novels.at().ledger.run.is_empty());
    assert_eq!(novels.run_with(State::Done).len(), 9);
}

#[test]
fn variants_stand_side_by_side_and_are_compared_and_cleaned_apart() {
    let mut novels = Novels::new();
    novels.run();
    novels.variant = Some("two".to_owned());
    novels.set = vec![("top".to_owned(), "2".to_owned())];
    let report = novels.run();
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    assert_eq!(novels.run_with(State::UpToDate).len(), 9);
    let second = novels.at();
    (novels.variant, novels.set) = (None, Vec::new());
    assert_eq!(novels.run_with(State::UpToDate).len(), 9);
    assert!(
        novels.run().summaries[0]
            .text
            .contains("moby,1851,the and i\n")
    );
    assert_eq!(novels.read("made/table.csv"), TABLE);
    assert_eq!(
        second.ledger.variants().into_iter().collect::<Vec<_>>(),
        ["two"]
    );
    let lines = diff(&novels.at(), &second).unwrap().lines().join("\n");
    assert!(
        lines.contains("parameter `top` changed from 3 to 2"),
        "{lines}"
    );
    assert!(
        !lines.contains("`out`") && lines.contains("{out}/table.csv"),
        "{lines}"
    );
    let trace = trace(&second.ledger, &novels.place(), "made-two/table.csv").unwrap();
    assert_eq!(trace.stages.len(), 9);
    assert!(trace.sources.iter().all(|s| !s.path.starts_with("made")));
    // The same into the same place: said, and nothing of it stays.
    novels.set = vec![("top".to_owned(), "1".to_owned())];
    let warnings = novels.run().warnings;
    let expected = "the former results (top=3, now 1) were replaced; `--variant NAME` keeps both";
    assert_eq!(
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        [expected]
    );
    novels.set = Vec::new();
    assert!(
        novels.run().warnings[0]
            .to_string()
            .contains("top=1, now 3")
    );
    let cleaned = clean(&novels.pipeline(), &novels.place(), &[], false, false).unwrap();
    assert_eq!((cleaned.removed.len(), cleaned.kept.len()), (9, 0));
    assert!(!novels.path("made").exists() && novels.path("made-two/table.csv").exists());
    novels.variant = Some("two".to_owned());
    let cleaned = clean(&novels.pipeline(), &novels.place(), &[], false, false).unwrap();
    assert_eq!(cleaned.removed.len(), 9);
    assert!(!novels.path("made-two").exists());
}

#[test]
fn a_new_version_of_a_stage_runs_it_again() {
    let novels = Novels::new();
    novels.run();
    let file = novels.path("pipelines/words.toml");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(
        &file,
        text.replace("name = \"table\"", "name = \"table\"\nversion = \"2\""),
    )
    .unwrap();
    let status = why(&novels.pipeline(), &novels.place(), "table").unwrap();
    let reason = status[0].reasons[0].to_string();
    assert_eq!(reason, "`table` changed from version none to 2");
    assert_eq!(novels.run_with(State::Done), ["table"]);
}

/// Editors complete pipelines by this file; `UPDATE_SCHEMA=1` writes it anew.
#[test]
fn the_schema_beside_the_pipelines_is_that_of_this_version() {
    let file = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../pipelines/schema.json"
    ));
    let text = serde_json::to_string_pretty(&schema()).unwrap() + "\n";
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        fs::write(file, &text).unwrap();
    }
    assert!(
        fs::read_to_string(file).unwrap() == text,
        "UPDATE_SCHEMA=1 cargo test writes it"
    );
}

#[test]
fn a_folder_in_the_place_of_a_file_of_the_cache_is_no_file_and_stays() {
    let cache = tempfile::tempdir().unwrap();
    let with_cache = || {
        let mut novels = Novels::new();
        novels.options.cache = Some(cache.path().to_owned());
        novels
    };
    with_cache().run();
    let content = fs::read_dir(cache.path().join("v1/content"))
        .unwrap()
        .flatten();
    let mut files = content.flat_map(|e| fs::read_dir(e.path()).unwrap().flatten());
    let is_table = |path: &std::path::PathBuf| fs::read_to_string(path).unwrap() == TABLE;
    let blob = files.find_map(|e| Some(e.path()).filter(is_table)).unwrap();
    fs::remove_file(&blob).unwrap();
    fs::create_dir(&blob).unwrap();
    fs::write(blob.join("mine"), "mine").unwrap();
    let next = with_cache();
    let report = next.run();
    assert_eq!(report.outcome, Outcome::Done, "{:?}", report.failures);
    assert_eq!(next.read("made/table.csv"), TABLE);
    let warnings: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
    assert!(
        warnings[0].contains("damaged for stage `table`"),
        "{warnings:?}"
    );
    assert!(
        warnings[1].contains("was not put into the cache"),
        "{warnings:?}"
    );
    assert!(blob.join("mine").exists());
}

#[test]
fn a_novel_that_left_the_table_of_books_is_in_no_result() {
    let novels = Novels::new();
    novels.run();
    let books = novels.read("books.csv");
    let fewer: Vec<&str> = books.lines().filter(|l| !l.starts_with("cities")).collect();
    fs::write(novels.path("books.csv"), fewer.join("\n")).unwrap();
    assert_eq!(novels.run_with(State::Done), ["table"]);
    assert!(!novels.read("made/table.csv").contains("cities"));
    assert!(!novels.path("made/rows/cities.csv").exists());
    assert!(!novels.path("made/counts/cities.txt").exists());
}
