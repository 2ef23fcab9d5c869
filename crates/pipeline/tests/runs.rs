//! Whole runs of small shell pipelines in temporary folders.
#![expect(clippy::unwrap_used, reason = "the helpers of tests are tests, too")]

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use maveric_pipeline::*;

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

    fn root(&self) -> &Path {
        self.folder.path()
    }

    fn place(&self) -> Place {
        Place {
            root: self.root().to_owned(),
            ledger: self.root().join("state/test.lock"),
            log_dir: self.root().join("logs"),
            program: None,
        }
    }

    fn pipeline(&self) -> Pipeline {
        let settings = Settings {
            set: self.overrides.clone(),
            ..Settings::default()
        };
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
        status[0].reasons.iter().map(ToString::to_string).collect()
    }

    fn read(&self, path: &str) -> String {
        fs::read_to_string(self.root().join(path)).unwrap()
    }

    fn write(&self, path: &str, text: &str) {
        fs::write(self.root().join(path), text).unwrap();
    }
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
    assert_eq!(
        project.why("two"),
        ["parameter `word` changed from end to fin"]
    );
    assert_eq!(project.ran(), ["two"]);
    assert!(
        project
            .read("state/test.lock")
            .contains("[run.\"out/two.txt\".set]\nword = \"fin\"")
    );
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
    let parts = fs::read_dir(project.root().join("parts")).unwrap();
    assert_eq!(parts.count(), 2, "the old part 2 must not stay");
}

