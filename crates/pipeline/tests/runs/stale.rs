//! What is made anew, and what is not.

use crate::{CHAIN, Project, chain, in_state};
use maveric_pipeline::*;
use std::fs;

#[test]
fn a_second_run_does_nothing_and_still_has_the_summary() {
    let project = chain();
    assert_eq!(project.ran(), ["one", "two", "folder"]);
    assert_eq!(project.read("out/two.txt").replace(' ', ""), "3\nend\n");
    let before = project.read("state/test.lock");
    let report = project.run();
    assert_eq!(in_state(&report, State::UpToDate).len(), 3);
    assert_eq!(report.summaries[0].text, "end\n");
    assert_eq!(before, project.read("state/test.lock"));
    let status = status(&project.pipeline(), &project.place()).unwrap();
    assert!(status.iter().all(|s| s.up_to_date && s.reasons.is_empty()));
}

#[test]
fn a_changed_parameter_rebuilds_what_follows_and_only_that() {
    let mut project = chain();
    project.ran();
    project.overrides = vec![("word".to_owned(), "fin".to_owned())];
    assert_eq!(project.why("two"), ["parameter `word` changed from end to fin"]);
    assert_eq!(project.ran(), ["two"]);
    assert!(project.read("state/test.lock").contains("[run.\"out/two.txt\".set]\nword = \"fin\""));
    project.overrides.push(("seed".to_owned(), "2".to_owned()));
    let plan = plan(&project.pipeline(), &project.place(), &[], false).unwrap();
    let stale = plan.iter().filter(|s| !s.up_to_date).map(|s| &*s.stage);
    assert_eq!(stale.collect::<Vec<_>>(), ["one", "two"]);
    assert_eq!(plan[1].reasons[0].to_string(), "stage `one` runs before it");
    assert_eq!(project.ran(), ["one", "two"]);
}

#[test]
fn what_comes_out_the_same_stops_the_rebuilding() {
    let project = chain();
    project.ran();
    let project = Project {
        text: CHAIN.replace("cat source.txt > one", "cat < source.txt > one"),
        ..project
    };
    assert!(project.why("one")[0].starts_with("the command changed from"));
    assert_eq!(project.ran(), ["one"]);
}

#[test]
fn a_touched_but_equal_file_rebuilds_nothing_and_an_equally_long_one_does() {
    let project = chain();
    project.ran();
    project.write("source.txt", "1\n2\n");
    assert_eq!(project.ran(), [""; 0]);
    project.write("source.txt", "1\n3\n");
    assert_eq!(project.why("one"), ["input `source.txt` changed"]);
    assert_eq!(project.ran(), ["one", "two", "folder"]);
    let parts = fs::read_dir(project.path("parts")).unwrap();
    assert_eq!(parts.count(), 2, "the old part 2 must not stay");
}

#[test]
fn of_a_folder_into_which_its_stage_writes_the_newest_file_is_told() {
    let project = Project::of_stage(
        "cmd = ['sh', '-c', 'mkdir -p scripts/cache; echo x > scripts/cache/made; cp scripts/a out.txt']\n\
         inputs = ['scripts']\noutputs = ['out.txt']\n",
    );
    fs::create_dir(project.path("scripts")).unwrap();
    project.write("scripts/a", "1\n");
    let told = project.run().failures[0].to_string();
    let start = "stage `a` failed: scripts changed while it ran or waited (newest there: scripts/cache/made): run again; if the stage";
    assert!(told.starts_with(start), "{told}");
    assert_eq!(project.ran(), ["a"]);
}

#[test]
fn a_source_that_changes_while_a_stage_runs_is_recorded_under_neither_content() {
    let cache = tempfile::tempdir().unwrap();
    let stage = "cmd = ['sh', '-c', '[ -e once ] || echo 2 > in.txt; cat in.txt > out.txt; touch once']\n\
                 inputs = ['in.txt']\noutputs = ['out.txt']\nretries = 1\n";
    let project = |edited: bool| {
        let mut project = Project::of_stage(stage);
        project.options.cache = Some(cache.path().to_owned());
        project.write("in.txt", "1\n");
        if !edited {
            project.write("once", "");
        }
        project
    };
    let mine = project(true);
    let report = mine.run();
    assert_eq!(report.outcome, Outcome::Failed);
    assert_eq!(
        report.failures[0].to_string(),
        "stage `a` failed: in.txt changed while it ran or waited: run again"
    );
    assert_eq!(mine.why("a"), ["its last run did not finish"]);
    // Back to what it was: what was made meanwhile is not taken for its result, here or elsewhere.
    mine.write("in.txt", "1\n");
    assert_eq!(mine.ran(), ["a"]);
    assert_eq!(mine.read("out.txt"), "1\n");
    // What was made of a source that stayed as it was is.
    let theirs = project(false);
    assert_eq!(in_state(&theirs.run(), State::Restored), ["a"]);
    assert_eq!(theirs.read("out.txt"), "1\n");
}

