//! Stages of many: what the pipeline no longer makes leaves the results.

use crate::{Project, in_state, texts};
use maveric_pipeline::*;

/// A stage for each row of a table, two shards, and one stage that reads both folders.
const FANS: &str = r#"
name = "test"
[[stage]]
name = "row"
foreach = "books.csv"
cmd = ["sh", "-c", "echo {book} > rows/{book}.txt"]
outputs = ["rows/{book}.txt"]
[[stage]]
name = "length"
shards = 2
cmd = ["sh", "-c", "echo {shard} > lengths/{shard}.txt"]
outputs = ["lengths/{shard}.txt"]
[[stage]]
name = "table"
cmd = ["sh", "-c", "cat rows/* lengths/* > table.txt"]
inputs = ["rows", "lengths"]
outputs = ["table.txt"]
"#;

fn fans() -> Project {
    let project = Project::new(FANS);
    project.write("books.csv", "book\nmoby\npride\ncities\n");
    assert_eq!(project.ran().len(), 6);
    assert_eq!(project.read("table.txt"), "cities\nmoby\npride\n0\n1\n");
    project
}

#[test]
fn a_row_that_left_its_table_leaves_the_results_too() {
    let project = fans();
    project.write("books.csv", "book\nmoby\npride\n");
    assert_eq!(
        project.why("table"),
        ["`rows/cities.txt`, which it read, is no longer made by any stage"]
    );
    let findings = verify(&project.pipeline(), &project.place()).unwrap().findings;
    let states: Vec<_> = findings.iter().map(|f| (f.path.as_str(), f.state)).collect();
    assert_eq!(states, [("rows/cities.txt", FileState::NoLongerMade)]);
    let report = project.run();
    assert_eq!(in_state(&report, State::Done), ["table"]);
    let warnings = texts(&report.warnings);
    let warning = "the pipeline no longer has stage `row.cities` there: `rows/cities.txt` removed";
    assert_eq!(warnings, [warning]);
    assert_eq!(project.read("table.txt"), "moby\npride\n0\n1\n");
    assert!(!project.path("rows/cities.txt").exists());
    assert!(verify(&project.pipeline(), &project.place()).unwrap().findings.is_empty());
    assert!(project.ran().is_empty());
    project.write("books.csv", "book\nmoby\npride\ncities\n");
    assert_eq!(project.ran(), ["row.cities", "table"]);
}

#[test]
fn fewer_shards_leave_no_shard_behind() {
    let mut project = fans();
    project.text = FANS.replace("shards = 2", "shards = 1");
    assert_eq!(project.ran(), ["table"]);
    assert_eq!(project.read("table.txt"), "cities\nmoby\npride\n0\n");
}

#[test]
fn an_output_with_another_name_and_a_stage_that_is_gone_leave_the_folder_that_is_read() {
    let mut project = fans();
    let extra = "[[stage]]\nname = 'extra'\ncmd = ['sh', '-c', 'echo x > rows/x.txt']\n\
                 outputs = ['rows/x.txt']\n";
    project.text = format!("{FANS}{extra}");
    assert_eq!(project.ran(), ["extra", "table"]);
    project.text = FANS.replace("rows/{book}.txt", "rows/{book}.md");
    assert_eq!(project.ran().len(), 4);
    assert_eq!(project.read("table.txt"), "cities\nmoby\npride\n0\n1\n");
}

#[test]
fn what_a_fan_no_longer_makes_stays_where_somebody_changed_it_and_is_named() {
    let mut project = fans();
    project.write("books.csv", "book\nmoby\npride\n");
    project.write("rows/cities.txt", "mine\n");
    let report = project.run();
    let warning = report.warnings[0].to_string();
    assert!(warning.contains("`rows/cities.txt` changed by hand"), "{warning}");
    assert_eq!(project.read("rows/cities.txt"), "mine\n");
    project.options.move_aside = true;
    let warnings = texts(&project.run().warnings);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("moved from the outputs of stage `row.cities`"));
    assert!(!project.path("rows/cities.txt").exists());
    assert_eq!(project.read("table.txt"), "moby\npride\n0\n1\n");
}
