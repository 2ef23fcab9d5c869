//! What a command gives back, and how it is watched while it works.

use crate::error::StudyError;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};

/// A command's result: the value, a few lines for people, and what was left out.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome<T> {
    /// What was computed or written.
    #[serde(flatten)]
    pub value: T,
    /// The result in a few lines.
    #[serde(skip)]
    pub summary: Vec<String>,
    /// Each thing that was left out, repaired or doubtful, in a sentence.
    pub warnings: Vec<String>,
}

impl<T> Outcome<T> {
    pub(crate) fn new(value: T, summary: Vec<String>, warnings: Vec<String>) -> Self {
        Self { value, summary, warnings }
    }

    /// The same of what `of` makes of the value.
    pub(crate) fn map<U>(self, of: impl FnOnce(T) -> U) -> Outcome<U> {
        Outcome::new(of(self.value), self.summary, self.warnings)
    }
}

/// How far long work has come: `done` of `total` steps, and what the step is.
pub type Progress<'a> = dyn Fn(usize, usize, &str) + Sync + 'a;

/// Watches long work: is told how far it has come, and can stop it.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    progress: &'a Progress<'a>,
    cancel: &'a AtomicBool,
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch").field("cancel", self.cancel).finish_non_exhaustive()
    }
}

impl<'a> Watch<'a> {
    /// Reports to `progress`; stops soon after `cancel` becomes true.
    pub fn new(progress: &'a Progress<'a>, cancel: &'a AtomicBool) -> Self {
        Self { progress, cancel }
    }

    /// Tells how far the work has come.
    ///
    /// # Errors
    /// [`StudyError::Interrupted`] if the work should stop.
    pub fn step(&self, done: usize, total: usize, what: &str) -> Result<(), StudyError> {
        (self.progress)(done, total, what);
        self.check()
    }

    /// Whether to go on.
    ///
    /// # Errors
    /// [`StudyError::Interrupted`] if the work should stop.
    pub fn check(&self) -> Result<(), StudyError> {
        if self.cancel.load(Ordering::Relaxed) { Err(StudyError::Interrupted) } else { Ok(()) }
    }
}

impl Watch<'static> {
    /// Of work that nobody watches and that goes on to its end.
    pub fn unwatched() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self::new(&|_, _, _| (), &NEVER)
    }
}

/// Threads to use when none are asked for: all cores.
pub fn all_cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Most threads of a command: more than any machine has cores, and fewer than exhaust it.
const MOST_JOBS: usize = 1024;

/// Stack of each of these threads: one that waits for polars, which has threads of its own, takes up the next item meanwhile, on top of the one
/// that waits. Two megabytes, which is usual, were too little once on a machine with much else to do.
const STACK_BYTES: usize = 32 << 20;

/// Threads to work on; 0 for as many as there are cores.
///
/// # Errors
/// [`StudyError::NotPossible`] for more than 1024, or if the system has no more.
pub(crate) fn threads(jobs: usize) -> Result<rayon::ThreadPool, StudyError> {
    if jobs > MOST_JOBS {
        let problem = format!("{jobs} threads, expected at most {MOST_JOBS}");
        let help = "leave out -j: then there are as many threads as cores";
        return Err(StudyError::not_possible(problem).with_help(help));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).stack_size(STACK_BYTES);
    pool.build().map_err(|e| {
        StudyError::not_possible(format!("cannot start {jobs} threads: {e}"))
            .with_help("ask for fewer with -j")
    })
}

/// Runs `work` on each item on `jobs` threads; results come in the items' order.
///
/// # Errors
/// The first error in the items' order, or [`StudyError::Interrupted`].
pub(crate) fn for_each_on<I: Sync, T: Send>(
    jobs: usize,
    items: &[I],
    watch: Watch<'_>,
    what: &str,
    work: impl Fn(&I) -> Result<T, StudyError> + Sync,
) -> Result<Vec<T>, StudyError> {
    use rayon::prelude::*;
    use std::sync::atomic::AtomicUsize;
    let done = AtomicUsize::new(0);
    let one = |item: &I| {
        watch.check()?;
        let result = work(item)?;
        watch.step(done.fetch_add(1, Ordering::Relaxed) + 1, items.len(), what)?;
        Ok(result)
    };
    let results: Vec<Result<T, StudyError>> =
        threads(jobs)?.install(|| items.par_iter().map(one).collect());
    results.into_iter().collect()
}

/// How a result is printed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// Lines for people
    #[default]
    Text,
    /// One JSON object
    Json,
}
