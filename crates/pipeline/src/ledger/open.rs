//! A ledger in the hands of one run.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use super::{Ledger, Loaded, Record};
use crate::atomic_write;
use crate::content::hash_of;
use crate::journal::{Entry, Journal, journal_of};
use crate::paths::{below, with_ancestors};
use crate::{PipelineError, Place, Stage};

/// A ledger held by one run: what happens goes to the journal at once and to the ledger's
/// own file at the end.
pub(crate) struct OpenLedger {
    path: PathBuf,
    ledger: Ledger,
    hash: Option<String>,
    replayed: bool,
    journal: Option<Journal>,
    /// The run of each output; made when the first stage asks.
    owners: Option<BTreeMap<String, String>>,
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
            owners: None,
        };
        if open.replayed {
            open.fold()?;
        }
        Ok(open)
    }

    pub(crate) fn get(&self) -> &Ledger {
        &self.ledger
    }

    /// Forgets runs of which nothing is there, apart from those of `stages`.
    pub(crate) fn forget_gone(&mut self, stages: &[Stage], place: &Place) {
        let ledger = &self.ledger;
        let current: BTreeSet<String> = stages.iter().map(Stage::key).collect();
        let is_gone = |key: &&String| {
            let outputs = ledger.made_by(key);
            !current.contains(*key)
                && !outputs.keys().any(|output| place.root.join(output).exists())
        };
        let gone: Vec<String> = ledger.keys().filter(is_gone).cloned().collect();
        for key in gone {
            self.ledger.forget(&key);
        }
    }

    /// The runs that had outputs where `stage` has its own: equal, above or below.
    pub(crate) fn overlapping(&mut self, stage: &Stage) -> Vec<String> {
        let ledger = &self.ledger;
        let owners = self.owners.get_or_insert_with(|| {
            let owned_by = |key: &String| {
                let outputs = ledger.made_by(key).into_keys();
                let owned = |output: &str| (output.to_owned(), key.clone());
                outputs.map(owned).collect::<Vec<_>>()
            };
            ledger.keys().flat_map(owned_by).collect()
        });
        let mut overlapping = BTreeSet::new();
        for output in &stage.outputs {
            overlapping.extend(below(owners, output).map(|(_, key)| key));
            overlapping.extend(with_ancestors(output).filter_map(|above| owners.get(above)));
        }
        let key = stage.key();
        let known = |other: &&String| **other == key || ledger.stage_of(other).is_some();
        overlapping.into_iter().filter(known).cloned().collect()
    }

    /// Notes that a stage is about to run: its last run is no more.
    pub(crate) fn begin(&mut self, stage: &Stage) -> Result<(), PipelineError> {
        let key = stage.key();
        let mut from = self.overlapping(stage);
        from.retain(|other| *other != key);
        if let Some(owners) = &mut self.owners {
            owners.extend(stage.outputs.iter().map(|path| (path.clone(), key.clone())));
        }
        self.enter(Entry::Begun {
            key,
            stage: stage.name.clone(),
            outputs: stage.outputs.clone(),
            from,
        })
    }

    pub(crate) fn finish(&mut self, stage: &Stage, record: Record) -> Result<(), PipelineError> {
        self.enter(Entry::Finished { key: stage.key(), record: Box::new(record) })
    }

    /// Notes which files a run made that did not end well.
    pub(crate) fn leave(
        &mut self,
        key: &str,
        files: BTreeMap<String, Vec<String>>,
    ) -> Result<(), PipelineError> {
        self.enter(Entry::Left { key: key.to_owned(), files })
    }

    pub(crate) fn forget(&mut self, key: &str) -> Result<(), PipelineError> {
        self.enter(Entry::Forgotten { key: key.to_owned() })
    }

    fn enter(&mut self, entry: Entry) -> Result<(), PipelineError> {
        if self.journal.is_none() {
            // A journal does not say where the paths begin: from the first run on, the ledger does.
            if self.hash.is_none() {
                self.write()?;
            }
            self.journal = Some(Journal::create(
                &journal_of(&self.path),
                &self.ledger.pipeline,
                self.hash.clone(),
            )?);
        }
        if let Some(journal) = &mut self.journal {
            journal.append(&entry)?;
        }
        entry.apply(&mut self.ledger);
        Ok(())
    }

    /// Writes the ledger, if anything happened, and then drops the journal.
    pub(crate) fn fold(&mut self) -> Result<(), PipelineError> {
        if self.journal.is_none() && !self.replayed {
            return Ok(());
        }
        self.write()?;
        self.journal = None;
        self.replayed = false;
        // A journal that stays belongs to the old ledger and counts for nothing.
        let _ = std::fs::remove_file(journal_of(&self.path));
        Ok(())
    }

    fn write(&mut self) -> Result<(), PipelineError> {
        self.ledger.write(&self.path)?;
        let bytes = std::fs::read(&self.path).map_err(PipelineError::io("read", &self.path))?;
        self.hash = Some(hash_of(&bytes));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::load;
    use super::*;
    use crate::Manifest;
    use crate::testing::pipeline;

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/p.lock");
        let made_from: Manifest =
            serde_json::from_str(r#"{"command": {"line": "x"}, "input": {"a b/ü.csv": "00"}}"#)
                .unwrap();
        let record = Record {
            stage: "a".to_owned(),
            variant: Some("b".to_owned()),
            digest: made_from.digest(),
            seconds: 1.25,
            peak_memory: Some(1 << 20),
            row: None,
            set: BTreeMap::from([("seed".to_owned(), "7".to_owned())]),
            made_from,
            outputs: BTreeMap::from([("o".to_owned(), "11 in 1 file".to_owned())]),
            files: BTreeMap::from([("o".to_owned(), vec!["x".to_owned()])]),
        };
        let pipeline = pipeline(&[("a", &[], &["o"])]);
        let stage = &pipeline.stages()[0];
        let load = || load(&path, Some("p")).unwrap();
        let mut open = OpenLedger::new(path.clone(), load()).unwrap();
        open.begin(stage).unwrap();
        assert_eq!(&load().ledger, open.get());
        let files = BTreeMap::from([("o".to_owned(), vec!["half".to_owned()])]);
        open.leave(&stage.key(), files).unwrap();
        assert_eq!(&load().ledger, open.get());
        open.begin(stage).unwrap();
        open.finish(stage, record).unwrap();
        assert_eq!(&load().ledger, open.get());
        assert!(path.exists() && journal_of(&path).exists());
        open.fold().unwrap();
        assert_eq!(&load().ledger, open.get());
        assert!(path.exists() && !journal_of(&path).exists());
        open.forget(&stage.key()).unwrap();
        let mut next = OpenLedger::new(path.clone(), load()).unwrap();
        assert!(next.get().run.is_empty() && !journal_of(&path).exists());
        next.fold().unwrap();
    }
}
