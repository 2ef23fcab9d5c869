//! A stage's process with all that it starts, as one thing that can be ended.

use std::process::{Child, Command};

/// All processes of a stage.
pub(super) struct Group {
    #[cfg(unix)]
    id: nix::unistd::Pid,
    /// Ends its processes when it goes: also with a run that is killed. Nothing where the system refused it.
    #[cfg(windows)]
    job: Option<win32job::Job>,
}

#[cfg(unix)]
impl Group {
    /// Makes what the command will start a group of its own: Ctrl-C reaches us alone, and we end the stage with all its children.
    pub(super) fn begin(command: &mut Command) {
        std::os::unix::process::CommandExt::process_group(command, 0);
    }

    /// The group of a child that was begun so.
    pub(super) fn new(child: &Child) -> Self {
        Self { id: nix::unistd::Pid::from_raw(child.id().cast_signed()) }
    }

    /// Asks all to end.
    pub(super) fn ask_to_end(&self) {
        let _ = nix::sys::signal::killpg(self.id, nix::sys::signal::SIGTERM);
    }

    /// Ends all, at once. Of a dead child, its children may live.
    pub(super) fn kill(self) {
        let _ = nix::sys::signal::killpg(self.id, nix::sys::signal::SIGKILL);
    }
}

#[cfg(windows)]
impl Group {
    /// As on other systems; without a group of its own a child would hear Ctrl-C as well.
    pub(super) fn begin(command: &mut Command) {
        const CREATE_NEW_PROCESS_GROUP: u32 = 0x200;
        std::os::windows::process::CommandExt::creation_flags(command, CREATE_NEW_PROCESS_GROUP);
    }

    pub(super) fn new(child: &Child) -> Self {
        let mut limits = win32job::ExtendedLimitInfo::new();
        limits.limit_kill_on_job_close();
        let job = win32job::Job::create_with_limit_info(&limits);
        let handle = std::os::windows::io::AsRawHandle::as_raw_handle(child) as isize;
        let job = job.and_then(|job| job.assign_process(handle).map(|()| job));
        Self { job: job.ok() }
    }

    /// Nobody can be asked here. Results only ever appear whole, so that nothing is lost.
    pub(super) fn ask_to_end(&self) {}

    pub(super) fn kill(self) {
        drop(self.job);
    }
}
