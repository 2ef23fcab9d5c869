//! What the example makes, and makes again.

use super::*;

#[test]
fn the_example_counts_words_and_runs_only_what_a_change_reaches() {
    let mut novels = Novels::new();
    let report = novels.run();
    assert_eq!(report.stages.len(), 9);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    #[cfg(target_os = "linux")]
    assert!(report.stages.iter().all(|stage| stage.peak_memory.is_some()));
    assert_eq!(novels.read("made/table.csv"), TABLE);
    let words = ["moby", "pride", "cities"]
        .map(|book| novels.read(&format!("texts/{book}.txt")).split_whitespace().count());
    let all: usize = words.iter().sum();
    assert!(report.summaries[0].text.starts_with(&format!("{all} words in all\n")));

    // One text: its count, its shard, and nothing of the others.
    let text = novels.read("texts/pride.txt");
    fs::write(novels.path("texts/pride.txt"), format!("{text}Of of of of.\n")).unwrap();
    let ran = novels.run_with(State::Done);
    let [count, row, shard, table] = ran.as_slice() else {
        panic!("{ran:?}");
    };
    assert_eq!([count, row, table], ["count.pride", "row.pride.1813", "table"]);
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
    assert_eq!(novels.run_with(State::Done), ["count.moby", "count.pride", "count.cities"]);
}

#[test]
fn a_new_version_of_a_stage_runs_it_again() {
    let novels = Novels::new();
    novels.run();
    let file = novels.path("pipelines/words.toml");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, text.replace("name = \"table\"", "name = \"table\"\nversion = \"2\""))
        .unwrap();
    let status = why(&novels.pipeline(), &novels.place(), "table").unwrap();
    let reason = status[0].reasons[0].to_string();
    assert_eq!(reason, "`table` changed from version none to 2");
    assert_eq!(novels.run_with(State::Done), ["table"]);
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
