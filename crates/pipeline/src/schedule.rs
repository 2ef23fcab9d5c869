//! Where each stage of a run stands, and which one may be begun next.

use std::collections::BTreeSet;

use crate::attempt::{Attempt, News};
use crate::{
    Event, Failure, Graph, Outcome, Place, RunReport, StageResult, State, Summary, Warning,
};

/// Where each stage stands.
pub(crate) struct Schedule<'g> {
    pub(crate) graph: &'g Graph<'g>,
    pub(crate) wanted: BTreeSet<usize>,
    results: Vec<StageResult>,
    /// Place of each stage in the order.
    rank: Vec<usize>,
    /// Ready stages by rank.
    ready: BTreeSet<(usize, usize)>,
    /// For each stage, how many stages upstream are not settled.
    waiting: Vec<usize>,
    pub(crate) failures: Vec<Failure>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) interrupted: bool,
    settled: usize,
}

impl<'g> Schedule<'g> {
    /// `wanted` must hold everything upstream of what it holds.
    pub(crate) fn new(graph: &'g Graph<'g>, wanted: BTreeSet<usize>) -> Self {
        let stages = graph.pipeline().stages();
        let mut rank = vec![0; stages.len()];
        for (place, &index) in graph.order().iter().enumerate() {
            rank[index] = place;
        }
        let unknown = |stage: &crate::Stage| StageResult {
            stage: stage.name.clone(),
            state: State::Unknown,
            reasons: Vec::new(),
            seconds: None,
            peak_memory: None,
        };
        let mut schedule = Self {
            graph,
            results: stages.iter().map(unknown).collect(),
            ready: BTreeSet::new(),
            waiting: (0..stages.len()).map(|i| graph.makers(i).len()).collect(),
            rank,
            wanted,
            failures: Vec::new(),
            warnings: Vec::new(),
            interrupted: false,
            settled: 0,
        };
        for index in schedule.wanted.clone() {
            schedule.results[index].state = State::Wanted;
            schedule.make_ready_if_it_is(index);
        }
        schedule
    }

    fn make_ready_if_it_is(&mut self, index: usize) {
        if self.waiting[index] == 0 && self.results[index].state == State::Wanted {
            self.results[index].state = State::Ready;
            self.ready.insert((self.rank[index], index));
        }
    }

    /// The first ready stage that fits, which counts as running from now on.
    pub(crate) fn begin_next(&mut self, fits: impl Fn(usize) -> bool) -> Option<usize> {
        let next = self.ready.iter().find(|(_, index)| fits(*index)).copied()?;
        self.ready.remove(&next);
        let (_, index) = next;
        self.results[index].state = State::Running;
        Some(index)
    }

    /// Passes on what a stage says.
    pub(crate) fn hear(&mut self, index: usize, news: News, observe: &mut dyn FnMut(Event<'_>)) {
        let stage = self.graph.stage(index);
        match news {
            News::Line(line) => observe(Event::Line { stage: &stage.name, line: &line }),
            News::Warning(warning) => self.warn(warning, observe),
            News::Retried { cause, retry } => observe(Event::Retried {
                stage: &stage.name,
                cause: &cause,
                retry,
                retries: stage.retries,
            }),
            News::Started { reasons } => {
                observe(Event::Started {
                    stage: &stage.name,
                    command: crate::shell::quoted(&stage.command),
                    reasons: &reasons,
                });
                self.results[index].reasons = reasons;
            }
        }
    }

    /// Notes that a stage was handed to a cluster.
    pub(crate) fn submitted(&mut self, index: usize, reasons: Vec<crate::Reason>) {
        self.results[index].state = State::Running;
        if !reasons.is_empty() {
            self.results[index].reasons = reasons;
        }
    }

    pub(crate) fn warn(&mut self, warning: Warning, observe: &mut dyn FnMut(Event<'_>)) {
        observe(Event::Warning(&warning));
        self.warnings.push(warning);
    }

    /// Notes how a stage ended, and what that makes ready.
    pub(crate) fn settle(
        &mut self,
        index: usize,
        attempt: Attempt,
        observe: &mut dyn FnMut(Event<'_>),
    ) {
        let stage = self.graph.stage(index).name.as_str();
        self.settled += 1;
        let (settled, wanted) = (self.settled, self.wanted.len());
        let result = &mut self.results[index];
        match attempt {
            Attempt::UpToDate => {
                result.state = State::UpToDate;
                observe(Event::UpToDate { stage, settled, wanted });
            }
            Attempt::Restored => {
                result.state = State::Restored;
                observe(Event::Restored { stage, settled, wanted });
            }
            Attempt::Done { seconds, peak_memory } => {
                result.state = State::Done;
                result.seconds = Some(seconds);
                result.peak_memory = peak_memory;
                observe(Event::Finished { stage, seconds, peak_memory, settled, wanted });
            }
            Attempt::Failed(failure) => {
                result.state = State::Failed;
                result.seconds = failure.seconds;
                observe(Event::Failed(&failure));
                self.failures.push(failure);
                return;
            }
            Attempt::Interrupted => {
                result.state = State::Ready;
                return;
            }
            Attempt::TakenBack => {
                result.state = State::Wanted;
                result.reasons.clear();
                return;
            }
        }
        for &user in self.graph.users(index) {
            self.waiting[user] -= 1;
            self.make_ready_if_it_is(user);
        }
    }

    pub(crate) fn report(self, place: &Place) -> RunReport {
        let order = self.graph.order().iter();
        let wanted: Vec<usize> = order.copied().filter(|i| self.wanted.contains(i)).collect();
        let printed = |&index: &usize| {
            let stage = self.graph.stage(index);
            if !stage.summary || !is_settled(self.results[index].state) {
                return None;
            }
            let text = std::fs::read_to_string(place.stdout_of(&stage.name, &stage.key()));
            Some(Summary { stage: stage.name.clone(), text: text.ok()? })
        };
        let settled = |&i: &usize| is_settled(self.results[i].state);
        RunReport {
            outcome: if wanted.iter().all(settled) {
                Outcome::Done
            } else if self.interrupted {
                Outcome::Interrupted
            } else {
                Outcome::Failed
            },
            summaries: wanted.iter().filter_map(printed).collect(),
            stages: wanted.iter().map(|&i| self.results[i].clone()).collect(),
            failures: self.failures,
            warnings: self.warnings,
        }
    }
}

fn is_settled(state: State) -> bool {
    matches!(state, State::Done | State::Restored | State::UpToDate)
}
