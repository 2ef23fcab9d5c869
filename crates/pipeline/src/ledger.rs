//! What each output was made from, in a file that people can read and compare.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::atomic_write::{self, Durability};
use crate::{Manifest, PipelineError};

/// The format that this version writes, and the newest that it reads.
pub const LEDGER_VERSION: u32 = 1;

const HEADING: &str = "# What each stage's outputs were made from. Written after each stage; \
                       not meant to be edited.\n\n";

/// The record of finished stages.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledger {
    /// Format of the file.
    pub version: u32,
    /// The pipeline's name.
    pub pipeline: String,
    /// Outputs that stages were about to make when they were last begun, by stage. An entry
    /// goes when its stage finishes.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub unfinished: BTreeMap<String, Vec<String>>,
    /// The last good run of each stage, by its name.
    #[serde(default)]
    pub stage: BTreeMap<String, Record>,
}

/// One good run of a stage.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// The hash of `made_from`.
    pub digest: String,
    /// How long the stage ran, in seconds.
    pub seconds: f64,
    /// Parameters that `--set` had replaced, those that this stage uses.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub set: BTreeMap<String, String>,
    /// Command, versions, parameters and inputs.
    pub made_from: Manifest,
    /// The content of each output, by its path.
    #[serde(default)]
    pub outputs: BTreeMap<String, String>,
}

/// The part of a ledger that every version has had.
#[derive(serde::Deserialize)]
struct AnyVersion {
    version: u32,
}

impl Ledger {
    /// A ledger in which nothing has been made.
    pub fn empty(pipeline: &str) -> Self {
        Self {
            version: LEDGER_VERSION,
            pipeline: pipeline.to_owned(),
            unfinished: BTreeMap::new(),
            stage: BTreeMap::new(),
        }
    }

    /// Reads a ledger; where there is no file, nothing has been made.
    ///
    /// # Errors
    /// [`PipelineError::LedgerNewer`] for a format that we do not know,
    /// [`PipelineError::LedgerDamaged`] for anything that is no ledger of `pipeline`, or in
    /// which a digest is not that of its own list, [`PipelineError::Io`].
    pub fn read(path: &Path, pipeline: &str) -> Result<Self, PipelineError> {
        let bytes = match std::fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Ok(Self::empty(pipeline));
            }
            Err(error) => return Err(PipelineError::io("read the ledger", path)(error)),
        };
        let damaged = |message: String| PipelineError::LedgerDamaged {
            path: path.to_owned(),
            message,
        };
        let text = String::from_utf8(bytes).map_err(|_| damaged("it is not text".to_owned()))?;
        let at = |error: toml::de::Error| {
            let line = error.span().and_then(|span| text.get(..span.start));
            let line = line.map_or(1, |before| before.matches('\n').count() + 1);
            damaged(format!("line {line}: {}", error.message()))
        };
        let AnyVersion { version } = toml::from_str(&text).map_err(at)?;
        if version > LEDGER_VERSION {
            return Err(PipelineError::LedgerNewer {
                path: path.to_owned(),
                found: version,
                supported: LEDGER_VERSION,
            });
        }
        let ledger: Self = toml::from_str(&text).map_err(at)?;
        if ledger.pipeline != pipeline {
            return Err(damaged(format!(
                "it belongs to pipeline `{}`, not to `{pipeline}`",
                ledger.pipeline
            )));
        }
        let forged = |(_, record): &(&String, &Record)| record.digest != record.made_from.digest();
        match ledger.stage.iter().find(forged) {
            Some((stage, _)) => Err(damaged(format!(
                "the digest of stage `{stage}` is not that of its entries"
            ))),
            None => Ok(ledger),
        }
    }

    fn write(&self, path: &Path, durability: Durability) -> Result<(), PipelineError> {
        let body = toml::to_string(self)
            .map_err(|error| PipelineError::io("write", path)(std::io::Error::other(error)))?;
        atomic_write::write(path, format!("{HEADING}{body}").as_bytes(), durability)
    }
}

/// A ledger that is on disk what it is in memory, held by one run at a time.
pub(crate) struct OpenLedger {
    path: PathBuf,
    ledger: Ledger,
}

impl OpenLedger {
    pub(crate) fn new(path: PathBuf, ledger: Ledger) -> Self {
        Self { path, ledger }
    }

    pub(crate) fn get(&self) -> &Ledger {
        &self.ledger
    }

    /// Forgets the last run of a stage before it runs again.
    pub(crate) fn begin(&mut self, stage: &str, outputs: &[String]) -> Result<(), PipelineError> {
        self.ledger.stage.remove(stage);
        let unfinished = outputs.to_vec();
        self.ledger.unfinished.insert(stage.to_owned(), unfinished);
        // Were this lost in a power cut, the old record's output hashes would not fit.
        self.ledger.write(&self.path, Durability::Written)
    }

    pub(crate) fn finish(&mut self, stage: &str, record: Record) -> Result<(), PipelineError> {
        self.ledger.unfinished.remove(stage);
        self.ledger.stage.insert(stage.to_owned(), record);
        self.ledger.write(&self.path, Durability::Synced)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Ledger, PipelineError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.lock");
        std::fs::write(&path, text).unwrap();
        Ledger::read(&path, "p")
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/p.lock");
        let made_from: Manifest =
            serde_json::from_str(r#"{"command": {"line": "x"}, "input": {"a b/ü.csv": "00"}}"#)
                .unwrap();
        let record = Record {
            digest: made_from.digest(),
            seconds: 1.25,
            set: BTreeMap::from([("seed".to_owned(), "7".to_owned())]),
            made_from,
            outputs: BTreeMap::from([("o".to_owned(), "11".to_owned())]),
        };
        let mut open = OpenLedger::new(path.clone(), Ledger::empty("p"));
        open.begin("a", &["o".to_owned()]).unwrap();
        assert_eq!(&Ledger::read(&path, "p").unwrap(), open.get());
        open.finish("a", record).unwrap();
        assert_eq!(&Ledger::read(&path, "p").unwrap(), open.get());
    }

    #[test]
    fn a_damaged_ledger_is_an_error_that_says_what_to_do() {
        let good = "version = 1\npipeline = 'p'\n";
        for text in [
            "",
            "version = 1\npipe",
            "version = 1\npipeline = 'other'\n",
            &format!("{good}extra = 1\n"),
            &format!("{good}[stage.a]\ndigest = 'no'\nseconds = 1.0\n[stage.a.made_from]\n"),
        ] {
            let error = read(text).unwrap_err();
            assert!(
                matches!(error, PipelineError::LedgerDamaged { .. }),
                "{error}"
            );
            assert!(error.suggestion().unwrap().contains("delete it"));
        }
        assert!(read(good).is_ok());
    }

    #[test]
    fn a_newer_ledger_is_refused_whatever_else_it_says() {
        let error = read("version = 2\nnovelty = true\n").unwrap_err();
        assert!(
            matches!(error, PipelineError::LedgerNewer { found: 2, .. }),
            "{error}"
        );
    }
}
