//! Removing what stages made.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::content::Hasher;
use crate::ledger::{self, Ledger, Made, OpenLedger};
use crate::lock::RunLock;
use crate::own::{remove, remove_files};
use crate::paths::with_ancestors;
use crate::{Graph, Pipeline, PipelineError, Place};

/// What was removed, or would be.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct Cleaned {
    /// Outputs, relative to the root.
    pub removed: Vec<String>,
    /// Outputs that are not as their stages had left them, or that a run was cut off in, and so stay.
    pub kept: Vec<String>,
    /// Files in outputs that no run made, and that so stay.
    pub foreign: Vec<String>,
}

/// Removes the outputs of the targets (stages or files; all stages if there are none) with
/// their logs and records. What stands in the place of an output but was not made here
/// stays, and so does, without `force`, what was edited by hand. `dry_run` removes nothing.
///
/// Without targets that is also what stages made that the pipeline no longer has; what it
/// made elsewhere, as another variant or by `--set`, stays.
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
    let loaded = ledger::load_at(place, pipeline.name())?;
    let mut ledger = OpenLedger::new(place.ledger.clone(), loaded)?;
    let hasher = Hasher::of_place(place);
    crate::cluster::refuse_while_jobs_run(place, &mut ledger, &hasher)?;
    let mut keys: BTreeSet<String> = named.iter().map(|&i| graph.stage(i).key()).collect();
    if targets.is_empty() {
        keys.extend(gone(pipeline, ledger.get()));
    }
    let cleaning = Cleaning { place, hasher, force, dry_run };
    let mut cleaned = Cleaned::default();
    for key in &keys {
        let Some(stage) = ledger.get().stage_of(key).map(str::to_owned) else {
            continue;
        };
        let cleared = cleaning.remove(key, ledger.get(), &mut cleaned)?;
        if !dry_run {
            for path in [place.log_of(&stage), place.stdout_of(&stage, key)] {
                remove(&path).map_err(PipelineError::io("remove", &path))?;
            }
            if cleared {
                ledger.forget(key)?;
            }
        }
    }
    ledger.fold()?;
    if !dry_run && targets.is_empty() {
        let _ = fs::remove_file(place.hash_cache());
        let _ = fs::remove_dir(&place.log_dir); // stays if anything else is in it
    }
    lock.release();
    Ok(cleaned)
}

/// Runs of stages that the pipeline no longer has, or no longer has there.
fn gone(pipeline: &Pipeline, ledger: &Ledger) -> Vec<String> {
    let stages = pipeline.stages().iter();
    let stages: BTreeSet<&str> = stages.map(|stage| stage.name.as_str()).collect();
    let runs = ledger.run.iter().filter(|(_, record)| {
        record.variant.as_deref() == pipeline.variant()
            && (!stages.contains(&*record.stage) || record.set.is_empty())
    });
    let left = ledger.left.iter();
    let left = left.filter(|(_, left)| !stages.contains(&*left.stage));
    let keys = runs.map(|(key, _)| key).chain(left.map(|(key, _)| key));
    keys.cloned().collect()
}

/// How what runs made is removed.
pub(crate) struct Cleaning<'a> {
    pub(crate) place: &'a Place,
    pub(crate) hasher: Hasher<'a>,
    pub(crate) force: bool,
    pub(crate) dry_run: bool,
}

impl Cleaning<'_> {
    /// Removes what one run made; whether nothing of it is left.
    pub(crate) fn remove(
        &self,
        key: &str,
        ledger: &Ledger,
        cleaned: &mut Cleaned,
    ) -> Result<bool, PipelineError> {
        let mut cleared = true;
        for (output, made) in ledger.made_by(key) {
            let Some(names) = self.hasher.names(output)? else {
                continue;
            };
            let record = ledger.run.get(key).and_then(|r| r.outputs.get(output));
            let files = match made {
                Made::Open(_) => names,
                Made::Files(files) => {
                    let is_foreign = |name: &&String| files.binary_search(name).is_err();
                    let foreign: Vec<String> = names.iter().filter(is_foreign).cloned().collect();
                    let paths = foreign.iter().map(|name| format!("{output}/{name}"));
                    cleaned.foreign.extend(paths);
                    files.to_vec()
                }
            };
            let edited = match record {
                Some(content) => self.content_of(output, made)?.as_ref() != Some(content),
                None => false,
            };
            // Of a folder in the making nobody knows what in it is the stage's.
            let is_known = |name: &String| match made {
                Made::Open(known) => name.is_empty() || known.binary_search(name).is_ok(),
                Made::Files(_) => true,
            };
            let unsure = !files.iter().all(is_known);
            if (edited || unsure) && !self.force {
                cleared = false;
                cleaned.kept.push(output.to_owned());
                continue;
            }
            if !self.dry_run {
                remove_files(output, &files, &self.place.root)?;
                self.remove_empty_above(output);
            }
            cleaned.removed.push(output.to_owned());
        }
        Ok(cleared)
    }

    /// The content of what a run made in an output, without what others put there.
    fn content_of(&self, output: &str, made: Made<'_>) -> Result<Option<String>, PipelineError> {
        match made {
            Made::Files(files) if self.place.root.join(output).is_dir() => {
                self.hasher.content_of_some(output, files).map(Some)
            }
            _ => self.hasher.content(output),
        }
    }

    fn remove_empty_above(&self, output: &str) {
        for above in with_ancestors(output).skip(1) {
            let folder = self.place.root.join(above);
            if Path::new(above).is_absolute() || fs::remove_dir(folder).is_err() {
                break;
            }
        }
    }
}
