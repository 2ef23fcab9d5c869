//! Handing stages in: scripts first, then our own note, then the cluster.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use super::engine::{self, Group, LARGEST_GROUP};
use super::jobs::{Accepted, Jobs, Task};
use super::script;
use crate::attempt::Workshop;
use crate::check::Present;
use crate::{Event, Graph, PipelineError, Reason};

/// A stage that can go to the cluster.
pub(super) struct Candidate {
    pub(super) index: usize,
    pub(super) now: Present,
    pub(super) reasons: Vec<Reason>,
    /// Longest way from a stage without makers: whatever it waits for has a smaller one.
    pub(super) depth: usize,
}

/// Hands all candidates in.
pub(super) fn submit(
    workshop: &Workshop<'_>,
    graph: &Graph<'_>,
    jobs: &mut Jobs,
    mut candidates: Vec<Candidate>,
    at_once: Option<usize>,
    observe: &mut dyn FnMut(Event<'_>),
) -> Result<(), PipelineError> {
    let place = workshop.place;
    let absolute = |path: &PathBuf| {
        let failed = PipelineError::io("find", path);
        std::path::absolute(path).map_err(failed)
    };
    let root = absolute(&place.root)?;
    let spool = absolute(&super::spools(place))?.join(name_of_now());
    fs::create_dir_all(&spool).map_err(PipelineError::io("create", &spool))?;
    let family = |c: &Candidate| graph.stage(c.index).family.clone();
    candidates.sort_by_key(|c| (c.depth, family(c), c.index));
    let (groups, tasks) = write_scripts(workshop, graph, jobs, &candidates, &root, &spool)?;
    jobs.begin(tasks)?;
    let (engine, pipeline) = (jobs.engine, graph.pipeline().name());
    let mut accepted = |group: &Group, job: &str| {
        observe(Event::Submitted { job, stage: &group.name, tasks: group.tasks.len() });
        jobs.accept(Accepted {
            spool: spool.clone(),
            tasks: group.tasks.clone(),
            job: job.to_owned(),
            numbered: engine == crate::Executor::HyperQueue,
        })
    };
    engine::submit(engine, pipeline, &groups, at_once, &root, &spool, &mut accepted)
}

/// A stage's name and its task.
type Noted = (String, Task);

/// Writes the script of each candidate into `spool`; the groups they go in, and the note of each stage's task.
fn write_scripts(
    workshop: &Workshop<'_>,
    graph: &Graph<'_>,
    jobs: &Jobs,
    candidates: &[Candidate],
    root: &Path,
    spool: &Path,
) -> Result<(Vec<Group>, Vec<Noted>), PipelineError> {
    let mut groups: Vec<Group> = Vec::new();
    let mut tasks: Vec<Noted> = Vec::new();
    let mut number_of: BTreeMap<usize, u32> = BTreeMap::new();
    let mut of_group = None;
    for (number, candidate) in candidates.iter().enumerate() {
        let index = u32::try_from(number).unwrap_or(u32::MAX);
        let stage = graph.stage(candidate.index);
        let text = script::text(stage, &candidate.now.files, workshop.place, root, spool, index);
        let path = script::script(spool, index);
        fs::write(&path, text).map_err(PipelineError::io("write", &path))?;
        let kind = Some((candidate.depth, stage.family.as_str()));
        if of_group != kind || groups.last().is_none_or(|g| g.tasks.len() >= LARGEST_GROUP) {
            of_group = kind;
            groups.push(Group {
                name: stage.family.clone(),
                tasks: index..index,
                resources: stage.resources,
                retries: stage.retries,
                after_jobs: BTreeSet::new(),
                after: Vec::new(),
            });
        }
        let open = |maker: usize| {
            let name = &graph.stage(maker).name;
            jobs.tasks.contains_key(name) || number_of.contains_key(&maker)
        };
        let opens: BTreeSet<&str> = graph
            .needs(candidate.index)
            .iter()
            .filter(|need| open(need.maker))
            .map(|need| need.input.as_str())
            .collect();
        let made_from = candidate.now.made_from.clone();
        let made_from = made_from.without_inputs(|path| opens.contains(path));
        if let Some(group) = groups.last_mut() {
            group.tasks.end = index + 1;
            let mut after = BTreeSet::new();
            for need in graph.needs(candidate.index) {
                if let Some(number) = number_of.get(&need.maker) {
                    after.insert(*number);
                } else if let Some(task) = jobs.tasks.get(&graph.stage(need.maker).name) {
                    group.after_jobs.insert(task.job.clone());
                }
            }
            group.after.push(after);
            let task = Task {
                job: String::new(),
                index,
                number: index - group.tasks.start,
                spool: spool.to_owned(),
                made_from,
                key: stage.key(),
            };
            number_of.insert(candidate.index, index);
            tasks.push((stage.name.clone(), task));
        }
        // What its makers are about to make is not known yet, so neither is what it makes.
        workshop.begin(stage)?;
    }
    Ok((groups, tasks))
}

/// A name that no other submission has.
fn name_of_now() -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let nanos = now.map_or(0, |since| since.as_nanos());
    format!("{nanos:x}-{}", std::process::id())
}
