//! Stages and runs beside each other, and runs that are watched or end early.

use crate::{Project, in_state};
use maveric_pipeline::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

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
    let text = format!("name = 'test'\n{}{}{join}", stage("a", "b"), stage("b", "a"));
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
fn stages_run_at_once_only_as_long_as_there_is_memory_for_all_of_them() {
    // Each notes how many run beside it.
    let stage = "matrix = { i = [1, 2, 3, 4] }\n\
                cmd = ['sh', '-c', 'touch on.{i}; sleep 0.1; ls on.* | wc -l > seen.{i}; sleep 0.1; rm on.{i}']\n\
                outputs = ['seen.{i}']\nresources = { memory_mb = 60 }\n";
    for (memory, most) in [(100, 1), (130, 2), (10, 1)] {
        let mut project = Project::of_stage(stage);
        project.options.jobs = Some(4.try_into().unwrap());
        project.options.memory_mb = Some(memory);
        assert_eq!(project.ran().len(), 4);
        let seen = (1..=4).map(|i| project.read(&format!("seen.{i}")));
        let seen = seen.map(|text| text.trim().parse::<u32>().unwrap()).max();
        assert!(seen <= Some(most), "{memory} MiB: {seen:?} at once");
    }
}

#[test]
fn two_runs_at_once_are_refused() {
    let project = Project::of_stage("cmd = ['sh', '-c', 'touch begun; sleep 30']\n");
    std::thread::scope(|scope| {
        let first = scope.spawn(|| project.run());
        while !project.path("begun").exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        let second = project.try_run();
        project.options.cancel.store(true, Ordering::Relaxed);
        assert!(matches!(second, Err(PipelineError::Busy { .. })));
        assert_eq!(first.join().unwrap().outcome, Outcome::Interrupted);
    });
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
        while !project.path("slow.txt").exists() {
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

#[cfg(unix)]
#[test]
fn what_a_stage_left_running_does_not_keep_the_next_run_out() {
    let project = Project::of_stage(
        "outputs = ['pid']\n\
         cmd = ['sh', '-c', 'sleep 100 <&0 >/dev/null 2>&1 & echo $! > pid']\n",
    );
    assert_eq!(project.ran(), ["a"]);
    assert_eq!(project.ran(), [""; 0]);
    let pid = project.read("pid");
    let alive = std::process::Command::new("kill").arg(pid.trim()).status();
    assert!(alive.unwrap().success(), "it was still there");
}

#[test]
fn events_come_in_order_with_their_reasons_and_lines() {
    let project = Project::of_stage("cmd = ['sh', '-c', 'echo working >&2']\n");
    let mut heard = Vec::new();
    let mut observe = |event: Event<'_>| {
        heard.push(match event {
            Event::Started { stage, reasons, .. } => format!("{stage} starts: {}", reasons[0]),
            Event::Line { stage, line } => format!("{stage}: {line}"),
            Event::Finished { settled, wanted, .. } => format!("{settled} of {wanted}"),
            other => format!("{other:?}"),
        });
    };
    let (pipeline, place) = (project.pipeline(), project.place());
    run(&pipeline, &place, &project.options, &mut observe).unwrap();
    let expected = ["a starts: there is no record of a finished run", "a: working", "1 of 1"];
    assert_eq!(heard, expected);
}
