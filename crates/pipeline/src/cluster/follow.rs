//! Following what was handed in, and handing in what has become possible.

mod ended;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::ending::Ending;
use super::engine;
use super::jobs::{Jobs, Task};
use super::submit::{Candidate, submit};
use crate::attempt::{Attempt, Examined, Workshop};
use crate::schedule::Schedule;
use crate::{Event, Executor, FailureCause, Graph, PipelineError, Reason, RunOptions};
use ended::was_open;

/// Between two looks: the first, and the longest.
const LOOKS: [Duration; 2] = [Duration::from_millis(100), Duration::from_secs(3)];
/// How long the cluster may not answer.
const SILENCE: Duration = Duration::from_mins(2);

/// Where a stage stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Standing {
    /// Not decided.
    Open,
    OnCluster,
    Settled,
    /// It failed, or needs one that did.
    Dead,
}

/// Brings the wanted stages up to date on a cluster. What was handed in goes on if this
/// process ends, and the next run follows it again.
pub(crate) struct Follower<'a> {
    workshop: &'a Workshop<'a>,
    graph: &'a Graph<'a>,
    forced: &'a BTreeSet<usize>,
    options: &'a RunOptions,
    jobs: Jobs,
    standing: Vec<Standing>,
    depth: Vec<usize>,
    /// Since when a task is gone without a word.
    gone: BTreeMap<String, Instant>,
    /// Tasks that had told how they ended at the last look.
    told: BTreeSet<(std::path::PathBuf, u32)>,
    heard: Instant,
}

impl<'a> Follower<'a> {
    pub(crate) fn new(
        engine: Executor,
        workshop: &'a Workshop<'a>,
        graph: &'a Graph<'a>,
        forced: &'a BTreeSet<usize>,
        options: &'a RunOptions,
    ) -> Result<Self, PipelineError> {
        let file = workshop.place.jobs();
        let jobs = match Jobs::read(&file)? {
            Some(jobs) if jobs.engine == engine => jobs,
            _ => {
                let ledger = &mut workshop.ledger();
                super::refuse_while_jobs_run(workshop.place, ledger, &workshop.hasher)?;
                Jobs::new(engine, file)
            }
        };
        let mut depth = vec![0; graph.order().len()];
        for &index in graph.order() {
            let makers = graph.needs(index).iter().map(|need| depth[need.maker] + 1);
            depth[index] = makers.max().unwrap_or(0);
        }
        Ok(Self {
            workshop,
            graph,
            forced,
            options,
            jobs,
            standing: vec![Standing::Open; depth.len()],
            depth,
            gone: BTreeMap::new(),
            told: BTreeSet::new(),
            heard: Instant::now(),
        })
    }

