//! A stage that is one of our own programs ends with the run that started it, also where that was killed.

use std::process::Command;

/// What the environment of a stage calls the process of its run.
const RUN: &str = "MAVERIC_RUN_PROCESS";

/// Tells what the command will start which process runs it, and since which start of which machine.
pub(super) fn tell(command: &mut Command) {
    command.env(RUN, format!("{} {}", std::process::id(), boot()));
}

/// A word that is another at each start of each machine; empty where the system has none.
fn boot() -> String {
    let id = std::fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    id.trim().to_owned()
}

/// To be called by a program at its start: where a run has just started it, the system asks it to end (SIGTERM) when that run is no more.
/// False where the run was killed in this very moment: then there is nothing to do.
///
/// Linux alone can be asked for it; on Windows the run's job does it, elsewhere the next run ends what the journal names.
pub fn end_with_run() -> bool {
    let word = std::env::var(RUN).unwrap_or_default();
    let (run, started) = word.split_once(' ').unwrap_or((&word, ""));
    run.parse().map_or(true, |run| follow(run, started))
}

#[cfg(target_os = "linux")]
fn follow(run: i32, started: &str) -> bool {
    use nix::{
        sys::{prctl::set_pdeathsig, signal::Signal},
        unistd::{Pid, getpgrp, getpid, getppid},
    };
    let is_alive = std::path::Path::new(&format!("/proc/{run}")).exists();
    let run = Pid::from_raw(run);
    // Whatever a stage starts inherits the word: through a shell, on another machine, or left running on purpose. That is not ours to end.
    if getppid() != run {
        // What a run itself starts leads a group: then the run was killed before this line.
        let is_stage = getpgrp() == getpid() && started == boot();
        return is_alive || !is_stage;
    }
    let _ = set_pdeathsig(Signal::SIGTERM);
    // It may have died before it was asked for.
    getppid() == run
}

#[cfg(not(target_os = "linux"))]
fn follow(_: i32, _: &str) -> bool {
    true
}
