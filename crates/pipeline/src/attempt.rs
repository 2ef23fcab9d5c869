//! One stage from its check to its record in the ledger.

mod outputs;

use path_slash::PathExt as _;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::process::ExitStatus;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::cache::Cache;
use crate::check::{Past, Present};
use crate::content::Hasher;
use crate::executor::{Ended, Job, local};
use crate::ledger::OpenLedger;
use crate::lock::RunLock;
use crate::shell::typed;
use crate::{
    Failure, FailureCause, Graph, Manifest, Pipeline, PipelineError, Place, Reason, Setting, Stage,
    Warning,
};

/// What all stages of a run share.
pub(crate) struct Workshop<'a> {
    pub(crate) pipeline: &'a Pipeline,
    pub(crate) place: &'a Place,
    pub(crate) hasher: Hasher<'a>,
    pub(crate) ledger: Mutex<OpenLedger>,
    pub(crate) cache: Option<Cache>,
    /// Whether files that no run made are moved out of the way.
    pub(crate) move_aside: bool,
    /// Parameters of former results that are no more.
    pub(crate) replaced: Mutex<BTreeSet<Setting>>,
    pub(crate) lock: RunLock,
    pub(crate) stop: &'a AtomicBool,
}

/// How an attempt at a stage ended.
pub(crate) enum Attempt {
    UpToDate,
    Restored,
    Done {
        seconds: f64,
        peak_memory: Option<u64>,
    },
    Failed(Failure),
    Interrupted,
    /// It was handed in and taken back with what it waited for.
    TakenBack,
}

/// How one try of a stage ended.
enum Tried {
    Ended(Attempt),
    Failed { cause: FailureCause, last_lines: Vec<String>, seconds: f64 },
}

/// What is heard of a stage on the way.
pub(crate) enum News {
    Started { reasons: Vec<Reason> },
    Line(String),
    Warning(Warning),
    Retried { cause: FailureCause, retry: u32 },
}

/// Whether a stage must run.
pub(crate) enum Examined {
    /// It need not, or cannot.
    Settled(Attempt),
    /// There is room for its outputs.
    Stale { now: Present, reasons: Vec<Reason> },
}

/// A run of a stage that ended well, to be entered into the ledger.
pub(crate) struct Run<'a> {
    pub(crate) made_from: Manifest,
    pub(crate) seconds: f64,
    pub(crate) peak_memory: Option<u64>,
    pub(crate) stdout: &'a str,
}