    pub(crate) fn follow(
        mut self,
        schedule: &mut Schedule<'_>,
        observe: &mut dyn FnMut(Event<'_>),
    ) -> Result<(), PipelineError> {
        let resumed = self.resume(schedule)?;
        if resumed > 0 {
            observe(Event::Resumed { stages: resumed });
        }
        let mut pause = LOOKS[0];
        loop {
            let moved = self.look(schedule, observe)?;
            if schedule.interrupted || !self.standing.contains(&Standing::OnCluster) {
                return self.tidy_up();
            }
            pause = if moved { LOOKS[0] } else { pause.mul_f64(1.3).min(LOOKS[1]) };
            let until = Instant::now() + pause;
            while Instant::now() < until {
                if self.options.cancel.load(Ordering::Relaxed) {
                    schedule.interrupted = true;
                    return Ok(()); // what was handed in goes on
                }
                std::thread::sleep(LOOKS[0].min(until.saturating_duration_since(Instant::now())));
            }
        }
    }

    /// Without its script, a copy of a task that still runs somewhere leaves no trace.
    fn tidy_up(&mut self) -> Result<(), PipelineError> {
        let place = self.workshop.place;
        self.jobs.compact()?;
        if self.jobs.tasks.is_empty() {
            let _ = fs::remove_dir_all(super::spools(place));
        }
        Ok(())
    }

    /// Takes over what an earlier run handed in; what is no longer wanted so is taken back.
    fn resume(&mut self, schedule: &mut Schedule<'_>) -> Result<usize, PipelineError> {
        let graph = self.graph;
        let mut tasks = std::mem::take(&mut self.jobs.tasks);
        let mut given_up: BTreeSet<usize> = BTreeSet::new();
        let mut dropped: Vec<Task> = Vec::new();
        let mut resumed = 0;
        // Makers first: the cluster would take a task back with one that it waits for.
        for &index in graph.order() {
            let name = &graph.stage(index).name;
            let Some(task) = tasks.remove(name) else {
                continue;
            };
            let waits = graph.makers(index).iter().any(|m| given_up.contains(m));
            if !waits
                && schedule.wanted.contains(&index)
                && !task.job.is_empty()
                && self.is_same(index, &task)
            {
                self.standing[index] = Standing::OnCluster;
                schedule.submitted(index, Vec::new());
                self.jobs.tasks.insert(name.clone(), task);
                resumed += 1;
            } else {
                given_up.insert(index);
                dropped.push(task);
            }
        }
        dropped.extend(tasks.into_values()); // of stages that the pipeline no longer has
        for task in &dropped {
            self.give_up(task)?;
        }
        let mut dropped: BTreeSet<String> = dropped.into_iter().map(|task| task.job).collect();
        let kept = self.jobs.jobs();
        dropped.retain(|job| !job.is_empty() && !kept.contains(job));
        engine::cancel(self.jobs.engine, &dropped);
        self.jobs.compact()?;
        Ok(resumed)
    }

    fn give_up(&self, task: &Task) -> Result<(), PipelineError> {
        let workshop = self.workshop;
        task.give_up(&mut workshop.ledger(), &workshop.hasher)
    }

    /// Whether a stage would be handed in again just as it was.
    fn is_same(&self, index: usize, task: &Task) -> bool {
        let stage = self.graph.stage(index);
        let now = self.workshop.look(stage);
        now.is_ok_and(|now| {
            now.made_from.without_inputs(|path| was_open(stage, task, path)) == task.made_from
        })
    }

    /// Settles what has ended and hands in what can be; whether anything happened.
    fn look(
        &mut self,
        schedule: &mut Schedule<'_>,
        observe: &mut dyn FnMut(Event<'_>),
    ) -> Result<bool, PipelineError> {
        // Asked before the endings are read: a task that ends in between is not missed.
        let alive = self.alive()?;
        self.told = self.jobs.ended();
        let mut moved = false;
        let mut candidates = Vec::new();
        let mut going: BTreeSet<usize> = BTreeSet::new();
        let graph = self.graph;
        for &index in graph.order() {
            if !schedule.wanted.contains(&index) {
                continue;
            }
            match self.standing[index] {
                Standing::OnCluster => {
                    moved |= self.settle(index, alive.as_ref(), schedule, observe)?;
                }
                Standing::Open => {
                    let halted = !schedule.failures.is_empty() && !self.options.keep_going;
                    let candidate = self.decide(index, &going, halted, schedule, observe)?;
                    if let Some(candidate) = candidate {
                        going.insert(index);
                        candidates.push(candidate);
                    }
                    moved |= self.standing[index] != Standing::Open;
                }
                Standing::Settled | Standing::Dead => {}
            }
        }
        if candidates.is_empty() {
            return Ok(moved);
        }
        for candidate in &mut candidates {
            self.standing[candidate.index] = Standing::OnCluster;
            schedule.submitted(candidate.index, std::mem::take(&mut candidate.reasons));
        }
        let at_once = self.options.jobs.map(std::num::NonZeroUsize::get);
        submit(self.workshop, self.graph, &mut self.jobs, candidates, at_once, observe)?;
        Ok(true)
    }

    /// What to do with a stage that is not on the cluster.
    fn decide(
        &mut self,
        index: usize,
        going: &BTreeSet<usize>,
        halted: bool,
        schedule: &mut Schedule<'_>,
        observe: &mut dyn FnMut(Event<'_>),
    ) -> Result<Option<Candidate>, PipelineError> {
        let stage = self.graph.stage(index);
        let makers = self.graph.makers(index);
        let stands = |maker: &usize| match self.standing[*maker] {
            Standing::Open if going.contains(maker) => Standing::OnCluster,
            standing => standing,
        };
        if halted || makers.iter().any(|maker| stands(maker) == Standing::Dead) {
            self.standing[index] = Standing::Dead;
            return Ok(None);
        }
        let depth = self.depth[index];
        if makers.iter().all(|maker| stands(maker) == Standing::Settled) {
            let forced = self.forced.contains(&index);
            let mut tell = |news| schedule.hear(index, news, observe);
            let examined = self.workshop.examine(self.graph, stage, forced, &mut tell)?;
            return match examined {
                Examined::Settled(attempt) => {
                    self.close(index, attempt, schedule, observe);
                    Ok(None)
                }
                Examined::Stale { now, reasons } => {
                    Ok(Some(Candidate { index, now, reasons, depth }))
                }
            };
        }
        if makers.iter().any(|maker| stands(maker) == Standing::Open) {
            return Ok(None);
        }
        // HyperQueue orders tasks within a job only; and which files a shard gets is known
        // when they are there.
        let in_this_job =
            |maker: &usize| stands(maker) == Standing::Settled || going.contains(maker);
        let across = self.jobs.engine == Executor::Slurm || makers.iter().all(in_this_job);
        if stage.share.is_some() || !across {
            return Ok(None);
        }
        let now = self.workshop.look(stage)?;
        let mut tell = |news| schedule.hear(index, news, observe);
        let room = self.workshop.make_room(self.graph, stage, &now.files, &mut tell)?;
        if let Some(failure) = room {
            self.close(index, Attempt::Failed(failure), schedule, observe);
            return Ok(None);
        }
        let waits = |maker: &&usize| stands(maker) == Standing::OnCluster;
        let families: BTreeSet<&String> =
            makers.iter().filter(waits).map(|&maker| &self.graph.stage(maker).family).collect();
        let reason = |stage: &String| Reason::Upstream { stage: stage.clone() };
        Ok(Some(Candidate {
            index,
            now,
            reasons: families.into_iter().map(reason).collect(),
            depth,
        }))
    }

    /// The tasks that wait or run; `None` while the cluster does not answer.
    fn alive(&mut self) -> Result<Option<BTreeSet<String>>, PipelineError> {
        let jobs = self.jobs.jobs();
        if jobs.is_empty() {
            self.heard = Instant::now();
            return Ok(Some(BTreeSet::new()));
        }
        match engine::alive(self.jobs.engine, &jobs) {
            Ok(alive) => {
                self.heard = Instant::now();
                Ok(Some(alive))
            }
            Err(error) if self.heard.elapsed() > SILENCE => Err(error),
            Err(_) => Ok(None),
        }
    }

    /// Looks whether a stage on the cluster has ended.
    fn settle(
        &mut self,
        index: usize,
        alive: Option<&BTreeSet<String>>,
        schedule: &mut Schedule<'_>,
        observe: &mut dyn FnMut(Event<'_>),
    ) -> Result<bool, PipelineError> {
        let stage = self.graph.stage(index);
        let Some(task) = self.jobs.tasks.get(&stage.name) else {
            return Ok(false);
        };
        let has_ended = self.told.contains(&(task.spool.clone(), task.index));
        if !has_ended && alive.is_none_or(|alive| alive.contains(&task.id())) {
            self.gone.remove(&stage.name);
            return Ok(false);
        }
        let task = task.clone();
        let makers = self.graph.needs(index).iter().map(|need| need.maker);
        let standings: Vec<Standing> = makers.map(|maker| self.standing[maker]).collect();
        let ended = has_ended.then(|| Ending::read(&task.spool, task.index));
        let ended = ended.flatten();
        let ended = ended.filter(|_| !standings.contains(&Standing::OnCluster));
        let attempt = if let Some(ended) = ended {
            let mut tell = |news| schedule.hear(index, news, observe);
            self.ended(index, &task, &ended, &mut tell)?
        } else {
            if standings.contains(&Standing::Dead) {
                // The cluster took it back with what it waited for.
                self.give_up(&task)?;
                self.jobs.settle(&stage.name)?;
                self.standing[index] = Standing::Dead;
                schedule.settle(index, Attempt::TakenBack, observe);
                return Ok(true);
            }
            let since = *self.gone.entry(stage.name.clone()).or_insert_with(Instant::now);
            if since.elapsed() < self.options.lost_after || standings.contains(&Standing::OnCluster)
            {
                return Ok(false);
            }
            self.give_up(&task)?;
            let cause = FailureCause::JobLost {
                job: task.id(),
                state: engine::last_state(self.jobs.engine, &task.id()),
            };
            let log = self.keep_log(stage, &task)?;
            Attempt::Failed(self.workshop.failure(stage, &[], cause, log, Some(0.0)))
        };
        self.jobs.settle(&stage.name)?;
        self.close(index, attempt, schedule, observe);
        Ok(true)
    }

    fn close(
        &mut self,
        index: usize,
        attempt: Attempt,
        schedule: &mut Schedule<'_>,
        observe: &mut dyn FnMut(Event<'_>),
    ) {
        let good = !matches!(attempt, Attempt::Failed(_) | Attempt::Interrupted);
        self.standing[index] = if good { Standing::Settled } else { Standing::Dead };
        schedule.settle(index, attempt, observe);
    }
}
