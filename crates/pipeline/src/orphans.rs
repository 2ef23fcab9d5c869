//! What runs made and the pipeline no longer makes: rows that left a table, fewer shards, an output with another name.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use crate::clean::{Cleaned, Cleaning};
use crate::content::Hasher;
use crate::ledger::{Ledger, OpenLedger};
use crate::paths::with_ancestors;
use crate::{FactKind, Graph, PipelineError, Place, Record, Stage, Warning, own};

/// What stands between the name of a fan-out and the values of one of its stages.
const SEPARATOR: char = '.';

/// The keys of runs whose outputs no stage makes any more, though they look like those of one.
///
/// A run is one of them if its outputs lie in a directory that a stage reads and in which stages
/// still make something, or if it was one of a fan-out that the pipeline still has. Runs of
/// another variant or with other settings of `--set` are not, and neither are outputs that a
/// stage reads by name or in a directory of their own: they are sources now.
pub(crate) fn orphans(graph: &Graph<'_>, ledger: &Ledger) -> Vec<String> {
    let pipeline = graph.pipeline();
    let stages = pipeline.stages();
    let keys: BTreeSet<String> = stages.iter().map(Stage::key).collect();
    let names: BTreeSet<&str> = stages.iter().map(|stage| stage.name.as_str()).collect();
    let fans = stages.iter().filter(|stage| stage.family != stage.name);
    let fans: BTreeSet<&str> = fans.map(|stage| stage.family.as_str()).collect();
    let reads: BTreeSet<&str> = stages.iter().flat_map(Stage::reads).collect();
    let read_or_above: BTreeSet<&str> = reads.iter().flat_map(|p| with_ancestors(p)).collect();
    let outputs = stages.iter().flat_map(|stage| &stage.outputs);
    let outputs_made: BTreeSet<&str> = outputs.clone().map(String::as_str).collect();
    let made_or_above: BTreeSet<&str> = outputs.flat_map(|path| with_ancestors(path)).collect();
    let of_a_fan = |stage: &str| {
        let mut ends = stage.match_indices(SEPARATOR).map(|(end, _)| end);
        !names.contains(stage) && ends.any(|end| fans.contains(&stage[..end]))
    };
    let is_orphan = |key: &str| {
        let paths: Vec<&str> = ledger.made_by(key).into_keys().collect();
        let stage = ledger.stage_of(key).unwrap_or_default();
        let settings_are_ours = match ledger.run.get(key) {
            Some(record) => same_settings(record, pipeline),
            None => !names.contains(stage),
        };
        let is_used = |path: &&str| {
            read_or_above.contains(path)
                || made_or_above.contains(path)
                || with_ancestors(path).any(|above| outputs_made.contains(above))
        };
        let is_read = |path: &&str| {
            let mut above = with_ancestors(path);
            above.any(|above| reads.contains(above) && made_or_above.contains(above))
        };
        !keys.contains(key)
            && settings_are_ours
            && !paths.iter().any(is_used)
            && (paths.iter().any(is_read) || of_a_fan(stage))
    };
    let runs: BTreeSet<&String> = ledger.keys().filter(|key| is_orphan(key)).collect();
    runs.into_iter().cloned().collect()
}

/// Whether a run was made as the pipeline is set now: the same variant, and the same `--set` of
/// what it used.
fn same_settings(record: &Record, pipeline: &crate::Pipeline) -> bool {
    let parameters = record.made_from.facts(FactKind::Parameter);
    let overridden = parameters.filter(|(name, _)| pipeline.overrides().contains_key(*name));
    let now: Vec<_> = overridden
        .filter_map(|(name, _)| Some((name, pipeline.overrides().get(name)?.as_str())))
        .collect();
    let then = record.set.iter().map(|(n, v)| (n.as_str(), v.as_str()));
    record.variant.as_deref() == pipeline.variant() && then.eq(now)
}

/// What of `orphans` lies in what `stage` reads, and is there.
pub(crate) fn read_by(
    stage: &Stage,
    orphans: &[String],
    ledger: &Ledger,
    place: &Place,
) -> Option<String> {
    let mut paths = orphans.iter().flat_map(|key| ledger.made_by(key).into_keys());
    let is_read = |path: &&str| {
        let mut above = with_ancestors(path);
        above.any(|above| stage.reads().any(|read| read == above))
            && place.root.join(path).symlink_metadata().is_ok()
    };
    paths.find(is_read).map(str::to_owned)
}

/// Sources of stages that were outputs of stages which the pipeline no longer has: nothing makes them anew.
pub(crate) fn once_made(graph: &Graph<'_>, ledger: &Ledger, place: &Place) -> Vec<Warning> {
    let stages = graph.pipeline().stages();
    let names = stages.iter().flat_map(|stage| [stage.name.as_str(), stage.family.as_str()]);
    let names: HashSet<&str> = names.collect();
    let outputs = stages.iter().flat_map(|stage| &stage.outputs);
    let outputs: HashSet<&str> = outputs.map(String::as_str).collect();
    let is_there = |name: &str| names.contains(name);
    let is_made = |path: &str| with_ancestors(path).any(|above| outputs.contains(above));
    let makers = ledger.run.iter().flat_map(|(key, record)| {
        let paths = ledger.made_by(key).into_keys();
        paths.map(|path| (path, record.stage.as_str()))
    });
    let makers: BTreeMap<&str, &str> = makers.filter(|(_, stage)| !is_there(stage)).collect();
    let mut warnings = Vec::new();
    for reader in stages {
        for path in reader.reads().filter(|path| !is_made(path)) {
            if let Some(stage) = makers.get(path)
                && place.root.join(path).exists()
            {
                warnings.push(Warning::OnceMade {
                    reader: reader.name.clone(),
                    path: path.to_owned(),
                    stage: (*stage).to_owned(),
                });
            }
        }
    }
    warnings
}

/// Removes what the orphans are known to have made; says what is a source now, what went, and what stays because it
/// was changed or is nobody's. What stays is moved away instead where that was asked for.
pub(crate) fn remove(
    graph: &Graph<'_>,
    place: &Place,
    ledger: &mut OpenLedger,
    move_aside: bool,
) -> Result<Vec<Warning>, PipelineError> {
    let mut cleaning: Option<Cleaning<'_>> = None;
    let mut warnings = once_made(graph, ledger.get(), place);
    for key in orphans(graph, ledger.get()) {
        let cleaning = cleaning.get_or_insert_with(|| Cleaning {
            place,
            hasher: Hasher::of_place(place),
            force: false,
            dry_run: false,
        });
        let stage = ledger.get().stage_of(&key).unwrap_or_default().to_owned();
        let mut cleaned = Cleaned::default();
        let mut cleared = cleaning.remove(&key, ledger.get(), &mut cleaned)?;
        let mut kept = cleaned.kept;
        let lies_in_kept =
            |path: &String| with_ancestors(path).any(|a| kept.iter().any(|k| k == a));
        cleaned.foreign.retain(|path| !lies_in_kept(path));
        kept.append(&mut cleaned.foreign);
        if move_aside && !kept.is_empty() {
            let folders = own::move_aside(&kept, graph, &place.root)?;
            let (stage, files) = (stage.clone(), kept.len());
            warnings.push(Warning::MovedAside { stage, files, folders });
            (kept, cleared) = (Vec::new(), true);
        }
        if cleared {
            ledger.forget(&key)?;
        }
        // What was moved aside has been told.
        if !cleaned.removed.is_empty() || !kept.is_empty() {
            warnings.push(Warning::NoLongerMade { stage, removed: cleaned.removed, kept });
        }
    }
    Ok(warnings)
}
