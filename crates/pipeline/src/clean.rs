//! Removing what stages made.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::attempt::remove;
use crate::content::Hasher;
use crate::ledger::{self, OpenLedger};
use crate::lock::RunLock;
use crate::paths::with_ancestors;
use crate::{Graph, Pipeline, PipelineError, Place};

/// What was removed, or would be.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct Cleaned {
    /// Outputs, relative to the root.
    pub removed: Vec<String>,
    /// Outputs that are not as their stages had left them, and so stay.
    pub kept: Vec<String>,
}

/// Removes the outputs of the targets (stages or files; all stages if there are none) with
/// their logs and records. What stands in the place of an output but was not made here
/// stays, and so does, without `force`, what was edited by hand. `dry_run` removes nothing.
///
/// # Errors
/// [`PipelineError::Busy`] if a run is at work, an unknown target, or if a file cannot be
/// read or removed.
pub fn clean(
    pipeline: &Pipeline,
    place: &Place,
    targets: &[String],
    force: bool,
    dry_run: bool,
) -> Result<Cleaned, PipelineError> {
    let graph = Graph::new(pipeline)?;
    let named = match targets {
        [] => graph.wanted(&[])?,
        targets => graph.named(targets)?,
    };
    let lock = RunLock::acquire(place.lock())?;
    crate::cluster::refuse_while_jobs_run(place)?;
    let loaded = ledger::load(&place.ledger, Some(pipeline.name()))?;
    let mut ledger = OpenLedger::new(place.ledger.clone(), loaded)?;
    let never = AtomicBool::new(false);
    let hasher = Hasher::new(&place.root, place.hash_cache(), &never);
    let mut cleaned = Cleaned::default();
    let names: BTreeSet<&str> = named
        .iter()
        .map(|&i| graph.stage(i).name.as_str())
        .collect();
    // Also what stages made that the pipeline no longer has.
    let is_gone = |stage: &&String| pipeline.stages().iter().all(|s| s.name != **stage);
    let recorded = ledger
        .get()
        .stage
        .keys()
        .chain(ledger.get().unfinished.keys());
    let gone = recorded.filter(|stage| targets.is_empty() && is_gone(stage));
    let stages: BTreeSet<String> = gone
        .cloned()
        .chain(names.iter().map(|s| (*s).to_owned()))
        .collect();
    for stage in &stages {
        let record = ledger.get().stage.get(stage).cloned();
        let unfinished = ledger.get().unfinished.get(stage).cloned();
        let mut all = true;
        for (output, content) in record.iter().flat_map(|record| &record.outputs) {
            match hasher.content(output)? {
                None => {}
                Some(found) if found == *content || force => {
                    remove_output(place, output, dry_run)?;
                    cleaned.removed.push(output.clone());
                }
                Some(_) => {
                    all = false;
                    cleaned.kept.push(output.clone());
                }
            }
        }
        for output in unfinished.iter().flatten() {
            if place.root.join(output).exists() {
                remove_output(place, output, dry_run)?;
                cleaned.removed.push(output.clone());
            }
        }
        if !dry_run {
            for path in [place.log_of(stage), place.stdout_of(stage)] {
                remove(&path).map_err(PipelineError::io("remove", &path))?;
            }
            if all && (record.is_some() || unfinished.is_some()) {
                ledger.forget(stage)?;
            }
        }
    }
    ledger.fold()?;
    if !dry_run && targets.is_empty() {
        let _ = fs::remove_file(place.hash_cache());
        let _ = fs::remove_dir(&place.log_dir); // stays if anything else is in it
    }
    drop(lock);
    Ok(cleaned)
}

/// Removes an output and the directories above it that it leaves empty.
fn remove_output(place: &Place, output: &str, dry_run: bool) -> Result<(), PipelineError> {
    if dry_run {
        return Ok(());
    }
    let full = place.root.join(output);
    remove(&full).map_err(PipelineError::io("remove", &full))?;
    for above in with_ancestors(output).skip(1) {
        let folder = place.root.join(above);
        if Path::new(above).is_absolute() || fs::remove_dir(folder).is_err() {
            break;
        }
    }
    Ok(())
}
