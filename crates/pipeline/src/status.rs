//! Which stages are stale and why, without running any.

use std::collections::BTreeSet;

use crate::check::{Past, Present};
use crate::content::Hasher;
use crate::paths::with_ancestors;
use crate::{Graph, Pipeline, PipelineError, Place, Reason, ledger};

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
    /// The most memory that a process of that run held, in bytes, where it is known.
    pub last_peak_memory: Option<u64>,
}

/// The state of every stage, in the order in which they run.
///
/// # Errors
/// As [`plan`], except that a missing input is a [`Reason`] here.
pub fn status(pipeline: &Pipeline, place: &Place) -> Result<Vec<StageStatus>, PipelineError> {
    let graph = Graph::new(pipeline)?;
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
    let named: BTreeSet<&str> = named.iter().map(|&i| graph.stage(i).name.as_str()).collect();
    let is_named = |status: &StageStatus| named.contains(status.stage.as_str());
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
    let ledger = ledger::load_at(place, graph.pipeline().name())?.ledger;
    let hasher = Hasher::of_place(place);
    let mut statuses: Vec<StageStatus> = Vec::new();
    let mut stale = BTreeSet::new();
    let orphans = crate::orphans::orphans(graph, &ledger);
    for &index in graph.order().iter().filter(|index| wanted.contains(index)) {
        let stage = graph.stage(index);
        let now = Present::look(stage, place, &hasher)?;
        let past = Past::in_ledger(stage, &ledger);
        let mut reasons = Vec::new();
        if forced.contains(&index) {
            reasons.push(Reason::Forced);
        }
        reasons.extend(past.reasons(stage, &now.made_from, &hasher)?);
        if past.record.is_some() {
            let path = crate::orphans::read_by(stage, &orphans, &ledger, place);
            reasons.extend(path.map(|path| Reason::InputNoLongerMade { path }));
        }
        refine(&mut reasons, graph, index, &stale, &now.missing);
        if !reasons.is_empty() {
            stale.insert(index);
        }
        statuses.push(StageStatus {
            stage: stage.name.clone(),
            up_to_date: reasons.is_empty(),
            reasons,
            command: crate::shell::quoted(&stage.command),
            outputs: stage.outputs.clone(),
            last_seconds: past.record.as_ref().map(|record| record.seconds),
            last_peak_memory: past.record.and_then(|record| record.peak_memory),
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
    stale: &BTreeSet<usize>,
    missing: &[String],
) {
    let needs = graph.needs(index);
    let made_inputs: BTreeSet<&str> = needs.iter().map(|need| need.input.as_str()).collect();
    let never_made =
        |path: &str| !made_inputs.contains(path) && missing.iter().any(|missing| missing == path);
    let to_come: BTreeSet<&str> = needs
        .iter()
        .filter(|need| stale.contains(&need.maker))
        .map(|need| need.input.as_str())
        .collect();
    let comes = |path: &str| with_ancestors(path).any(|above| to_come.contains(above));
    reasons.retain(|reason| match reason {
        Reason::InputChanged { path, .. } | Reason::InputRemoved { path } => {
            !comes(path) && !never_made(path)
        }
        _ => true,
    });
    let mut families = BTreeSet::new();
    for &maker in graph.makers(index).intersection(stale) {
        let stage = graph.stage(maker).family.clone();
        if families.insert(stage.clone()) {
            reasons.push(Reason::Upstream { stage });
        }
    }
    for path in missing.iter().filter(|path| never_made(path)) {
        let path = path.clone();
        reasons.push(Reason::InputMissing { path });
    }
}
