//! What is refused, and stages that fail.

use crate::{CHAIN, Project, chain, in_state, texts};
use maveric_pipeline::*;
use std::fs;

#[test]
fn a_missing_source_is_refused_before_anything_runs() {
    let project = Project::new(&CHAIN.replace("[\"source.txt\"]", "[\"sauce.txt\"]"));
    let error = project.try_run().unwrap_err();
    assert_eq!(
        error.to_string(),
        "stage `one` needs `sauce.txt`, which does not exist and which no stage makes"
    );
    assert_eq!(project.why("one")[1], "input `sauce.txt` does not exist and no stage makes it");
    assert!(!project.path("state").exists());
}

#[test]
fn help_from_the_pipeline_file_says_how_to_get_a_missing_input() {
    let project = Project::of_stage(
        "cmd = ['true']\ninputs = ['data']\ninputs_help = 'download the data from the archive'\n",
    );
    let help = project.try_run().unwrap_err().suggestion();
    assert_eq!(help.as_deref(), Some("download the data from the archive"));
}

#[test]
fn a_stage_may_neither_make_nor_read_the_directory_of_the_ledger() {
    for key in ["inputs", "outputs"] {
        let project = Project::of_stage(&format!("cmd = ['true']\n{key} = ['state']\n"));
        fs::create_dir(project.path("state")).unwrap();
        let error = project.try_run().unwrap_err();
        assert!(matches!(error, PipelineError::HoldsOurs { .. }), "{error}");
    }
    let project = Project::of_stage("cmd = ['true']\n");
    let root = project.root().file_name().unwrap().to_str().unwrap();
    let text = format!("{}outputs = ['../{root}']\n", project.text);
    let project = Project { text, ..project };
    let error = project.try_run().unwrap_err();
    assert!(matches!(error, PipelineError::HoldsOurs { .. }), "{error}");
}

#[test]
fn a_damaged_ledger_is_left_as_it_is() {
    let mut project = chain();
    project.ran();
    project.write("state/test.lock", "damaged");
    let error = project.try_run().unwrap_err();
    assert!(matches!(error, PipelineError::LedgerDamaged { .. }), "{error}");
    assert_eq!(project.read("state/test.lock"), "damaged");
    fs::remove_file(project.place().ledger).unwrap();
    project.options.move_aside = true;
    assert_eq!(project.ran(), ["one", "two", "folder"]);
}

#[cfg(unix)]
#[test]
fn a_name_that_is_no_text_is_an_error() {
    use std::os::unix::ffi::OsStrExt;
    let project = Project::of_stage("cmd = ['true']\ninputs = ['data']\n");
    fs::create_dir(project.path("data")).unwrap();
    let name = std::ffi::OsStr::from_bytes(b"data/\xff.csv");
    fs::write(project.root().join(name), "").unwrap();
    let error = project.try_run().unwrap_err();
    assert!(error.to_string().contains("is not UTF-8 text"), "{error}");
}

const FAILING: &str = r#"
name = "test"
[[stage]]
name = "bad"
cmd = ["sh", "-c", "echo half > bad.txt; echo 'no such column' >&2; exit 3"]
outputs = ["bad.txt"]
[[stage]]
name = "after"
cmd = ["sh", "-c", "cp bad.txt after.txt"]
inputs = ["bad.txt"]
outputs = ["after.txt"]
[[stage]]
name = "apart"
cmd = ["sh", "-c", "echo good > apart.txt"]
outputs = ["apart.txt"]
"#;

#[test]
fn a_failure_stops_the_run_and_says_how_to_repeat_the_stage() {
    let project = Project::new(FAILING);
    let report = project.run();
    assert_eq!(report.outcome, Outcome::Failed);
    assert_eq!(in_state(&report, State::Ready), ["apart"]);
    let failure = &report.failures[0];
    assert_eq!(failure.to_string(), "stage `bad` failed: its program ended with exit status 3");
    assert_eq!(failure.last_lines, ["no such column"]);
    assert!(fs::read_to_string(failure.log.as_ref().unwrap()).unwrap().contains("no such column"));
    let repeated = std::process::Command::new("sh")
        .args(["-c", failure.repeat.as_deref().unwrap()])
        .output()
        .unwrap();
    assert_eq!(repeated.status.code(), Some(3));
    assert_eq!(project.why("bad"), ["its last run did not finish"]);
    let verified = verify(&project.pipeline(), &project.place()).unwrap();
    assert_eq!(verified.unfinished, ["bad"]);
    assert_eq!(verified.never_run, ["after", "apart"]);
}

#[test]
fn keep_going_runs_what_does_not_need_the_failed_stage() {
    let mut project = Project::new(FAILING);
    project.options.keep_going = true;
    let report = project.run();
    assert_eq!(report.outcome, Outcome::Failed);
    assert_eq!(in_state(&report, State::Done), ["apart"]);
    assert_eq!(in_state(&report, State::Failed), ["bad"]);
    assert_eq!(in_state(&report, State::Wanted), ["after"]);
    assert!(!project.path("after.txt").exists());
}

#[test]
fn a_stage_that_lies_about_its_outputs_fails_and_a_program_that_is_not_there_too() {
    let mut project = Project::new(
        "name = 'test'\n[[stage]]\nname = 'liar'\ncmd = ['true']\noutputs = ['a', 'b']\n\
         [[stage]]\nname = 'ghost'\ncmd = ['no-such-program-here']\n",
    );
    project.options.keep_going = true;
    let failures = texts(&project.run().failures);
    assert_eq!(failures[0], "stage `liar` failed: its program ended well but did not make a, b");
    assert!(failures[1].contains("`no-such-program-here` cannot be started"));
}

#[test]
fn a_stage_is_tried_again_as_often_as_it_may() {
    let mut project = Project::of_stage(
        "retries = 1\noutputs = ['a']\n\
         cmd = ['sh', '-c', 'echo x >> a; echo x >> tries; [ $(wc -l < tries) -ge 3 ]']\n",
    );
    let report = project.run();
    assert_eq!(report.failures.len(), 1);
    assert_eq!(project.read("tries"), "x\nx\n");
    project.text = project.text.replace("retries = 1", "retries = 2");
    let mut heard = Vec::new();
    let mut observe = |event: Event<'_>| {
        if let Event::Retried { cause, retry, retries, .. } = event {
            heard.push(format!("{cause} ({retry} of {retries})"));
        }
    };
    project.remove("tries");
    let (pipeline, place) = (project.pipeline(), project.place());
    let report = run(&pipeline, &place, &project.options, &mut observe).unwrap();
    assert_eq!(report.outcome, Outcome::Done);
    let said = "its program ended with exit status 1";
    assert_eq!(heard, [format!("{said} (1 of 2)"), format!("{said} (2 of 2)")]);
    assert_eq!(project.read("a"), "x\n", "each try starts clean");
}
