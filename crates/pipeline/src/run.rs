//! Bringing a pipeline up to date: each stage as soon as what it needs is there.

use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::time::Duration;

use crate::attempt::{Attempt, News, Workshop};
use crate::cache::Cache;
use crate::cluster::{Follower, refuse_while_jobs_run};
use crate::content::Hasher;
use crate::ledger::{self, OpenLedger};
use crate::lock::RunLock;
use crate::schedule::Schedule;
use crate::{Event, Executor, Graph, Pipeline, PipelineError, Place, RunOptions, RunReport};

/// How often the cancel flag is looked at.
const TICK: Duration = Duration::from_millis(20);

/// Brings the targets and everything upstream up to date.
///
/// A stage runs if its command line, parameters, program version or inputs are not those of
/// its last good run, or if its outputs are not what that run left. What happens is
/// noted at once, so that an interrupted run goes on where it stopped.
///
/// # Errors
/// As [`plan`](crate::plan), [`PipelineError::Busy`] if another run is at work on the
/// ledger, or if the ledger or a log cannot be written. A stage that fails is no error but
/// part of the report.
pub fn run(
    pipeline: &Pipeline,
    place: &Place,
    options: &RunOptions,
    observe: &mut dyn FnMut(Event<'_>),
) -> Result<RunReport, PipelineError> {
    let graph = Graph::new(pipeline)?;
    place.check(pipeline)?;
    let wanted = graph.wanted(&options.targets)?;
    graph.check_sources(&wanted, place)?;
    let forced = crate::status::forced(&graph, &options.targets, options.force)?;
    let lock = RunLock::acquire(place.lock())?;
    let loaded = ledger::load_at(place, pipeline.name())?;
    let mut ledger = OpenLedger::new(place.ledger.clone(), loaded)?;
    ledger.forget_gone(pipeline.stages(), place);
    std::fs::create_dir_all(&place.log_dir).map_err(PipelineError::io("create", &place.log_dir))?;
    let stop = AtomicBool::new(false);
    let workshop = Workshop {
        pipeline,
        place,
        hasher: Hasher::new(&place.root, place.hash_cache(), &stop),
        ledger: Mutex::new(ledger),
        cache: options.cache.as_deref().map(Cache::open).transpose()?,
        move_aside: options.move_aside,
        replaced: Mutex::default(),
        lock,
        stop: &stop,
    };
    let mut schedule = Schedule::new(&graph, wanted);
    let result = match options.executor {
        Executor::Local => refuse_while_jobs_run(place, &mut workshop.ledger(), &workshop.hasher),
        _ => Ok(()),
    };
    let orphans_removed = result.and_then(|()| {
        crate::orphans::remove(&graph, place, &mut workshop.ledger(), options.move_aside)
    });
    let result = orphans_removed.and_then(|warnings| {
        for warning in warnings {
            schedule.warn(warning, observe);
        }
        match options.executor {
            Executor::Local => work(&workshop, &mut schedule, &forced, options, observe),
            engine => Follower::new(engine, &workshop, &graph, &forced, options)?
                .follow(&mut schedule, observe),
        }
    });
    if let Some(warning) = workshop.warning() {
        schedule.warn(warning, observe);
    }
    // Also after an error: what is done is done.
    let folded = workshop.ledger().fold();
    workshop.hasher.save();
    workshop.lock.release();
    result?;
    folded?;
    Ok(schedule.report(place))
}

enum Message {
    News(usize, News),
    Ended(usize, Result<Attempt, PipelineError>),
}

/// Hands ready stages to workers until there are none, or none may be begun.
fn work(
    workshop: &Workshop<'_>,
    schedule: &mut Schedule<'_>,
    forced: &BTreeSet<usize>,
    options: &RunOptions,
    observe: &mut dyn FnMut(Event<'_>),
) -> Result<(), PipelineError> {
    let graph = schedule.graph;
    let jobs = options.jobs.map_or(1, NonZeroUsize::get);
    let jobs = jobs.min(schedule.wanted.len());
    let (to_workers, orders) = mpsc::channel::<usize>();
    let orders = Mutex::new(orders);
    let (to_us, messages) = mpsc::channel();
    let worker = |to_us: mpsc::Sender<Message>| {
        let next = || orders.lock().unwrap_or_else(PoisonError::into_inner).recv();
        while let Ok(index) = next() {
            // The receiver outlives the workers, so nothing told is lost.
            let mut tell = |news| drop(to_us.send(Message::News(index, news)));
            let (stage, forced) = (graph.stage(index), forced.contains(&index));
            let result = match workshop.attempt(graph, stage, forced, &mut tell) {
                Err(PipelineError::Interrupted) => Ok(Attempt::Interrupted),
                result => result,
            };
            let _ = to_us.send(Message::Ended(index, result));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            let to_us = to_us.clone();
            scope.spawn(|| worker(to_us));
        }
        let mut error = None;
        let mut running = 0;
        let memory_of = |index: usize| graph.stage(index).resources.memory_mb.map_or(0, u64::from);
        let memory = options.memory_mb.or_else(crate::memory::of_this_machine);
        let mut in_use = 0;
        loop {
            if options.cancel.load(Ordering::Relaxed) {
                schedule.interrupted = true;
                workshop.stop.store(true, Ordering::Relaxed);
            }
            let halted = error.is_some()
                || schedule.interrupted
                || (!schedule.failures.is_empty() && !options.keep_going);
            while !halted && running < jobs {
                let fits = |index: usize| {
                    running == 0 || memory.is_none_or(|all| in_use + memory_of(index) <= all)
                };
                let Some(index) = schedule.begin_next(fits) else {
                    break;
                };
                // Most stages are up to date in most runs: not worth a worker.
                if !forced.contains(&index) && workshop.is_known_up_to_date(graph.stage(index)) {
                    schedule.settle(index, Attempt::UpToDate, observe);
                } else {
                    running += usize::from(to_workers.send(index).is_ok());
                    in_use += memory_of(index);
                }
            }
            if running == 0 {
                break;
            }
            match messages.recv_timeout(TICK) {
                Ok(Message::News(index, news)) => schedule.hear(index, news, observe),
                Ok(Message::Ended(index, result)) => {
                    running -= 1;
                    in_use -= memory_of(index);
                    match result {
                        Ok(attempt) => schedule.settle(index, attempt, observe),
                        Err(failed) => {
                            workshop.stop.store(true, Ordering::Relaxed);
                            error.get_or_insert(failed);
                        }
                    }
                }
                Err(_) => {} // nothing new: look at the flag again
            }
        }
        drop(to_workers);
        error.map_or(Ok(()), Err)
    })
}