#[test]
fn an_output_deleted_or_edited_by_hand_is_noticed_and_rebuilt() {
    let project = chain();
    project.ran();
    fs::remove_file(project.root().join("one.txt")).unwrap();
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
fn a_missing_source_is_refused_before_anything_runs() {
    let project = Project::new(&CHAIN.replace("[\"source.txt\"]", "[\"sauce.txt\"]"));
    let error = project.try_run().unwrap_err();
    assert_eq!(
        error.to_string(),
        "stage `one` needs `sauce.txt`, which does not exist and which no stage makes"
    );
    assert_eq!(
        project.why("one")[1],
        "input `sauce.txt` does not exist and no stage makes it"
    );
    assert!(!project.root().join("state").exists());
}

#[test]
fn help_from_the_pipeline_file_says_how_to_get_a_missing_input() {
    let project = Project::new(
        "name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['true']\ninputs = ['data']\n\
         inputs_help = 'download the data from the archive'\n",
    );
    let help = project.try_run().unwrap_err().suggestion();
    assert_eq!(help.as_deref(), Some("download the data from the archive"));
}

#[test]
fn a_stage_may_neither_make_nor_read_the_directory_of_the_ledger() {
    for key in ["inputs", "outputs"] {
        let project = Project::new(&format!(
            "name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['true']\n{key} = ['state']\n"
        ));
        fs::create_dir(project.root().join("state")).unwrap();
        let error = project.try_run().unwrap_err();
        assert!(matches!(error, PipelineError::HoldsOurs { .. }), "{error}");
    }
    let project = Project::new("name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['true']\n");
    let root = project.root().file_name().unwrap().to_str().unwrap();
    let project = Project {
        text: format!("{}outputs = ['../{root}']\n", project.text),
        ..project
    };
    assert!(matches!(
        project.try_run(),
        Err(PipelineError::HoldsOurs { .. })
    ));
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
    assert_eq!(
        failure.to_string(),
        "stage `bad` failed: its program ended with exit status 3"
    );
    assert_eq!(failure.last_lines, ["no such column"]);
    assert!(
        fs::read_to_string(failure.log.as_ref().unwrap())
            .unwrap()
            .contains("no such column")
    );
    let repeated = std::process::Command::new("sh")
        .args(["-c", &failure.repeat])
        .output()
        .unwrap();
    assert_eq!(repeated.status.code(), Some(3));
    assert_eq!(project.why("bad"), ["its last run did not finish"]);
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
    assert!(!project.root().join("after.txt").exists());
}

#[test]
fn a_stage_that_lies_about_its_outputs_fails_and_a_program_that_is_not_there_too() {
    let project = Project::new(
        "name = 'test'\n[[stage]]\nname = 'liar'\ncmd = ['true']\noutputs = ['a', 'b']\n\
         [[stage]]\nname = 'ghost'\ncmd = ['no-such-program-here']\n",
    );
    let mut project = project;
    project.options.keep_going = true;
    let failures: Vec<_> = project
        .run()
        .failures
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(
        failures[0],
        "stage `liar` failed: its program ended well but did not make a, b"
    );
    assert!(failures[1].contains("`no-such-program-here` cannot be started"));
}

#[test]
fn a_stage_without_outputs_runs_once() {
    let project = Project::new("name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['true']\n");
    assert_eq!(project.ran(), ["a"]);
    assert_eq!(project.ran(), [""; 0]);
}

#[test]
fn parallel_stages_overlap_and_make_what_one_at_a_time_makes() {
    // Each of a pair waits for the other's mark, so one at a time could never finish.
    let stage = |name: &str, other: &str| {
        format!(
            "[[stage]]\nname = '{name}'\noutputs = ['{name}.txt']\ncmd = ['sh', '-c', \
             'touch {name}.mark; while [ ! -e {other}.mark ]; do sleep 0.01; done; \
             echo {name} > {name}.txt']\n"
        )
    };
    let join = "[[stage]]\nname = 'join'\ninputs = ['a.txt', 'b.txt']\noutputs = ['c.txt']\n\
                cmd = ['sh', '-c', 'cat a.txt b.txt > c.txt']\n";
    let text = format!(
        "name = 'test'\n{}{}{join}",
        stage("a", "b"),
        stage("b", "a")
    );
    let mut project = Project::new(&text);
    project.options.jobs = Some(2.try_into().unwrap());
    assert_eq!(project.ran(), ["a", "b", "join"]);
    assert_eq!(project.read("c.txt"), "a\nb\n");
    let parallel = Ledger::read(&project.place().ledger, "test").unwrap();
    project.options.jobs = Some(1.try_into().unwrap());
    project.options.force = true;
    assert_eq!(project.ran(), ["a", "b", "join"]);
    let serial = Ledger::read(&project.place().ledger, "test").unwrap();
    for (key, record) in &serial.run {
        assert_eq!(record.digest, parallel.run[key].digest);
        assert_eq!(record.outputs, parallel.run[key].outputs);
    }
}

#[test]
fn an_interrupted_run_goes_on_after_the_last_finished_stage() {
    let text = r#"
name = "test"
[[stage]]
name = "quick"
cmd = ["sh", "-c", "echo 1 > quick.txt"]
outputs = ["quick.txt"]
[[stage]]
name = "slow"
cmd = ["sh", "-c", "echo half > slow.txt; [ -e go ] || sleep 30; cat quick.txt >> slow.txt"]
inputs = ["quick.txt"]
outputs = ["slow.txt"]
"#;
    let mut project = Project::new(text);
    let cancel: Arc<AtomicBool> = Arc::default();
    project.options.cancel = Arc::clone(&cancel);
    let report = std::thread::scope(|scope| {
        let running = scope.spawn(|| project.run());
        while !project.root().join("slow.txt").exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        cancel.store(true, Ordering::Relaxed);
        running.join().unwrap()
    });
    assert_eq!(report.outcome, Outcome::Interrupted);
    assert_eq!(in_state(&report, State::Done), ["quick"]);
    assert_eq!(project.why("slow"), ["its last run did not finish"]);
    cancel.store(false, Ordering::Relaxed);
    project.write("go", "");
    assert_eq!(project.ran(), ["slow"]);
    assert_eq!(project.read("slow.txt"), "half\n1\n");
}

#[test]
fn two_runs_at_once_are_refused() {
    let text =
        "name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['sh', '-c', 'touch begun; sleep 30']\n";
    let project = Project::new(text);
    std::thread::scope(|scope| {
        let first = scope.spawn(|| project.run());
        while !project.root().join("begun").exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        let second = project.try_run();
        project.options.cancel.store(true, Ordering::Relaxed);
        assert!(matches!(second, Err(PipelineError::Busy { .. })));
        assert_eq!(first.join().unwrap().outcome, Outcome::Interrupted);
    });
}

#[test]
fn our_program_counts_by_the_version_of_its_command_and_not_by_its_path() {
    let text =
        "name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['tool', 'a.txt']\noutputs = ['a.txt']\n";
    let project = Project::new(text);
    let run_with = |path: &str, version: &str| {
        let versions = [("a.txt".to_owned(), version.to_owned())].into();
        let program = Program {
            name: "tool".to_owned(),
            path: path.into(),
            leading: Vec::new(),
            versions,
        };
        let place = Place {
            program: Some(program),
            ..project.place()
        };
        run(&project.pipeline(), &place, &project.options, &mut |_| {}).unwrap()
    };
    let touch = "/usr/bin/touch";
    assert_eq!(in_state(&run_with(touch, "1"), State::Done), ["a"]);
    assert_eq!(
        in_state(&run_with("/elsewhere/tool", "1"), State::UpToDate),
        ["a"]
    );
    let report = run_with(touch, "2");
    assert_eq!(
        report.stages[0].reasons[0].to_string(),
        "`tool a.txt` changed from version 1 to 2"
    );
}

#[test]
fn a_program_of_an_interpreter_gets_its_leading_arguments_before_the_stages() {
    let project = Project::new(
        "name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['tool', 'a.txt']\noutputs = ['a.txt']\n",
    );
    let place = Place {
        program: Some(Program {
            name: "tool".to_owned(),
            path: "/bin/sh".into(),
            leading: ["-c", "echo $1 > $1", "-"].map(str::to_owned).into(),
            versions: [("a.txt".to_owned(), "1".to_owned())].into(),
        }),
        ..project.place()
    };
    let report = run(&project.pipeline(), &place, &project.options, &mut |_| {}).unwrap();
    assert_eq!(in_state(&report, State::Done), ["a"]);
}

#[test]
fn a_command_that_our_program_does_not_have_is_refused_with_the_one_that_was_meant() {
    let project = Project::new("name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['tool', 'trian']\n");
    let place = Place {
        program: Some(Program {
            name: "tool".to_owned(),
            path: "/bin/true".into(),
            leading: Vec::new(),
            versions: [("train".to_owned(), "1".to_owned())].into(),
        }),
        ..project.place()
    };
    let error = status(&project.pipeline(), &place).unwrap_err();
    assert_eq!(error.suggestion().as_deref(), Some("did you mean `train`?"));
}

#[test]
fn events_come_in_order_with_their_reasons_and_lines() {
    let project = Project::new(
        "name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['sh', '-c', 'echo working >&2']\n",
    );
    let mut heard = Vec::new();
    let mut observe = |event: Event<'_>| {
        heard.push(match event {
            Event::Started { stage, reasons, .. } => format!("{stage} starts: {}", reasons[0]),
            Event::Line { stage, line } => format!("{stage}: {line}"),
            Event::Finished {
                settled, wanted, ..
            } => format!("{settled} of {wanted}"),
            other => format!("{other:?}"),
        });
    };
    run(
        &project.pipeline(),
        &project.place(),
        &project.options,
        &mut observe,
    )
    .unwrap();
    let expected = [
        "a starts: there is no record of a finished run",
        "a: working",
        "1 of 1",
    ];
    assert_eq!(heard, expected);
}

