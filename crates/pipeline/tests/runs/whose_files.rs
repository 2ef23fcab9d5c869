//! What a run may replace and remove: what runs made, and nothing else.

use crate::{Project, chain, in_state, texts};
use maveric_pipeline::*;
use std::fs;

#[test]
fn a_pipeline_that_ran_elsewhere_does_not_take_files_of_the_same_names_here_for_its_own() {
    let project = chain();
    project.ran();
    let here = tempfile::tempdir().unwrap();
    fs::write(here.path().join("source.txt"), "1\n").unwrap();
    fs::write(here.path().join("one.txt"), "mine").unwrap();
    let elsewhere = Place { root: here.path().to_owned(), ..project.place() };
    let error = run(&project.pipeline(), &elsewhere, &project.options, &mut |_| {}).unwrap_err();
    assert!(matches!(error, PipelineError::OtherRoot { .. }), "{error}");
    assert!(error.to_string().contains("is of runs in "), "{error}");
    let cleaned = clean(&project.pipeline(), &elsewhere, &[], true, false);
    assert!(cleaned.is_err());
    let mine = fs::read_to_string(here.path().join("one.txt")).unwrap();
    assert_eq!(mine, "mine");
    assert!(project.ran().is_empty());
}

#[test]
fn a_project_that_is_moved_as_a_whole_goes_on() {
    let mut project = chain();
    project.ran();
    let moved = tempfile::tempdir().unwrap();
    for name in ["source.txt", "one.txt", "out", "parts", "state", "logs"] {
        fs::rename(project.path(name), moved.path().join(name)).unwrap();
    }
    project.folder = moved;
    assert!(project.ran().is_empty());
}

#[test]
fn a_ledger_says_from_the_first_stage_on_where_its_pipeline_ran() {
    let stage = "cmd = ['cp', 'state/test.lock', 'seen']\noutputs = ['seen']\n";
    let project = Project::of_stage(stage);
    project.ran();
    let seen = project.read("seen");
    assert!(seen.contains("root = ") && !seen.contains("seen"), "{seen}");
}

/// A stage that makes a file for each line of its source, and one that counts them.
const FOLDER: &str = r#"
name = "test"
[params]
out = "out"
lines = 3
[[stage]]
name = "split"
cmd = ["sh", "-c", "mkdir -p {out}/parts/deep; for i in $(head -n {lines} source.txt); do echo $i > {out}/parts/deep/$i; done; [ ! -e fail ]"]
inputs = ["source.txt"]
outputs = ["{out}/parts"]
[[stage]]
name = "count"
cmd = ["sh", "-c", "ls {out}/parts/deep | wc -l | tr -d ' ' > count-{out}"]
inputs = ["{out}/parts"]
outputs = ["count-{out}"]
"#;

fn folder() -> Project {
    let project = Project::new(FOLDER);
    project.write("source.txt", "1\n2\n3\n4\n");
    project
}

fn set(project: &mut Project, pairs: &[(&str, &str)]) {
    let owned = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
    project.overrides = pairs.iter().map(owned).collect();
}

#[test]
fn runs_into_other_places_never_leave_files_of_former_ones_among_the_new() {
    let mut project = folder();
    project.ran();
    assert_eq!(project.read("count-out"), "3\n");
    set(&mut project, &[("lines", "4")]);
    project.ran();
    assert_eq!(project.read("count-out"), "4\n");
    set(&mut project, &[("lines", "2"), ("out", "other")]);
    project.ran();
    assert_eq!(project.read("count-other"), "2\n");
    set(&mut project, &[]);
    assert_eq!(project.ran(), ["split", "count"]);
    assert_eq!(project.read("count-out"), "3\n");
    // What was made elsewhere is still known, and up to date.
    set(&mut project, &[("lines", "2"), ("out", "other")]);
    assert_eq!(project.ran(), [""; 0]);
}

