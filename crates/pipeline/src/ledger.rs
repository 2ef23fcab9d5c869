//! What each output was made from, in a file that people can read and compare.

mod open;
mod read;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::atomic_write::{Durability, atomic_write_bytes};
use crate::paths::{below, with_ancestors};
use crate::{Manifest, PipelineError, Row, Stage};

pub(crate) use open::OpenLedger;
pub(crate) use read::{Loaded, load, load_at};

/// The format that this version writes and reads.
pub(crate) const LEDGER_VERSION: u32 = 4;

const HEADING: &str = "# What each stage's outputs were made from. Written at the end of a run; \
                       not meant to be edited.\n\n";

/// The record of what runs made.
///
/// It is kept by output path: a run is found by the first of its outputs (in the order of
/// their letters), so that runs of one stage into several places never forget each other's
/// files. A stage without outputs has `//` and its name there.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledger {
    /// Format of the file.
    pub version: u32,
    /// The pipeline's name.
    pub pipeline: String,
    /// Where the paths of its stages begin, as seen from the ledger's folder; `None` before the first run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub root: Option<String>,
    /// What is there of runs that did not end well, or of which others have taken a part.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub left: BTreeMap<String, Left>,
    /// The last good run into each place.
    #[serde(default)]
    pub run: BTreeMap<String, Record>,
}

/// One good run of a stage.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Its name, with that of its branch in a fan-out.
    pub stage: String,
    /// What `--variant` was, if it was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
    /// The hash of `made_from`.
    pub digest: String,
    /// How long the stage ran, in seconds.
    pub seconds: f64,
    /// The most memory that one of its processes held, in bytes, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_memory: Option<u64>,
    /// The row of a table that this stage is for, if it is one of a `foreach`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub row: Option<Row>,
    /// Parameters that `--set` had replaced, those that this stage uses.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub set: BTreeMap<String, String>,
    /// Command, versions, parameters and inputs.
    pub made_from: Manifest,
    /// The content of each output, by its path.
    #[serde(default)]
    pub outputs: BTreeMap<String, String>,
    /// Of outputs that are directories, the files in them, in order.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, Vec<String>>,
}

/// What is there of a run that did not end well.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Left {
    /// Its name, with that of its branch in a fan-out.
    pub stage: String,
    /// Outputs in the making when this was last written: a file there is the stage's, of files in a folder nobody knows.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub open: Vec<String>,
    /// The files that are known to be the stage's, by output; the empty name for an output
    /// that is a file itself. Of an output in the making, what the last good run had made.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, Vec<String>>,
}