#[test]
fn a_damaged_ledger_is_left_as_it_is() {
    let project = chain();
    project.ran();
    project.write("state/test.lock", "damaged");
    assert!(matches!(
        project.try_run(),
        Err(PipelineError::LedgerDamaged { .. })
    ));
    assert_eq!(project.read("state/test.lock"), "damaged");
    fs::remove_file(project.place().ledger).unwrap();
    let project = Project {
        options: RunOptions {
            move_aside: true,
            ..RunOptions::default()
        },
        ..project
    };
    assert_eq!(project.ran(), ["one", "two", "folder"]);
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
    assert_eq!(in_state(&report, State::Wanted), ["count"]);
    project.options.force = true;
    assert_eq!(
        project.run().outcome,
        Outcome::Failed,
        "force does not remove it"
    );
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
    assert!(
        report.failures[0]
            .to_string()
            .contains("one.txt in its outputs, made by no run")
    );
    assert_eq!(project.read("one.txt"), "mine");
    project.options.move_aside = true;
    assert_eq!(project.ran(), ["one", "two", "folder"]);
    let aside = fs::read_dir(project.root()).unwrap().flatten();
    let aside = aside
        .map(|e| e.path())
        .find(|p| p.to_string_lossy().contains("moved-aside-"));
    assert_eq!(
        fs::read_to_string(aside.unwrap().join("one.txt")).unwrap(),
        "mine"
    );
}

