//! What each output was made from, in a file that people can read and compare.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::atomic_write::{self, Durability};
use crate::journal::{self, Entry, Journal};
use crate::{Manifest, PipelineError, Row};

/// The format that this version writes, and the newest that it reads.
pub const LEDGER_VERSION: u32 = 2;

const HEADING: &str = "# What each stage's outputs were made from. Written at the end of a run; \
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
        load(path, Some(pipeline)).map(|loaded| loaded.ledger)
    }

    /// Reads the ledger of whatever pipeline it belongs to.
    ///
    /// # Errors
    /// As [`Ledger::read`], and [`PipelineError::Io`] if there is no file.
    pub fn read_any(path: &Path) -> Result<Self, PipelineError> {
        load(path, None).map(|loaded| loaded.ledger)
    }

    fn parse(path: &Path, bytes: Vec<u8>, pipeline: Option<&str>) -> Result<Self, PipelineError> {
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
        let ledger = toml::from_str::<Self>(&text);
        if !matches!(&ledger, Ok(ledger) if ledger.version <= LEDGER_VERSION) {
            let AnyVersion { version } = toml::from_str(&text).map_err(at)?;
            if version > LEDGER_VERSION {
                return Err(PipelineError::LedgerNewer {
                    path: path.to_owned(),
                    found: version,
                    supported: LEDGER_VERSION,
                });
            }
        }
        let ledger = ledger.map_err(at)?;
        if let Some(pipeline) = pipeline
            && ledger.pipeline != pipeline
        {
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

    fn write(&self, path: &Path) -> Result<(), PipelineError> {
        let written = Self {
            version: LEDGER_VERSION,
            ..self.clone()
        };
        let body = toml::to_string(&written)
            .map_err(|error| PipelineError::io("write", path)(std::io::Error::other(error)))?;
        atomic_write::write(
            path,
            format!("{HEADING}{body}").as_bytes(),
            Durability::Synced,
        )
    }
}

/// A ledger with its journal, and what is needed to go on with them.
pub(crate) struct Loaded {
    pub(crate) ledger: Ledger,
    /// The hash of the ledger's bytes; `None` if there is no file.
    hash: Option<String>,
    /// Whether the journal added anything.
    replayed: bool,
}

/// Reads the ledger of `pipeline` (of any, if `None`) and what a run noted that was killed.
pub(crate) fn load(path: &Path, pipeline: Option<&str>) -> Result<Loaded, PipelineError> {
    let (mut ledger, hash) = match std::fs::read(path) {
        Ok(bytes) => {
            let hash = blake3::hash(&bytes).to_hex().to_string();
            (Ledger::parse(path, bytes, pipeline)?, Some(hash))
        }
        Err(error) => match pipeline {
            Some(pipeline) if error.kind() == std::io::ErrorKind::NotFound => {
                (Ledger::empty(pipeline), None)
            }
            _ => return Err(PipelineError::io("read the ledger", path)(error)),
        },
    };
    let replayed = journal::replay(&journal_of(path), hash.as_ref(), &mut ledger)?;
    Ok(Loaded {
        ledger,
        hash,
        replayed,
    })
}

fn journal_of(ledger: &Path) -> PathBuf {
    let mut name = ledger.as_os_str().to_owned();
    name.push(".journal");
    PathBuf::from(name)
}

/// A ledger held by one run: what happens goes to the journal at once and to the ledger's
/// own file at the end.
pub(crate) struct OpenLedger {
    path: PathBuf,
    ledger: Ledger,
    hash: Option<String>,
    replayed: bool,
    journal: Option<Journal>,
}

impl OpenLedger {
    /// To be called by the holder of the lock only.
    ///
    /// # Errors
    /// If what a killed run had noted cannot be written into the ledger.
    pub(crate) fn new(path: PathBuf, loaded: Loaded) -> Result<Self, PipelineError> {
        atomic_write::remove_unfinished(&path);
        let mut open = Self {
            path,
            ledger: loaded.ledger,
            hash: loaded.hash,
            replayed: loaded.replayed,
            journal: None,
        };
        if open.replayed {
            open.fold()?;
        }
        Ok(open)
    }

    pub(crate) fn get(&self) -> &Ledger {
        &self.ledger
    }

    /// Forgets stages that the pipeline no longer has.
    pub(crate) fn retain(&mut self, is_named: impl Fn(&str) -> bool) {
        self.ledger.stage.retain(|stage, _| is_named(stage));
        self.ledger.unfinished.retain(|stage, _| is_named(stage));
    }

    /// Forgets the last run of a stage before it runs again.
    pub(crate) fn begin(&mut self, stage: &str, outputs: &[String]) -> Result<(), PipelineError> {
        self.enter(Entry::Begun {
            stage: stage.to_owned(),
            outputs: outputs.to_vec(),
        })
    }

    pub(crate) fn finish(&mut self, stage: &str, record: Record) -> Result<(), PipelineError> {
        self.enter(Entry::Finished {
            stage: stage.to_owned(),
            record: Box::new(record),
        })
    }

    pub(crate) fn forget(&mut self, stage: &str) -> Result<(), PipelineError> {
        self.enter(Entry::Forgotten {
            stage: stage.to_owned(),
        })
    }

    fn enter(&mut self, entry: Entry) -> Result<(), PipelineError> {
        let journal = match &mut self.journal {
            Some(journal) => journal,
            None => self.journal.insert(Journal::create(
                &journal_of(&self.path),
                &self.ledger.pipeline,
                self.hash.clone(),
            )?),
        };
        journal.append(&entry)?;
        entry.apply(&mut self.ledger);
        Ok(())
    }

    /// Writes the ledger, if anything happened, and then drops the journal.
    pub(crate) fn fold(&mut self) -> Result<(), PipelineError> {
        if self.journal.is_none() && !self.replayed {
            return Ok(());
        }
        self.ledger.write(&self.path)?;
        let bytes = std::fs::read(&self.path).map_err(PipelineError::io("read", &self.path))?;
        self.hash = Some(blake3::hash(&bytes).to_hex().to_string());
        self.journal = None;
        self.replayed = false;
        // A journal that stays belongs to the old ledger and counts for nothing.
        let _ = std::fs::remove_file(journal_of(&self.path));
        Ok(())
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
            peak_memory: Some(1 << 20),
            row: None,
            set: BTreeMap::from([("seed".to_owned(), "7".to_owned())]),
            made_from,
            outputs: BTreeMap::from([("o".to_owned(), "11".to_owned())]),
        };
        let load = || load(&path, Some("p")).unwrap();
        let mut open = OpenLedger::new(path.clone(), load()).unwrap();
        open.begin("a", &["o".to_owned()]).unwrap();
        assert_eq!(&load().ledger, open.get());
        open.finish("a", record).unwrap();
        assert_eq!(&load().ledger, open.get());
        assert!(!path.exists() && journal_of(&path).exists());
        open.fold().unwrap();
        assert_eq!(&load().ledger, open.get());
        assert!(path.exists() && !journal_of(&path).exists());
        open.forget("a").unwrap();
        let mut next = OpenLedger::new(path.clone(), load()).unwrap();
        assert!(next.get().stage.is_empty() && !journal_of(&path).exists());
        next.fold().unwrap();
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
        let error = read("version = 3\nnovelty = true\n").unwrap_err();
        assert!(
            matches!(error, PipelineError::LedgerNewer { found: 3, .. }),
            "{error}"
        );
    }
}