#[test]
fn an_output_deleted_or_edited_by_hand_is_noticed_and_rebuilt() {
    let project = chain();
    project.ran();
    project.remove("one.txt");
    assert_eq!(project.why("one"), ["output `one.txt` is not there"]);
    assert_eq!(project.ran(), ["one"]);
    project.write("parts/2", "other");
    project.write("out/two.txt", "other");
    let sentence = "output `out/two.txt` is not as the stage had left it";
    assert_eq!(project.why("out/two.txt"), [sentence]);
    assert_eq!(project.ran(), ["two", "folder"]);
    assert_eq!(project.read("parts/2"), "2\n");
}

#[test]
fn a_target_brings_only_what_is_upstream_and_force_runs_only_the_target() {
    let mut project = chain();
    project.options.targets = vec!["out/two.txt".to_owned()];
    assert_eq!(project.ran(), ["one", "two"]);
    project.options.force = true;
    assert_eq!(project.ran(), ["two"]);
    project.options.targets.clear();
    assert_eq!(project.ran(), ["one", "two", "folder"]);
}

#[test]
fn a_stage_without_outputs_runs_once() {
    let project = Project::of_stage("cmd = ['true']\n");
    assert_eq!(project.ran(), ["a"]);
    assert_eq!(project.ran(), [""; 0]);
}

/// A stage that a program of ours makes.
const TOOL: &str = "cmd = ['tool', 'a.txt']\noutputs = ['a.txt']\n";

/// A program with one command.
fn tool(path: &str, leading: &[&str], (command, version): (&str, &str)) -> Program {
    Program {
        name: "tool".to_owned(),
        path: path.into(),
        leading: leading.iter().map(|word| (*word).to_owned()).collect(),
        versions: [(command.to_owned(), version.to_owned())].into(),
    }
}

#[test]
fn our_program_counts_by_the_version_of_its_command_and_not_by_its_path() {
    let project = Project::of_stage(TOOL);
    let run_with = |path: &str, version: &str| {
        let place = project.place_with(tool(path, &[], ("a.txt", version)));
        run(&project.pipeline(), &place, &project.options, &mut |_| {}).unwrap()
    };
    let touch = "/usr/bin/touch";
    assert_eq!(in_state(&run_with(touch, "1"), State::Done), ["a"]);
    assert_eq!(in_state(&run_with("/elsewhere/tool", "1"), State::UpToDate), ["a"]);
    let report = run_with(touch, "2");
    assert_eq!(report.stages[0].reasons[0].to_string(), "`tool a.txt` changed from version 1 to 2");
}

#[test]
fn a_program_of_an_interpreter_gets_its_leading_arguments_before_the_stages() {
    let project = Project::of_stage(TOOL);
    let shell = tool("/bin/sh", &["-c", "echo $1 > $1", "-"], ("a.txt", "1"));
    let place = project.place_with(shell);
    let report = run(&project.pipeline(), &place, &project.options, &mut |_| {}).unwrap();
    assert_eq!(in_state(&report, State::Done), ["a"]);
}

#[test]
fn a_command_that_our_program_does_not_have_is_refused_with_the_one_that_was_meant() {
    let project = Project::of_stage("cmd = ['tool', 'trian']\n");
    let place = project.place_with(tool("/bin/true", &[], ("train", "1")));
    let error = status(&project.pipeline(), &place).unwrap_err();
    assert_eq!(error.suggestion().as_deref(), Some("did you mean `train`?"));
}

#[test]
fn a_trace_says_that_what_it_traces_was_edited_since() {
    let project = chain();
    project.run();
    let ledger = Ledger::read(&project.place().ledger, "test").unwrap();
    let lines = || trace(&ledger, &project.place(), "out/two.txt").unwrap().lines();
    assert!(!lines().join("\n").contains("changed since"));
    project.write("out/two.txt", "by hand\n");
    assert!(lines().contains(&"     made out/two.txt (changed since)".to_owned()));
}

#[test]
fn files_that_differ_in_texts_alone_do_not_count_numbers() {
    let line = |compared| {
        let difference = FileDifference::Numbers {
            path: "a.csv".to_owned(),
            compared,
            differing: 0,
            largest: Vec::new(),
            unpaired: Vec::new(),
            texts: Vec::new(),
        };
        let stages = vec![StageDifference {
            stage: "a".to_owned(),
            made_from: Vec::new(),
            outputs: vec![difference],
        }];
        let (only_first, only_second, same) = (Vec::new(), Vec::new(), 0);
        RunDifference { only_first, only_second, stages, same }.lines()[1].clone()
    };
    assert_eq!(line(0), "  a.csv: has other texts");
    assert_eq!(line(3), "  a.csv: all 3 numbers are the same, other parts differ");
}
