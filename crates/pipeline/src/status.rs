//! Which stages are stale and why, without running any.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::AtomicBool;

use crate::check::Past;
use crate::content::Hasher;
use crate::{Graph, Ledger, Manifest, Pipeline, PipelineError, Place, Reason, Stage};

/// Whether one stage is up to date, and if not, why.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct StageStatus {
    /// The stage's name.
    pub stage: String,
    /// Whether a run would leave it alone. A stage below a stale one is not up to date,
    /// though it is left alone in the end if what it reads comes out the same.
    pub up_to_date: bool,
    /// Why it would run; empty if it is up to date.
    pub reasons: Vec<Reason>,
    /// Its command line.
    pub command: String,
    /// What it makes.
    pub outputs: Vec<String>,
    /// How long its last good run took, in seconds.
    pub last_seconds: Option<f64>,
}

/// The state of every stage, in the order in which they run.
///
/// # Errors
/// As [`plan`], except that a missing input is a [`Reason`] here.
pub fn status(pipeline: &Pipeline, place: &Place) -> Result<Vec<StageStatus>, PipelineError> {
    let graph = Graph::new(pipeline)?;
    graph.check_commands(place.program.as_ref())?;
    place.check(pipeline)?;
    let wanted = graph.wanted(&[])?;
    examine(&graph, place, &wanted, &BTreeSet::new())
}

/// What a run of `targets` (stages or files; all stages if empty) would do and why: the
/// wanted stages in the order in which they would run. `force` as in
/// [`RunOptions`](crate::RunOptions).
///
/// # Errors
/// If the stages have no order, a target is unknown, an input is missing that no stage
/// makes, or the ledger or a file cannot be read.
pub fn plan(
    pipeline: &Pipeline,
    place: &Place,
    targets: &[String],
    force: bool,
) -> Result<Vec<StageStatus>, PipelineError> {
    let graph = Graph::new(pipeline)?;
    graph.check_commands(place.program.as_ref())?;
    place.check(pipeline)?;
    let wanted = graph.wanted(targets)?;
    graph.check_sources(&wanted, place)?;
    let forced = forced(&graph, targets, force)?;
    examine(&graph, place, &wanted, &forced)
}

/// The state of one stage, named by itself or by a file that it makes.
///
/// # Errors
/// As [`status`], or if nothing is so called.
pub fn why(
    pipeline: &Pipeline,
    place: &Place,
    target: &str,
) -> Result<Vec<StageStatus>, PipelineError> {
    let graph = Graph::new(pipeline)?;
    let target = [target.to_owned()];
    let named = graph.named(&target)?;
    let wanted = graph.wanted(&target)?;
    let is_named =
        |status: &StageStatus| named.iter().any(|&i| graph.stage(i).name == status.stage);
    let mut statuses = examine(&graph, place, &wanted, &BTreeSet::new())?;
    statuses.retain(is_named);
    Ok(statuses)
}

/// The stages that run even if they are up to date: the targets themselves, or all.
pub(crate) fn forced(
    graph: &Graph<'_>,
    targets: &[String],
    force: bool,
) -> Result<BTreeSet<usize>, PipelineError> {
    match (force, targets) {
        (false, _) => Ok(BTreeSet::new()),
        (true, []) => graph.wanted(&[]),
        (true, targets) => graph.named(targets),
    }
}

fn examine(
    graph: &Graph<'_>,
    place: &Place,
    wanted: &BTreeSet<usize>,
    forced: &BTreeSet<usize>,
) -> Result<Vec<StageStatus>, PipelineError> {
    let ledger = Ledger::read(&place.ledger, graph.pipeline().name())?;
    let never = AtomicBool::new(false);
    let hasher = Hasher::new(&place.root, place.hash_cache(), &never);
    let mut statuses: Vec<StageStatus> = Vec::new();
    let mut stale: BTreeMap<usize, &str> = BTreeMap::new();
    for &index in graph.order().iter().filter(|index| wanted.contains(index)) {
        let stage = graph.stage(index);
        let now = Manifest::of(stage, place.program.as_ref(), &hasher)?;
        let past = Past::of(stage, &ledger);
        let mut reasons = Vec::new();
        if forced.contains(&index) {
            reasons.push(Reason::Forced);
        }
        reasons.extend(past.reasons(stage, &now, &hasher)?);
        refine(&mut reasons, graph, index, &stale, stage, &now);
        if !reasons.is_empty() {
            stale.insert(index, &stage.name);
        }
        statuses.push(StageStatus {
            stage: stage.name.clone(),
            up_to_date: reasons.is_empty(),
            reasons,
            command: crate::shell::quoted(&stage.command),
            outputs: stage.outputs.clone(),
            last_seconds: past.record.map(|record| record.seconds),
        });
    }
    hasher.save();
    Ok(statuses)
}

/// Puts a stale maker in the place of what is now seen of the inputs that it will make
/// anew, and says which inputs nobody makes.
fn refine(
    reasons: &mut Vec<Reason>,
    graph: &Graph<'_>,
    index: usize,
    stale: &BTreeMap<usize, &str>,
    stage: &Stage,
    now: &Manifest,
) {
    let needs = graph.needs(index);
    let made: BTreeSet<&str> = needs.iter().map(|need| need.input.as_str()).collect();
    let found: BTreeSet<&str> = now
        .facts(crate::FactKind::Input)
        .map(|(path, _)| path)
        .collect();
    let missing = |path: &str| !found.contains(path) && !made.contains(path);
    let to_come: BTreeSet<&str> = needs
        .iter()
        .filter(|need| stale.contains_key(&need.maker))
        .map(|need| need.input.as_str())
        .collect();
    reasons.retain(|reason| match reason {
        Reason::InputChanged { path, .. } | Reason::InputRemoved { path } => {
            !to_come.contains(path.as_str()) && !missing(path)
        }
        _ => true,
    });
    let makers: BTreeSet<usize> = needs.iter().map(|need| need.maker).collect();
    for stage in makers.iter().filter_map(|maker| stale.get(maker)) {
        let stage = (*stage).to_owned();
        reasons.push(Reason::Upstream { stage });
    }
    for path in stage.inputs.iter().filter(|path| missing(path)) {
        let path = path.clone();
        reasons.push(Reason::InputMissing { path });
    }
}