impl Workshop<'_> {
    /// Runs a stage whose upstream stages are done, unless it is up to date.
    ///
    /// # Errors
    /// If files of ours cannot be read or written, or the run was interrupted meanwhile; a stage that fails is no error here.
    pub(crate) fn attempt(
        &self,
        graph: &Graph<'_>,
        stage: &Stage,
        forced: bool,
        tell: &mut dyn FnMut(News),
    ) -> Result<Attempt, PipelineError> {
        let (now, reasons) = match self.examine(graph, stage, forced, tell)? {
            Examined::Settled(attempt) => return Ok(attempt),
            Examined::Stale { now, reasons } => (now, reasons),
        };
        tell(News::Started { reasons });
        let mut retry = 0;
        loop {
            self.begin(stage)?;
            let tried = self.try_once(stage, &now, tell);
            if matches!(tried, Err(PipelineError::Interrupted)) {
                self.leave(stage)?; // while what it made was read
            }
            let (cause, last_lines, seconds) = match tried? {
                Tried::Ended(attempt) => return Ok(attempt),
                Tried::Failed { cause, last_lines, seconds } => (cause, last_lines, seconds),
            };
            self.leave(stage)?;
            let is_final = matches!(
                cause,
                FailureCause::NotStarted { .. } | FailureCause::InputsChanged { .. }
            );
            if retry == stage.retries || is_final {
                let failure = self.failure(stage, &now.files, cause, last_lines, Some(seconds));
                return Ok(Attempt::Failed(failure));
            }
            retry += 1;
            tell(News::Retried { cause, retry });
        }
    }

    /// Runs a stage, for whose outputs there is room, once.
    fn try_once(
        &self,
        stage: &Stage,
        now: &Present,
        tell: &mut dyn FnMut(News),
    ) -> Result<Tried, PipelineError> {
        let started = Instant::now();
        let ended = self.execute(stage, &now.files, tell)?;
        let seconds = started.elapsed().as_secs_f64();
        let failed = |cause, last_lines| Tried::Failed { cause, last_lines, seconds };
        Ok(match ended {
            Ended::Interrupted => {
                self.leave(stage)?;
                Tried::Ended(Attempt::Interrupted)
            }
            Ended::TimedOut { last_lines } => {
                let minutes = stage.resources.minutes.unwrap_or_default();
                failed(FailureCause::TimedOut { minutes }, last_lines)
            }
            Ended::NotStarted(error) => {
                let cause = FailureCause::NotStarted {
                    program: self.place.program_of(stage).to_slash_lossy().into_owned(),
                    message: match error.kind() {
                        ErrorKind::ArgumentListTooLong if stage.share.is_some() => {
                            format!("{error}: a shard has too many files, so use more `shards`")
                        }
                        _ => error.to_string(),
                    },
                };
                failed(cause, Vec::new())
            }
            Ended::Exited { status, peak_memory, stdout, last_lines } => {
                if let Some(cause) = exit_cause(status) {
                    return Ok(failed(cause, last_lines));
                }
                let run =
                    Run { made_from: now.made_from.clone(), seconds, peak_memory, stdout: &stdout };
                match self.record(stage, run, tell)? {
                    None => Tried::Ended(Attempt::Done { seconds, peak_memory }),
                    Some(cause) => failed(cause, last_lines),
                }
            }
        })
    }

    /// Whether a stage is seen to be up to date without reading any file.
    pub(crate) fn is_known_up_to_date(&self, stage: &Stage) -> bool {
        let hasher = self.hasher.remembering();
        let Ok(now) = Present::look(stage, self.place, &hasher) else {
            return false;
        };
        let ledger = self.ledger();
        let record = ledger.get().record_of(stage);
        now.missing.is_empty()
            && record.is_some_and(|record| {
                let same = |output: &String| {
                    let content = hasher.content(output).ok().flatten();
                    content.is_some() && content.as_ref() == record.outputs.get(output)
                };
                record.made_from == now.made_from && stage.outputs.iter().all(same)
            })
    }

    /// Holds a stage against the ledger and the files as they are; of one that is stale, makes room for its outputs or takes them from
    /// the cache.
    pub(crate) fn examine(
        &self,
        graph: &Graph<'_>,
        stage: &Stage,
        forced: bool,
        tell: &mut dyn FnMut(News),
    ) -> Result<Examined, PipelineError> {
        let now = self.look(stage)?;
        if !now.missing.is_empty() {
            let paths = now.missing.clone();
            let cause = FailureCause::InputsMissing { paths };
            let failure = self.failure(stage, &now.files, cause, Vec::new(), None);
            return Ok(Examined::Settled(Attempt::Failed(failure)));
        }
        let past = Past::in_ledger(stage, self.ledger().get());
        let mut reasons = past.reasons(stage, &now.made_from, &self.hasher)?;
        if forced {
            reasons.insert(0, Reason::Forced);
        }
        if reasons.is_empty() {
            return Ok(Examined::Settled(Attempt::UpToDate));
        }
        if let Some(failure) = self.make_room(graph, stage, &now.files, tell)? {
            return Ok(Examined::Settled(Attempt::Failed(failure)));
        }
        self.note_replaced(&past, &reasons);
        Ok(if !forced && self.restore(stage, &now, tell)? {
            Examined::Settled(Attempt::Restored)
        } else {
            Examined::Stale { now, reasons }
        })
    }

    /// A stage as it is now.
    pub(crate) fn look(&self, stage: &Stage) -> Result<Present, PipelineError> {
        Present::look(stage, self.place, &self.hasher)
    }

    /// What the run has to say at its end: the settings of former results that it replaced.
    pub(crate) fn warning(&self) -> Option<Warning> {
        let replaced = self.replaced.lock().unwrap_or_else(PoisonError::into_inner);
        let changes: Vec<Setting> = replaced.iter().cloned().collect();
        (!changes.is_empty()).then_some(Warning::Replaced { changes })
    }

    /// Remembers which settings of the last run are no longer those of this one.
    fn note_replaced(&self, past: &Past, reasons: &[Reason]) {
        let Some(record) = &past.record else { return };
        let overrides = self.pipeline.overrides();
        for reason in reasons {
            if let Reason::ParameterChanged { name, before: Some(before), now: Some(now) } = reason
                && (overrides.contains_key(name) || record.set.contains_key(name))
            {
                let mut replaced = self.replaced.lock().unwrap_or_else(PoisonError::into_inner);
                replaced.insert(Setting {
                    name: name.clone(),
                    before: before.clone(),
                    now: now.clone(),
                });
            }
        }
    }

    fn execute(
        &self,
        stage: &Stage,
        files: &[String],
        tell: &mut dyn FnMut(News),
    ) -> Result<Ended, PipelineError> {
        let path = self.place.log_of(&stage.name);
        let failed = || PipelineError::io("write the log", &path);
        let mut log = File::create(&path).map_err(failed())?;
        writeln!(log, "$ {}", self.command_line(stage, files)).map_err(failed())?;
        let program = self.place.program_of(stage);
        let job = Job {
            program: &program,
            arguments: &self.place.arguments_of(stage, files),
            root: &self.place.root,
            stdin: self.lock.as_stdin()?,
            limit: stage.resources.minutes.map(|n| Duration::from_mins(n.into())),
            log,
        };
        local::run(job, self.stop, &mut |line| tell(News::Line(line))).map_err(failed())
    }

    /// The command that repeats the stage alone, from anywhere.
    fn command_line(&self, stage: &Stage, files: &[String]) -> String {
        let program = self.place.program_of(stage).to_string_lossy().into_owned();
        let arguments = self.place.arguments_of(stage, files);
        let words = std::iter::once(&program).chain(&arguments);
        let root =
            std::path::absolute(&self.place.root).unwrap_or_else(|_| self.place.root.clone());
        // `cd` of `cmd` stays on its drive.
        let go = if cfg!(windows) { "pushd" } else { "cd" };
        let root = typed([root.to_string_lossy()]);
        format!("{go} {root} && {}", typed(words))
    }

    pub(crate) fn failure(
        &self,
        stage: &Stage,
        files: &[String],
        cause: FailureCause,
        last_lines: Vec<String>,
        seconds: Option<f64>,
    ) -> Failure {
        let repeat = (!cause.is_before_start()).then(|| self.command_line(stage, files));
        Failure {
            stage: stage.name.clone(),
            cause,
            last_lines,
            repeat,
            log: seconds.map(|_| self.place.log_of(&stage.name)),
            seconds,
        }
    }

    pub(crate) fn ledger(&self) -> MutexGuard<'_, OpenLedger> {
        // A panic elsewhere leaves the ledger as its last whole state.
        self.ledger.lock().unwrap_or_else(PoisonError::into_inner)
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