/// What of an output is a run's.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Made<'a> {
    /// It was in the making when its run was cut off. A file is the run's, and of a directory those that its last good run had made, in
    /// order; of others there nobody knows.
    Open(&'a [String]),
    /// Files below it, in order; the empty name for itself.
    Files(&'a [String]),
}

const ITSELF: &[String] = &[String::new()];

impl Ledger {
    /// A ledger in which nothing has been made.
    pub fn empty(pipeline: &str) -> Self {
        Self {
            version: LEDGER_VERSION,
            pipeline: pipeline.to_owned(),
            root: None,
            left: BTreeMap::new(),
            run: BTreeMap::new(),
        }
    }

    /// Reads a ledger; where there is no file, nothing has been made.
    ///
    /// # Errors
    /// [`PipelineError::LedgerFormat`] for another format,
    /// [`PipelineError::LedgerDamaged`] for anything that is no ledger of `pipeline`, or in
    /// which a digest is not that of its own list, [`PipelineError::Io`].
    pub fn read(path: &Path, pipeline: &str) -> Result<Self, PipelineError> {
        load(path, Some(pipeline)).map(|loaded| loaded.ledger)
    }

    /// Reads the ledger of whatever pipeline it belongs to.
    ///
    /// # Errors
    /// As [`Ledger::read`], and [`PipelineError::Io`] if there is no file.
    pub fn read_any(path: &Path) -> Result<Self, PipelineError> {
        load(path, None).map(|loaded| loaded.ledger)
    }

    /// The last good run of `stage` into the outputs that it has now.
    pub fn record_of(&self, stage: &Stage) -> Option<&Record> {
        let record = self.run.get(&stage.key());
        record.filter(|record| record.stage == stage.name)
    }

    /// The last good runs of one variant (`None`: those without a name), by stage. Where a
    /// stage has run into several places by `--set`, the one with the fewest settings counts.
    pub fn variant(&self, name: Option<&str>) -> BTreeMap<&str, &Record> {
        let mut records: BTreeMap<&str, &Record> = BTreeMap::new();
        for record in self.run.values() {
            let settings = |record: &Record| record.set.len();
            if record.variant.as_deref() == name
                && records
                    .get(&*record.stage)
                    .is_none_or(|other| settings(record) < settings(other))
            {
                records.insert(&record.stage, record);
            }
        }
        records
    }

    /// The variants of which there are runs, in order.
    pub fn variants(&self) -> BTreeSet<&str> {
        let names = self.run.values().map(|record| record.variant.as_deref());
        names.flatten().collect()
    }

    /// The runs, the good ones first, then those that were begun.
    pub(crate) fn keys(&self) -> impl Iterator<Item = &String> {
        self.run.keys().chain(self.left.keys())
    }

    /// What of each output a run made, or the beginning of one.
    pub(crate) fn made_by(&self, key: &str) -> BTreeMap<&str, Made<'_>> {
        let mut outputs = BTreeMap::new();
        if let Some(record) = self.run.get(key) {
            for output in record.outputs.keys() {
                let files = record.files.get(output).map_or(ITSELF, Vec::as_slice);
                outputs.insert(output.as_str(), Made::Files(files));
            }
        }
        if let Some(left) = self.left.get(key) {
            let files = left.files.iter();
            outputs.extend(files.map(|(output, files)| (output.as_str(), Made::Files(files))));
            outputs.extend(left.open.iter().map(|output| {
                let known = left.files.get(output).map_or(&[][..], Vec::as_slice);
                (output.as_str(), Made::Open(known))
            }));
        }
        outputs
    }

    /// The stage of a run.
    pub(crate) fn stage_of(&self, key: &str) -> Option<&str> {
        let begun = self.left.get(key).map(|left| left.stage.as_str());
        begun.or_else(|| self.run.get(key).map(|record| record.stage.as_str()))
    }

    /// Notes that a stage is about to make `outputs`. Of the runs `from`, which had made something
    /// there, those of the same stage are its past: what they had made is likely to be made again.
    /// Others lose what lies there.
    pub(crate) fn begin(&mut self, key: &str, stage: &str, outputs: &[String], from: &[String]) {
        let mut past = BTreeMap::new();
        let mut again = BTreeMap::new();
        let mut making = outputs.to_vec();
        for other in from.iter().map(String::as_str).chain([key]) {
            let same = other == key || self.stage_of(other) == Some(stage);
            let mut files = self.files_left(other);
            let open = self.left.get(other).map(|left| left.open.clone());
            let mut open = open.unwrap_or_default();
            open.retain(|path| {
                !with_ancestors(path).any(|above| outputs.iter().any(|o| o == above))
            });
            let name = self.stage_of(other).unwrap_or_default().to_owned();
            self.forget(other);
            for output in outputs {
                if same && let Some(known) = files.get(output) {
                    again.insert(output.clone(), known.clone());
                }
                take(&mut files, output);
            }
            if same {
                past.append(&mut files);
                making.append(&mut open);
            } else if !files.is_empty() || !open.is_empty() {
                let left = Left { stage: name, open, files };
                self.left.insert(other.to_owned(), left);
            }
        }
        past.append(&mut again);
        let left = Left { stage: stage.to_owned(), open: making, files: past };
        self.left.insert(key.to_owned(), left);
    }

    pub(crate) fn forget(&mut self, key: &str) {
        self.left.remove(key);
        self.run.remove(key);
    }

    /// The files of a run by output, as far as they are known by name.
    fn files_left(&self, key: &str) -> BTreeMap<String, Vec<String>> {
        let outputs = self.made_by(key).into_iter();
        outputs
            .map(|(output, Made::Files(files) | Made::Open(files))| {
                (output.to_owned(), files.to_vec())
            })
            .collect()
    }

    fn write(&self, path: &Path) -> Result<(), PipelineError> {
        let body = toml::to_string(self)
            .map_err(|error| PipelineError::io("write", path)(std::io::Error::other(error)))?;
        atomic_write_bytes(path, format!("{HEADING}{body}").as_bytes(), Durability::Synced)
    }
}

/// Takes what lies at or below `path` out of lists of files.
fn take(files: &mut BTreeMap<String, Vec<String>>, path: &str) {
    files.remove(path);
    let inside: Vec<String> = below(files, path).map(|(output, _)| output.clone()).collect();
    for output in inside {
        files.remove(&output);
    }
    for above in with_ancestors(path).skip(1) {
        if let Some(names) = files.get_mut(above) {
            let within = &path[above.len() + 1..];
            names.retain(|name| !with_ancestors(name).any(|above| above == within));
            if names.is_empty() {
                files.remove(above);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_takes_over_what_lies_in_its_outputs_and_nothing_else() {
        let list = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>();
        let mut ledger = Ledger::empty("p");
        let left = |stage: &str, files: &[(&str, &[&str])]| Left {
            stage: stage.to_owned(),
            open: Vec::new(),
            files: files
                .iter()
                .map(|(output, names)| ((*output).to_owned(), list(names)))
                .collect(),
        };
        let all = left("all", &[("out", &["a/1", "a/2", "ab", "b"])]);
        let one = left("one", &[("out/a", &["0"]), ("rest", &[""])]);
        ledger.left.insert("out".to_owned(), all);
        ledger.left.insert("out/a".to_owned(), one);
        let outputs = list(&["out/a"]);
        ledger.begin("out/a", "one", &outputs, &list(&["out"]));
        assert_eq!(ledger.left["out"].files["out"], ["ab", "b"]);
        assert_eq!(ledger.left["out/a"].open, outputs);
        // What the stage no longer makes is still known as its own.
        assert_eq!(ledger.left["out/a"].files["rest"], [""]);
        // What it had made there before is likely to be made again.
        assert_eq!(ledger.left["out/a"].files["out/a"], ["0"]);
        let made = ledger.made_by("out/a");
        assert!(matches!(made["out/a"], Made::Open([name]) if name == "0"));
        ledger.begin("x", "one", &list(&["x"]), &list(&["out/a"]));
        assert!(!ledger.left.contains_key("out/a"));
        assert_eq!(ledger.left["x"].files["rest"], [""]);
    }
}