#[test]
fn a_file_that_no_run_made_is_named_never_deleted_and_never_read() {
    let mut project = folder();
    project.ran();
    project.write("out/parts/deep/notes", "mine");
    let sentence = "`out/parts/deep/notes` was made by no run";
    assert_eq!(project.why("split"), [sentence]);
    let report = project.run();
    assert_eq!(report.outcome, Outcome::Failed);
    assert_eq!(
        report.failures[0].to_string(),
        "stage `split` failed: out/parts/deep/notes in its outputs, made by no run: move it away, \
         or run with --move-aside, which puts it beside with the date"
    );
    // The stage's command would replace what is protected.
    assert_eq!(report.failures[0].repeat, None);
    assert_eq!(in_state(&report, State::Wanted), ["count"]);
    project.options.force = true;
    assert_eq!(project.run().outcome, Outcome::Failed, "force does not remove it");
    project.options.force = false;
    project.options.move_aside = true;
    let report = project.run();
    assert_eq!(report.outcome, Outcome::Done);
    let told = report.warnings[0].to_string();
    let folder = told.rsplit(' ').next().unwrap();
    assert!(folder.starts_with("out/moved-aside-2"), "{told}");
    assert_eq!(project.read(&format!("{folder}/parts/deep/notes")), "mine");
    assert_eq!(project.read("count-out"), "3\n");
    assert!(report.warnings.len() == 1, "{:?}", report.warnings);
}

#[test]
fn a_file_in_the_place_of_an_output_stays_too() {
    let mut project = chain();
    project.write("one.txt", "mine");
    let report = project.run();
    assert!(report.failures[0].to_string().contains("one.txt in its outputs, made by no run"));
    assert_eq!(project.read("one.txt"), "mine");
    project.options.move_aside = true;
    assert_eq!(project.ran(), ["one", "two", "folder"]);
    let aside = fs::read_dir(project.root()).unwrap().flatten();
    let aside = aside.map(|e| e.path()).find(|p| p.to_string_lossy().contains("moved-aside-"));
    assert_eq!(fs::read_to_string(aside.unwrap().join("one.txt")).unwrap(), "mine");
}

#[test]
fn what_a_failed_stage_left_is_its_own_and_what_came_later_is_not() {
    let project = folder();
    project.write("fail", "");
    assert_eq!(project.run().outcome, Outcome::Failed);
    assert_eq!(project.read("out/parts/deep/3"), "3\n");
    project.write("out/parts/deep/notes", "mine");
    project.remove("fail");
    let failure = project.run().failures[0].to_string();
    assert!(failure.contains("out/parts/deep/notes in its outputs"), "{failure}");
    project.remove("out/parts/deep/notes");
    assert_eq!(project.ran(), ["split", "count"]);
}

#[test]
fn what_lies_in_the_folder_of_a_run_that_was_cut_off_is_moved_and_never_deleted() {
    let project = folder();
    fs::create_dir_all(project.path("state")).unwrap();
    fs::create_dir_all(project.path("out/parts/deep")).unwrap();
    // The run before had made one file of this name: that one goes as it always does.
    let begun = "version = 4\npipeline = 'test'\n\
                 [left.'out/parts']\nstage = 'split'\nopen = ['out/parts']\n\
                 [left.'out/parts'.files]\n'out/parts' = ['deep/1']\n";
    project.write("state/test.lock", begun);
    project.write("out/parts/deep/1", "half");
    project.write("out/parts/deep/9", "half");
    project.write("out/parts/notes", "mine");
    let cleaned = clean(&project.pipeline(), &project.place(), &[], false, false).unwrap();
    assert_eq!(cleaned.kept, ["out/parts"]);
    let report = project.run();
    assert_eq!(report.outcome, Outcome::Done, "{:?}", report.failures);
    let told = texts(&report.warnings).join("; ");
    let start =
        "the last run of stage `split` was cut off: what lay in its folders (2 files) is now in ";
    let aside = told.strip_prefix(start).unwrap();
    assert_eq!(project.read(&format!("{aside}/parts/notes")), "mine");
    assert_eq!(project.read(&format!("{aside}/parts/deep/9")), "half");
    assert!(!project.path(&format!("{aside}/parts/deep/1")).exists());
    assert_eq!(project.read("count-out"), "3\n");
}

#[test]
fn an_output_file_of_a_run_that_was_cut_off_is_made_again_without_a_word() {
    let project = chain();
    fs::create_dir_all(project.path("state")).unwrap();
    let begun = "version = 4\npipeline = 'test'\n\
                 [left.'one.txt']\nstage = 'one'\nopen = ['one.txt']\n";
    project.write("state/test.lock", begun);
    project.write("one.txt", "half");
    let report = project.run();
    assert_eq!(report.outcome, Outcome::Done, "{:?}", report.failures);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    assert_eq!(project.read("one.txt"), "1\n2\n1\n");
}

