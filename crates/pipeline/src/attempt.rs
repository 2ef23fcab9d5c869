//! One stage from its check to its record in the ledger.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::check::Past;
use crate::content::Hasher;
use crate::executor::{Ended, Job, local};
use crate::ledger::OpenLedger;
use crate::lock::RunLock;
use crate::{
    Failure, FailureCause, Manifest, Pipeline, PipelineError, Place, Reason, Record, Stage,
};

/// What all stages of a run share.
pub(crate) struct Workshop<'a> {
    pub(crate) pipeline: &'a Pipeline,
    pub(crate) place: &'a Place,
    pub(crate) hasher: Hasher<'a>,
    pub(crate) ledger: Mutex<OpenLedger>,
    pub(crate) lock: RunLock,
    pub(crate) stop: &'a AtomicBool,
}

/// How an attempt at a stage ended.
pub(crate) enum Attempt {
    UpToDate,
    Done { seconds: f64 },
    Failed(Failure),
    Interrupted,
}

/// What is heard of a stage on the way.
pub(crate) enum News {
    Started { reasons: Vec<Reason> },
    Line(String),
}

impl Workshop<'_> {
    /// Runs a stage whose upstream stages are done, unless it is up to date.
    ///
    /// # Errors
    /// If files of ours cannot be read or written; a stage that fails is no error here.
    pub(crate) fn attempt(
        &self,
        stage: &Stage,
        forced: bool,
        tell: &mut dyn FnMut(News),
    ) -> Result<Attempt, PipelineError> {
        match self.attempt_or_stop(stage, forced, tell) {
            Err(PipelineError::Interrupted) => Ok(Attempt::Interrupted),
            other => other,
        }
    }

    fn attempt_or_stop(
        &self,
        stage: &Stage,
        forced: bool,
        tell: &mut dyn FnMut(News),
    ) -> Result<Attempt, PipelineError> {
        let made_from = Manifest::of(stage, self.place.program.as_ref(), &self.hasher)?;
        let found: Vec<&str> = made_from
            .facts(crate::FactKind::Input)
            .map(|(path, _)| path)
            .collect();
        let not_made = stage
            .inputs
            .iter()
            .filter(|path| !found.contains(&path.as_str()));
        let paths: Vec<String> = not_made.cloned().collect();
        if !paths.is_empty() {
            let cause = FailureCause::InputsMissing { paths };
            return Ok(Attempt::Failed(self.failure(
                stage,
                cause,
                Vec::new(),
                None,
            )));
        }
        let past = Past::of(stage, self.ledger().get());
        let mut reasons = past.reasons(stage, &made_from, &self.hasher)?;
        if forced {
            reasons.insert(0, Reason::Forced);
        }
        if reasons.is_empty() {
            return Ok(Attempt::UpToDate);
        }
        tell(News::Started { reasons });
        self.ledger().begin(&stage.name, &stage.outputs)?;
        self.clear(stage, &past)?;
        let started = Instant::now();
        let ended = self.execute(stage, tell)?;
        let seconds = started.elapsed().as_secs_f64();
        match ended {
            Ended::Interrupted => Ok(Attempt::Interrupted),
            Ended::NotStarted(error) => {
                let cause = FailureCause::NotStarted {
                    program: self.program(stage).display().to_string(),
                    message: error.to_string(),
                };
                Ok(Attempt::Failed(self.failure(
                    stage,
                    cause,
                    Vec::new(),
                    Some(seconds),
                )))
            }
            Ended::Exited {
                status,
                stdout,
                last_lines,
            } => {
                let cause = match exit_cause(status) {
                    Some(cause) => Some(cause),
                    None => self.record(stage, made_from, seconds, &stdout)?,
                };
                Ok(match cause {
                    None => Attempt::Done { seconds },
                    Some(cause) => {
                        Attempt::Failed(self.failure(stage, cause, last_lines, Some(seconds)))
                    }
                })
            }
        }
    }

    /// Enters a good run into the ledger, or says which outputs it did not make.
    fn record(
        &self,
        stage: &Stage,
        made_from: Manifest,
        seconds: f64,
        stdout: &str,
    ) -> Result<Option<FailureCause>, PipelineError> {
        let mut outputs = std::collections::BTreeMap::new();
        let mut paths = Vec::new();
        for output in &stage.outputs {
            match self.hasher.content(output)? {
                Some(content) => drop(outputs.insert(output.clone(), content)),
                None => paths.push(output.clone()),
            }
        }
        if !paths.is_empty() {
            return Ok(Some(FailureCause::OutputsMissing { paths }));
        }
        if stage.summary {
            let path = self.place.stdout_of(&stage.name);
            fs::write(&path, stdout).map_err(PipelineError::io("write", path))?;
        }
        let overrides = self.pipeline.overrides().iter();
        let record = Record {
            digest: made_from.digest(),
            seconds: (seconds * 1e3).round() / 1e3,
            set: overrides
                .filter(|(name, _)| stage.params.contains_key(*name))
                .map(|(name, value)| (name.clone(), value.clone()))
                .collect(),
            made_from,
            outputs,
        };
        self.ledger().finish(&stage.name, record)?;
        Ok(None)
    }

    /// Makes room for the outputs: what the last run made goes, so that a stage that makes
    /// fewer files leaves no old ones among the new; what is not ours stays.
    fn clear(&self, stage: &Stage, past: &Past) -> Result<(), PipelineError> {
        for output in &stage.outputs {
            let full = self.place.root.join(output);
            if past.made(output) {
                remove(&full).map_err(PipelineError::io("remove the old", &full))?;
            }
            if let Some(folder) = full.parent() {
                fs::create_dir_all(folder).map_err(PipelineError::io("create", folder))?;
            }
        }
        remove(&self.place.stdout_of(&stage.name))
            .map_err(PipelineError::io("remove the old", &self.place.log_dir))
    }

    fn execute(&self, stage: &Stage, tell: &mut dyn FnMut(News)) -> Result<Ended, PipelineError> {
        let path = self.place.log_of(&stage.name);
        let failed = || PipelineError::io("write the log", &path);
        let mut log = File::create(&path).map_err(failed())?;
        writeln!(log, "$ {}", self.command_line(stage)).map_err(failed())?;
        let program = self.program(stage);
        let job = Job {
            program: &program,
            arguments: &stage.command[1..],
            root: &self.place.root,
            stdin: self.lock.as_stdin()?,
            log,
        };
        local::run(job, self.stop, &mut |line| tell(News::Line(line))).map_err(failed())
    }

    fn program(&self, stage: &Stage) -> PathBuf {
        match &self.place.program {
            Some(program) if program.name == stage.command[0] => program.path.clone(),
            _ => PathBuf::from(&stage.command[0]),
        }
    }

    /// The command that repeats the stage alone, from anywhere.
    fn command_line(&self, stage: &Stage) -> String {
        let program = self.program(stage).to_string_lossy().into_owned();
        let words = std::iter::once(&program).chain(&stage.command[1..]);
        let root = fs::canonicalize(&self.place.root).unwrap_or_else(|_| self.place.root.clone());
        let root = crate::shell::quoted([root.to_string_lossy()]);
        format!("cd {root} && {}", crate::shell::quoted(words))
    }

    fn failure(
        &self,
        stage: &Stage,
        cause: FailureCause,
        last_lines: Vec<String>,
        seconds: Option<f64>,
    ) -> Failure {
        Failure {
            stage: stage.name.clone(),
            cause,
            last_lines,
            repeat: self.command_line(stage),
            log: seconds.map(|_| self.place.log_of(&stage.name)),
            seconds,
        }
    }

    fn ledger(&self) -> MutexGuard<'_, OpenLedger> {
        // A panic elsewhere leaves the ledger as its last whole state.
        self.ledger.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Removes a file, a link or a whole directory; nothing there is fine.
fn remove(path: &Path) -> std::io::Result<()> {
    let result = match fs::symlink_metadata(path) {
        Ok(metadata) if metadata.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(error) => Err(error),
    };
    match result {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

fn exit_cause(status: ExitStatus) -> Option<FailureCause> {
    #[cfg(unix)]
    let signal = std::os::unix::process::ExitStatusExt::signal(&status);
    #[cfg(not(unix))]
    let signal = None;
    match status.code() {
        Some(0) => None,
        Some(code) => Some(FailureCause::Exit { code }),
        None => Some(FailureCause::Killed { signal }),
    }
}