#[test]
fn what_a_failed_stage_left_is_its_own_and_what_came_later_is_not() {
    let project = folder();
    project.write("fail", "");
    assert_eq!(project.run().outcome, Outcome::Failed);
    assert_eq!(project.read("out/parts/deep/3"), "3\n");
    project.write("out/parts/deep/notes", "mine");
    fs::remove_file(project.root().join("fail")).unwrap();
    let failure = project.run().failures[0].to_string();
    assert!(
        failure.contains("out/parts/deep/notes in its outputs"),
        "{failure}"
    );
    fs::remove_file(project.root().join("out/parts/deep/notes")).unwrap();
    assert_eq!(project.ran(), ["split", "count"]);
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
    assert!(!project.root().join("out/parts/deep").exists());
}

#[test]
fn what_a_stage_no_longer_makes_goes_when_it_runs_again() {
    let text = |outputs: &str| {
        format!(
            "name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['touch', 'b', 'd', 'c']\noutputs = {outputs}\n"
        )
    };
    let mut project = Project::new(&text("['b', 'c', 'd']"));
    project.ran();
    project.text = text("['c', 'd']").replace("'b', ", "");
    assert_eq!(project.ran(), ["a"]);
    assert!(!project.root().join("b").exists());
    assert!(project.root().join("d").exists());
}

#[cfg(unix)]
#[test]
fn a_name_that_is_no_text_is_an_error() {
    use std::os::unix::ffi::OsStrExt;
    let project =
        Project::new("name = 'test'\n[[stage]]\nname = 'a'\ncmd = ['true']\ninputs = ['data']\n");
    fs::create_dir(project.root().join("data")).unwrap();
    let name = std::ffi::OsStr::from_bytes(b"data/\xff.csv");
    fs::write(project.root().join(name), "").unwrap();
    let error = project.try_run().unwrap_err();
    assert!(error.to_string().contains("is not UTF-8 text"), "{error}");
}

#[test]
fn a_stage_is_tried_again_as_often_as_it_may() {
    let text = |retries: u32| {
        format!(
            "name = 'test'\n[[stage]]\nname = 'a'\nretries = {retries}\noutputs = ['a']\n\
             cmd = ['sh', '-c', 'echo x >> a; echo x >> tries; [ $(wc -l < tries) -ge 3 ]']\n"
        )
    };
    let mut project = Project::new(&text(1));
    let report = project.run();
    assert_eq!(report.failures.len(), 1);
    assert_eq!(project.read("tries"), "x\nx\n");
    project.text = text(2);
    let mut heard = Vec::new();
    let mut observe = |event: Event<'_>| {
        if let Event::Retried {
            cause,
            retry,
            retries,
            ..
        } = event
        {
            heard.push(format!("{cause} ({retry} of {retries})"));
        }
    };
    fs::remove_file(project.root().join("tries")).unwrap();
    let (pipeline, place) = (project.pipeline(), project.place());
    let report = run(&pipeline, &place, &project.options, &mut observe).unwrap();
    assert_eq!(report.outcome, Outcome::Done);
    let said = "its program ended with exit status 1";
    assert_eq!(
        heard,
        [format!("{said} (1 of 2)"), format!("{said} (2 of 2)")]
    );
    assert_eq!(project.read("a"), "x\n", "each try starts clean");
}

#[test]
fn stages_run_at_once_only_as_long_as_there_is_memory_for_all_of_them() {
    // Each notes how many run beside it.
    let text = "name = 'test'\n[[stage]]\nname = 'a'\nmatrix = { i = [1, 2, 3, 4] }\n\
                cmd = ['sh', '-c', 'touch on.{i}; sleep 0.1; ls on.* | wc -l > seen.{i}; sleep 0.1; rm on.{i}']\n\
                outputs = ['seen.{i}']\nresources = { memory_mb = 60 }\n";
    for (memory, most) in [(100, 1), (130, 2), (10, 1)] {
        let mut project = Project::new(text);
        project.options.jobs = Some(4.try_into().unwrap());
        project.options.memory_mb = Some(memory);
        assert_eq!(project.ran().len(), 4);
        let seen = (1..=4).map(|i| project.read(&format!("seen.{i}")));
        let seen = seen.map(|text| text.trim().parse::<u32>().unwrap()).max();
        assert!(seen <= Some(most), "{memory} MiB: {seen:?} at once");
    }
}

