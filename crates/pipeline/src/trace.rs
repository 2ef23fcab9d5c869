//! From a file back to everything that it was made from.

use path_slash::PathExt as _;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::content::Hasher;
use crate::error::nearest;
use crate::paths::{below, normalise, with_ancestors};
use crate::{FactKind, FileState, Ledger, PipelineError, Place, Record, Role, Row};

/// Where a file comes from, as the ledger says.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Trace {
    /// The file, relative to the root.
    pub path: String,
    /// The stages that it took, the last one first, each after all that use what it made.
    pub stages: Vec<TracedStage>,
    /// The files that no stage made: where it all comes from.
    pub sources: Vec<Source>,
}

/// A stage on the way.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct TracedStage {
    /// Its name.
    pub stage: String,
    /// Its command line, parameters put in.
    pub command: String,
    /// The parameters in use.
    pub params: BTreeMap<String, String>,
    /// The version of what it computes, by the command.
    pub versions: BTreeMap<String, String>,
    /// The row of a table that it is for.
    pub row: Option<Row>,
    /// How long it ran, in seconds.
    pub seconds: f64,
    /// The most memory that one of its processes held, in bytes, where it is known.
    pub peak_memory: Option<u64>,
    /// Those of its outputs that were of use.
    pub outputs: Vec<TracedFile>,
    /// What it read.
    pub inputs: Vec<TracedFile>,
}

/// A file or directory that a stage read or made.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct TracedFile {
    /// Its path, relative to the root.
    pub path: String,
    /// Its content at the time, as in the ledger.
    pub content: String,
    /// Whether it is still so.
    pub state: FileState,
    /// The stages that made it, or parts of it; none for a source.
    pub makers: Vec<String>,
}

/// A file or directory that no stage made.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Source {
    /// Its path, relative to the root.
    pub path: String,
    /// Its content at the time, as in the ledger.
    pub content: String,
    /// Whether it is still so.
    pub state: FileState,
    /// The stages that read it.
    pub readers: Vec<String>,
}

/// Walks back from `path` (a file that a stage made, or one in a directory that a stage
/// made), relative to the root of `place`.
///
/// # Errors
/// [`PipelineError::NotMade`] if no stage of the ledger made it; if a file cannot be read.
pub fn trace(ledger: &Ledger, place: &Place, path: &str) -> Result<Trace, PipelineError> {
    let makers = Makers::from_ledger(ledger);
    let not_made = || PipelineError::NotMade {
        path: path.to_owned(),
        ledger: place.ledger.clone(),
        nearest: nearest(path, makers.0.keys().map(String::as_str)),
    };
    let path = normalise(path).ok_or_else(not_made)?;
    let first = makers.of_path(&path);
    if first.is_empty() {
        return Err(not_made());
    }
    let hasher = Hasher::of_place(place);
    let order = makers.upstream(ledger, &first);
    let mut sources: BTreeMap<(&str, &str), Vec<String>> = BTreeMap::new();
    let mut read: BTreeSet<&str> = BTreeSet::from([path.as_str()]);
    let mut stages = Vec::new();
    for name in order {
        let record = &ledger.run[name];
        let facts = |kind| record.made_from.facts(kind);
        let owned = |(name, value): (&str, &str)| (name.to_owned(), value.to_owned());
        let file = |path: &str, content: &str, role: Role| {
            Ok(TracedFile {
                path: path.to_owned(),
                content: content.to_owned(),
                state: FileState::compare(path, content, role, &hasher)?,
                makers: makers
                    .of_path(path)
                    .into_iter()
                    .map(|key| ledger.run[key].stage.clone())
                    .collect(),
            })
        };
        let used = |output: &&String| {
            let inside = |path: &&str| with_ancestors(path).any(|above| above == output.as_str());
            read.iter().any(|path| inside(path) || with_ancestors(output).any(|a| a == *path))
        };
        let outputs = record.outputs.keys().filter(used).collect::<Vec<_>>();
        let outputs = outputs.iter().map(|path| file(path, &record.outputs[*path], Role::Output));
        let inputs = facts(FactKind::Input);
        let inputs = inputs.map(|(path, content)| file(path, content, Role::Input));
        stages.push(TracedStage {
            stage: record.stage.clone(),
            command: facts(FactKind::Command).map(|(_, line)| line).collect(),
            params: facts(FactKind::Parameter).map(owned).collect(),
            versions: facts(FactKind::Version).map(owned).collect(),
            row: record.row.clone(),
            seconds: record.seconds,
            peak_memory: record.peak_memory,
            outputs: outputs.collect::<Result<_, PipelineError>>()?,
            inputs: inputs.collect::<Result<_, PipelineError>>()?,
        });
        for (path, content) in facts(FactKind::Input) {
            read.insert(path);
            if makers.of_path(path).is_empty() {
                let readers = sources.entry((path, content)).or_default();
                readers.push(record.stage.clone());
            }
        }
    }
    let source = |((path, content), readers): ((&str, &str), Vec<String>)| {
        Ok(Source {
            path: path.to_owned(),
            content: content.to_owned(),
            state: FileState::compare(path, content, Role::Input, &hasher)?,
            readers,
        })
    };
    let sources = sources.into_iter().map(source);
    let sources = sources.collect::<Result<_, PipelineError>>()?;
    hasher.save();
    Ok(Trace { path, stages, sources })
}

