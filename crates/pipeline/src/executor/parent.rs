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
    let process = run;
    let run = Pid::from_raw(run);
    // Whatever a stage starts inherits the word: through a shell, on another machine, or left running on purpose. That is not ours to end.
    if getppid() != run {
        // What a run itself starts leads a group: then the run was killed before this line.
        let is_stage = getpgrp() == getpid() && started == boot();
        return is_alive(process) || !is_stage;
    }
    let _ = set_pdeathsig(Signal::SIGTERM);
    // It may have died before it was asked for.
    getppid() == run
}

/// Whether the process is there and not dead: a dead one stays in the list (`Z`, then `X`) until its own parent has asked how it ended.
#[cfg(target_os = "linux")]
fn is_alive(process: i32) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    // "id (name) state ...": a name may hold brackets and spaces.
    let state = stat.rsplit_once(") ").and_then(|(_, rest)| rest.bytes().next());
    state.is_some_and(|state| !matches!(state, b'Z' | b'X'))
}

#[cfg(not(target_os = "linux"))]
fn follow(_: i32, _: &str) -> bool {
    true
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::is_alive;

    #[test]
    fn a_process_that_has_ended_and_was_not_asked_how_is_not_alive() {
        assert!(is_alive(std::process::id().cast_signed()));
        let mut child = std::process::Command::new("sleep").arg("60").spawn().unwrap();
        let id = child.id().cast_signed();
        assert!(is_alive(id));
        child.kill().unwrap();
        while is_alive(id) {
            std::thread::yield_now();
        }
        // It is still in the list, as nobody has asked for its end.
        assert!(std::path::Path::new(&format!("/proc/{id}")).exists());
        child.wait().unwrap();
        assert!(!is_alive(id));
    }
}
