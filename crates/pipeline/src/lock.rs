//! One run at a time on one ledger.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::PipelineError;

/// Stages that were just killed hold the lock until the system has cleared them away.
const TRIES: u32 = 25;
/// Stages of a run that was killed outright notice it, or end their work, and let go then.
const TRIES_AFTER_A_DEAD_RUN: u32 = 500;
const BETWEEN_TRIES: Duration = Duration::from_millis(10);

/// The right to change a ledger and the outputs that it describes.
///
/// The system releases the lock with the last process that holds it, so a dead one cannot
/// keep it. The file stays: deleting it would let two runs lock two files of one name.
#[derive(Debug)]
pub(crate) struct RunLock {
    path: PathBuf,
    file: File,
}

impl RunLock {
    /// Takes the lock, or says who has it.
    pub(crate) fn acquire(path: PathBuf) -> Result<Self, PipelineError> {
        let failed = || PipelineError::io("lock", &path);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(failed())?;
        }
        let mut file = OpenOptions::new()
            .create(true)
            .truncate(false)
            .read(true)
            .write(true)
            .open(&path)
            .map_err(failed())?;
        let mut tries = 1;
        while let Err(error) = file.try_lock() {
            match error {
                TryLockError::Error(error) => return Err(failed()(error)),
                TryLockError::WouldBlock if tries >= TRIES => {
                    let pid = pid_in(&path);
                    match pid.filter(|pid| !is_alive(*pid)) {
                        None => return Err(PipelineError::Busy { path, pid }),
                        Some(pid) if tries >= TRIES_AFTER_A_DEAD_RUN => {
                            return Err(PipelineError::StageLeftAtWork { path, pid });
                        }
                        Some(_) => std::thread::sleep(BETWEEN_TRIES),
                    }
                }
                TryLockError::WouldBlock => std::thread::sleep(BETWEEN_TRIES),
            }
            tries += 1;
        }
        file.set_len(0).and_then(|()| writeln!(file, "{}", std::process::id())).map_err(failed())?;
        Ok(Self { path, file })
    }

    /// Gives the lock back although processes that a stage left behind may still hold it: its
    /// run is over, and what they are is no stage any more.
    pub(crate) fn release(&self) {
        let _ = self.file.unlock(); // at worst it goes with the last of them
    }

    /// The lock as a child's standard input, which reads as empty.
    ///
    /// A run that is killed outright thus leaves the lock to the stages that still write,
    /// and the next run does not start beside them.
    pub(crate) fn as_stdin(&self) -> Result<File, PipelineError> {
        let failed = || PipelineError::io("lock", &self.path);
        let mut file = self.file.try_clone().map_err(failed())?;
        file.seek(SeekFrom::End(0)).map_err(failed())?;
        Ok(file)
    }
}

/// Whether there is a process of this number; where that cannot be known it counts as alive.
#[cfg(unix)]
fn is_alive(pid: u32) -> bool {
    use nix::{errno::Errno, sys::signal::kill, unistd::Pid};
    kill(Pid::from_raw(pid.cast_signed()), None) != Err(Errno::ESRCH)
}

#[cfg(not(unix))]
fn is_alive(_pid: u32) -> bool {
    true
}

fn pid_in(path: &Path) -> Option<u32> {
    std::fs::read_to_string(path).ok()?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_run_is_told_who_holds_the_lock() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.running");
        let held = RunLock::acquire(path.clone()).unwrap();
        match RunLock::acquire(path.clone()).unwrap_err() {
            // Elsewhere what is locked cannot be read.
            PipelineError::Busy { pid, .. } if cfg!(unix) => {
                assert_eq!(pid, Some(std::process::id()));
            }
            PipelineError::Busy { .. } => {}
            other => panic!("{other}"),
        }
        drop(held);
        assert!(RunLock::acquire(path).is_ok());
    }

    #[test]
    fn the_file_of_a_dead_process_holds_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.running");
        std::fs::write(&path, "1234567\n").unwrap();
        assert!(RunLock::acquire(path).is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn the_next_run_waits_for_what_a_killed_run_left_at_work() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.running");
        let mut gone = std::process::Command::new("true").spawn().unwrap();
        gone.wait().unwrap();
        let held = RunLock::acquire(path.clone()).unwrap();
        let mut stage = std::process::Command::new("sleep")
            .arg("0.6")
            .stdin(held.as_stdin().unwrap())
            .spawn()
            .unwrap();
        drop(held);
        // As if the run that began the stage had been another process, which is no more.
        std::fs::write(&path, format!("{}\n", gone.id())).unwrap();
        let next = RunLock::acquire(path.clone());
        assert!(next.is_ok(), "{next:?}");
        assert_eq!(pid_in(&path), Some(std::process::id()));
        stage.wait().unwrap();
    }

    #[test]
    fn a_stage_that_was_left_behind_keeps_the_lock_and_reads_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.running");
        let held = RunLock::acquire(path.clone()).unwrap();
        let mut child = std::process::Command::new("sh")
            .args(["-c", "cat; exec sleep 20"])
            .stdin(held.as_stdin().unwrap())
            .stdout(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        drop(held);
        assert!(RunLock::acquire(path.clone()).is_err());
        child.kill().unwrap();
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.stdout, b"");
        assert!(RunLock::acquire(path).is_ok());
    }
}
