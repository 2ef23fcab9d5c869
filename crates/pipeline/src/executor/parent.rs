//! A stage that is one of our own programs ends with the run that started it, also where that was killed.

use std::process::Command;

/// What the environment of a stage calls the process of its run.
const RUN: &str = "MAVERIC_RUN_PROCESS";

/// Tells what the command will start which process runs it.
pub(super) fn tell(command: &mut Command) {
    command.env(RUN, std::process::id().to_string());
}

/// To be called by a program at its start: where a run has just started it, the system asks it to end (SIGTERM) when that run is no more.
/// False where the run was killed in this very moment: then there is nothing to do.
///
/// Linux alone can be asked for it; on Windows the run's job does it, elsewhere the next run ends what the journal names.
pub fn end_with_run() -> bool {
    let run = std::env::var(RUN).ok();
    run.and_then(|run| run.parse().ok()).is_none_or(follow)
}

#[cfg(target_os = "linux")]
fn follow(run: i32) -> bool {
    use nix::{
        sys::{prctl::set_pdeathsig, signal::Signal},
        unistd::{Pid, getppid},
    };
    let run = Pid::from_raw(run);
    // Whatever a stage starts inherits the word: through a shell, on another machine, or left running on purpose. That is not ours to end.
    if getppid() != run {
        return true;
    }
    let _ = set_pdeathsig(Signal::SIGTERM);
    // It may have died before it was asked for.
    getppid() == run
}

#[cfg(not(target_os = "linux"))]
fn follow(_: i32) -> bool {
    true
}