/// The run that made each recorded output.
struct Makers(BTreeMap<String, String>);

impl Makers {
    fn from_ledger(ledger: &Ledger) -> Self {
        let outputs = |(key, record): (&String, &Record)| {
            let paths: Vec<_> = record.outputs.keys().cloned().collect();
            let key = key.clone();
            paths.into_iter().map(move |path| (path, key.clone()))
        };
        Self(ledger.run.iter().flat_map(outputs).collect())
    }

    /// Who made `path`: it, a directory above it, or files in it.
    fn of_path(&self, path: &str) -> BTreeSet<&str> {
        let above = with_ancestors(path).find_map(|above| self.0.get(above));
        let inside = below(&self.0, path).map(|(_, stage)| stage);
        above.into_iter().chain(inside).map(String::as_str).collect()
    }

    /// The runs that made what a run read.
    fn before(&self, ledger: &Ledger, run: &str) -> BTreeSet<&str> {
        let record = ledger.run.get(run);
        let inputs = record.into_iter().flat_map(|r| r.made_from.facts(FactKind::Input));
        inputs.flat_map(|(path, _)| self.of_path(path)).collect()
    }

    /// The runs and all before them, each after those that use it.
    fn upstream<'a>(&'a self, ledger: &Ledger, first: &BTreeSet<&'a str>) -> Vec<&'a str> {
        let mut before_each: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        let mut open: Vec<&'a str> = first.iter().copied().collect();
        while let Some(stage) = open.pop() {
            if !before_each.contains_key(stage) {
                let before = self.before(ledger, stage);
                open.extend(before.iter().copied());
                before_each.insert(stage, before);
            }
        }
        let mut users: BTreeMap<&str, usize> =
            before_each.keys().map(|stage| (*stage, 0)).collect();
        for before in before_each.values() {
            for stage in before {
                users.entry(stage).and_modify(|count| *count += 1);
            }
        }
        let mut order: Vec<&'a str> = Vec::new();
        // A ledger that was put together by hand may hold a circle: those come last.
        while order.len() < before_each.len() {
            let next = users.iter().min_by_key(|(_, count)| **count);
            let Some(stage) = next.map(|(stage, _)| *stage) else {
                break;
            };
            users.remove(stage);
            for before in &before_each[stage] {
                if let Some(count) = users.get_mut(before) {
                    *count = count.saturating_sub(1);
                }
            }
            order.push(stage);
        }
        order
    }
}

impl Trace {
    /// The trace as a person reads it.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![self.path.clone()];
        for stage in &self.stages {
            let row = stage.row.as_ref().map_or_else(String::new, |row| {
                format!(" (row on line {} of {})", row.line, row.table)
            });
            let version =
                |(command, version): (&String, &String)| format!(", {command} version {version}");
            let versions: String = stage.versions.iter().map(version).collect();
            lines.push(format!("<- stage {}{row}{versions}", stage.stage));
            lines.push(format!("     {}", stage.command));
            let memory = stage
                .peak_memory
                .map_or_else(String::new, |bytes| format!(", {:.0} MB", bytes as f64 / 1e6));
            lines.push(format!("     took {:.2} s{memory}", stage.seconds));
            let changed = |output: &&TracedFile| output.state != FileState::Same;
            for output in stage.outputs.iter().filter(changed) {
                lines.push(format!("     made {}{}", output.path, remark(output.state)));
            }
            for input in &stage.inputs {
                let makers = match input.makers.as_slice() {
                    [] => "a source".to_owned(),
                    makers => format!("by {}", makers.join(", ")),
                };
                lines.push(format!("     from {}: {makers}{}", input.path, remark(input.state)));
            }
        }
        lines.push("sources".to_owned());
        for source in &self.sources {
            lines.push(format!(
                "  {}  {}{}",
                short(&source.content),
                source.path,
                remark(source.state)
            ));
        }
        lines
    }
}

fn remark(state: FileState) -> &'static str {
    match state {
        FileState::Same => "",
        FileState::Changed => " (changed since)",
        FileState::Missing => " (no longer there)",
        FileState::NoLongerMade => " (no longer made by any stage)",
    }
}

/// The first digits of a hash; of a directory with its number of files.
fn short(content: &str) -> String {
    let (hash, files) = content.split_once(" in ").unwrap_or((content, ""));
    let start = hash.get(..12).unwrap_or(hash);
    if files.is_empty() { start.to_owned() } else { format!("{start} ({files})") }
}

/// `path` as the ledger of a pipeline with this root would name it.
///
/// # Example
/// ```
/// # use maveric_pipeline::below_root;
/// assert_eq!(below_root("/study/out/a.csv".as_ref(), "/study".as_ref()), "out/a.csv");
/// ```
pub fn below_root(path: &Path, root: &Path) -> String {
    let absolute = |path: &Path| {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let text = path.to_slash_lossy();
        normalise(&text).unwrap_or_else(|| text.into_owned())
    };
    let (path, root) = (absolute(path), absolute(root));
    match path.strip_prefix(&format!("{root}/")) {
        Some(below) => below.to_owned(),
        None => path,
    }
}
