//! One step of a pipeline.

use std::collections::BTreeMap;

/// One step: a command line, what it reads and what it makes.
///
/// A table `[[stage]]` with `foreach`, `matrix` or `shards` gives several, named after it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Stage {
    /// Its name, fit for a file name.
    pub name: String,
    /// The name in the pipeline file: that of the stage, or what all stages of one fan-out
    /// are called together.
    pub family: String,
    /// Program and arguments; never empty. Of a shard, the word `{files}` stands for its
    /// share of the files, one argument each.
    pub command: Vec<String>,
    /// Files or whole directories that it reads, relative to the root.
    pub inputs: Vec<String>,
    /// Files or whole directories that it makes, relative to the root.
    pub outputs: Vec<String>,
    /// The parameters that stand in its command or paths, with their values.
    pub params: BTreeMap<String, String>,
    /// The version of what its command computes, where the pipeline file keeps one.
    pub version: Option<String>,
    /// Whether its standard output belongs to the summary at the end of a run.
    pub summary: bool,
    /// How to get its inputs, said when one is missing.
    pub inputs_help: Option<String>,
    /// Its share of a directory's files, if it is a shard.
    pub share: Option<Share>,
    /// The row of a table that it is for, if it is one of a `foreach`.
    pub row: Option<Row>,
    /// How many times it is tried again after a failure.
    pub retries: u32,
    /// What it asks of a machine.
    pub resources: Resources,
}

/// The row of a table that gave a stage its values.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// The table, relative to the root.
    pub table: String,
    /// The first line with these values; the heading is line 1.
    pub line: u64,
}

/// What a stage asks of a machine or a cluster; no part of what outputs are made from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Resources {
    /// Processor cores; only a cluster counts them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpus: Option<u32>,
    /// Memory in MiB.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub memory_mb: Option<u32>,
    /// The longest that it may run, in minutes; on a cluster, with all its retries so many times
    /// as long.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minutes: Option<u32>,
}

/// One of several equal shares of the files in a directory.
///
/// A file's share follows from its name alone, so that a new file changes one share. Which
/// files there are is looked up when the stage's turn comes: a stage may make them.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Share {
    /// The directory, relative to the root.
    pub folder: String,
    /// The names that count: text in which one `*` may stand for any.
    pub pattern: String,
    /// Which share, from 0.
    pub shard: u32,
    /// How many there are.
    pub shards: u32,
}

/// The word of a command that stands for a shard's files.
pub(crate) const FILES: &str = "{files}";

/// Under which a ledger keeps the runs of a stage: the first of its outputs in the order of
/// their letters.
pub(crate) fn key<'a>(name: &str, outputs: impl IntoIterator<Item = &'a String>) -> String {
    let first = outputs.into_iter().min();
    first.map_or_else(|| format!("//{name}"), Clone::clone)
}

impl Stage {
    /// Under which a [`Ledger`](crate::Ledger) keeps its runs into these outputs.
    pub fn key(&self) -> String {
        key(&self.name, &self.outputs)
    }

    /// Everything that it reads: its inputs, and the directory of which it reads a share.
    pub fn reads(&self) -> impl Iterator<Item = &str> {
        let folder = self.share.as_ref().map(|share| share.folder.as_str());
        self.inputs.iter().map(String::as_str).chain(folder)
    }

    /// Its program's arguments, with `files` in the place of the word that stands for them.
    pub(crate) fn arguments(&self, files: &[String]) -> Vec<String> {
        let mut arguments = Vec::with_capacity(self.command.len());
        for word in &self.command[1..] {
            if self.share.is_some() && word == FILES {
                arguments.extend_from_slice(files);
            } else {
                arguments.push(word.clone());
            }
        }
        arguments
    }
}

impl Share {
    /// Whether a file of this name belongs to any share.
    pub(crate) fn matches(&self, name: &str) -> bool {
        match self.pattern.split_once('*') {
            None => name == self.pattern,
            Some((start, end)) => {
                name.len() >= start.len() + end.len()
                    && name.starts_with(start)
                    && name.ends_with(end)
            }
        }
    }

    /// The share to which a file of this name belongs.
    pub(crate) fn shard_of(&self, name: &str) -> u32 {
        let hash = blake3::hash(name.as_bytes());
        let first = hash.as_bytes().first_chunk().copied().unwrap_or_default();
        // Below the number of shards, so it fits.
        (u64::from_le_bytes(first) % u64::from(self.shards)) as u32
    }
}