#[cfg(unix)]
#[test]
fn what_a_stage_left_running_does_not_keep_the_next_run_out() {
    let text = "name = 'test'\n[[stage]]\nname = 'a'\noutputs = ['pid']\n\
                cmd = ['sh', '-c', 'sleep 100 <&0 >/dev/null 2>&1 & echo $! > pid']\n";
    let project = Project::new(text);
    assert_eq!(project.ran(), ["a"]);
    assert_eq!(project.ran(), [""; 0]);
    let pid = project.read("pid");
    let alive = std::process::Command::new("kill").arg(pid.trim()).status();
    assert!(alive.unwrap().success(), "it was still there");
}

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
    let findings = verify(&project.pipeline(), &project.place())
        .unwrap()
        .findings;
    let states: Vec<_> = findings
        .iter()
        .map(|f| (f.path.as_str(), f.state))
        .collect();
    assert_eq!(states, [("rows/cities.txt", FileState::NoLongerMade)]);
    let report = project.run();
    assert_eq!(in_state(&report, State::Done), ["table"]);
    let warnings: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
    let warning = "the pipeline no longer has stage `row.cities` there: `rows/cities.txt` removed";
    assert_eq!(warnings, [warning]);
    assert_eq!(project.read("table.txt"), "moby\npride\n0\n1\n");
    assert!(!project.root().join("rows/cities.txt").exists());
    assert!(
        verify(&project.pipeline(), &project.place())
            .unwrap()
            .findings
            .is_empty()
    );
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
    assert!(
        warning.contains("`rows/cities.txt` changed by hand"),
        "{warning}"
    );
    assert_eq!(project.read("rows/cities.txt"), "mine\n");
    project.options.move_aside = true;
    project.run();
    assert!(!project.root().join("rows/cities.txt").exists());
    assert_eq!(project.read("table.txt"), "moby\npride\n0\n1\n");
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
    let warnings = project.run().warnings;
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    let said = |reader: &str, path: &str, stage: &str| {
        format!(
            "stage `{reader}` reads `{path}` as it is: stage `{stage}`, which made it, is no longer in the pipeline"
        )
    };
    assert_eq!(
        warnings,
        [
            said("two", "one.txt", "one"),
            said("sum", "parts", "folder")
        ]
    );
    assert!(project.root().join("one.txt").exists() && project.root().join("parts/1").exists());
}

#[cfg(unix)]
#[test]
fn what_stands_behind_a_link_that_took_the_place_of_an_output_is_never_replaced() {
    for (link, other, output) in [
        ("out", "two.txt", "out/two.txt"),
        ("parts", "1", "parts"),
        ("one.txt", "", "one.txt"),
    ] {
        let mut project = chain();
        project.run();
        let elsewhere = tempfile::tempdir().unwrap();
        let target = elsewhere.path().join("target");
        fs::rename(project.root().join(link), project.root().join("before")).unwrap();
        let file = if other.is_empty() {
            target.clone()
        } else {
            fs::create_dir(&target).unwrap();
            target.join(other)
        };
        fs::write(&file, "somebody's").unwrap();
        std::os::unix::fs::symlink(&target, project.root().join(link)).unwrap();
        project.options.keep_going = true;
        let report = project.run();
        assert_eq!(report.failures.len(), 1, "{link}");
        let message = report.failures[0].cause.to_string();
        let start = format!("`{output}` lies behind the link `{link}` to ");
        assert!(
            message.starts_with(&start) && message.contains("/target,"),
            "{message}"
        );
        assert_eq!(fs::read_to_string(&file).unwrap(), "somebody's");
        // The outputs themselves may be kept elsewhere.
        if !other.is_empty() {
            fs::remove_dir_all(&target).unwrap();
            fs::rename(project.root().join("before"), &target).unwrap();
            assert!(project.ran().is_empty());
            project.write("source.txt", "1\n2\n3\n");
            assert_eq!(project.ran(), ["one", "two", "folder"]);
        }
    }
}

#[test]
fn a_trace_says_that_what_it_traces_was_edited_since() {
    let project = chain();
    project.run();
    let ledger = Ledger::read(&project.place().ledger, "test").unwrap();
    let lines = || {
        trace(&ledger, &project.place(), "out/two.txt")
            .unwrap()
            .lines()
    };
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
        RunDifference {
            only_first,
            only_second,
            stages,
            same,
        }
        .lines()[1]
            .clone()
    };
    assert_eq!(line(0), "  a.csv: has other texts");
    assert_eq!(
        line(3),
        "  a.csv: all 3 numbers are the same, other parts differ"
    );
}