#[test]
fn clean_keeps_what_no_run_made_and_what_was_edited() {
    let project = folder();
    project.ran();
    project.write("out/parts/notes", "mine");
    let clean = |force| clean(&project.pipeline(), &project.place(), &[], force, false).unwrap();
    project.write("out/parts/deep/1", "edited");
    let cleaned = clean(false);
    assert_eq!(cleaned.foreign, ["out/parts/notes"]);
    assert_eq!(
        (cleaned.kept, cleaned.removed),
        (vec!["out/parts".to_owned()], vec!["count-out".to_owned()])
    );
    project.write("out/parts/deep/1", "1\n");
    let cleaned = clean(false);
    assert_eq!(cleaned.removed, ["out/parts"]);
    assert_eq!(project.read("out/parts/notes"), "mine");
    assert!(!project.path("out/parts/deep").exists());
}

#[test]
fn what_a_stage_no_longer_makes_goes_when_it_runs_again() {
    let stage = "cmd = ['touch', 'b', 'd', 'c']\noutputs = ['b', 'c', 'd']\n";
    let mut project = Project::of_stage(stage);
    project.ran();
    project.text = project.text.replace("'b', ", "");
    assert_eq!(project.ran(), ["a"]);
    assert!(!project.path("b").exists());
    assert!(project.path("d").exists());
}

#[test]
fn an_output_of_a_stage_that_is_gone_stays_where_it_is_a_source_now() {
    let mut project = chain();
    project.run();
    let start = project.text.find("[[stage]]\nname = \"one\"").unwrap();
    let end = project.text.find("[[stage]]\nname = \"two\"").unwrap();
    project.text.replace_range(start..end, "");
    let start = project.text.find("[[stage]]\nname = \"folder\"").unwrap();
    project.text.truncate(start);
    project.text += "[[stage]]\nname = 'sum'\ncmd = ['sh', '-c', 'cat parts/* > sum']\n\
                     inputs = ['parts']\noutputs = ['sum']\n";
    // What nothing makes anew is said, with the name of the stage that made it.
    let warnings = texts(&project.run().warnings);
    let said = |reader: &str, path: &str, stage: &str| {
        format!(
            "stage `{reader}` reads `{path}` as it is: stage `{stage}`, which made it, is no longer in the pipeline"
        )
    };
    assert_eq!(warnings, [said("two", "one.txt", "one"), said("sum", "parts", "folder")]);
    assert!(project.path("one.txt").exists() && project.path("parts/1").exists());
}

#[cfg(unix)]
#[test]
fn what_stands_behind_a_link_that_took_the_place_of_an_output_is_never_replaced() {
    for (link, other, output) in
        [("out", "two.txt", "out/two.txt"), ("parts", "1", "parts"), ("one.txt", "", "one.txt")]
    {
        let mut project = chain();
        project.run();
        let elsewhere = tempfile::tempdir().unwrap();
        let target = elsewhere.path().join("target");
        fs::rename(project.path(link), project.path("before")).unwrap();
        let file = if other.is_empty() {
            target.clone()
        } else {
            fs::create_dir(&target).unwrap();
            target.join(other)
        };
        fs::write(&file, "somebody's").unwrap();
        std::os::unix::fs::symlink(&target, project.path(link)).unwrap();
        project.options.keep_going = true;
        let report = project.run();
        assert_eq!(report.failures.len(), 1, "{link}");
        let message = report.failures[0].cause.to_string();
        let start = format!("`{output}` lies behind the link `{link}` to ");
        assert!(message.starts_with(&start) && message.contains("/target,"), "{message}");
        assert_eq!(fs::read_to_string(&file).unwrap(), "somebody's");
        // The outputs themselves may be kept elsewhere.
        if !other.is_empty() {
            fs::remove_dir_all(&target).unwrap();
            fs::rename(project.path("before"), &target).unwrap();
            assert!(project.ran().is_empty());
            project.write("source.txt", "1\n2\n3\n");
            assert_eq!(project.ran(), ["one", "two", "folder"]);
        }
    }
}
