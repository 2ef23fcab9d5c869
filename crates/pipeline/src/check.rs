//! Whether a stage must run, against the ledger and the files as they are.

use std::collections::BTreeSet;

use crate::content::Hasher;
use crate::{FactKind, Ledger, Manifest, PipelineError, Place, Reason, Record, Stage};

/// A stage as it is now.
pub(crate) struct Present {
    /// What it would be made from.
    pub(crate) made_from: Manifest,
    /// Its share of a directory's files; empty if it is no shard.
    pub(crate) files: Vec<String>,
    /// What it reads and is not there.
    pub(crate) missing: Vec<String>,
}

impl Present {
    pub(crate) fn of(
        stage: &Stage,
        place: &Place,
        hasher: &Hasher<'_>,
    ) -> Result<Self, PipelineError> {
        let mut missing = Vec::new();
        let mut files = Vec::new();
        if let Some(share) = &stage.share {
            let folder = place.root.join(&share.folder);
            if !folder.is_dir() {
                missing.push(share.folder.clone());
            }
            files = share
                .files(&place.root)
                .map_err(PipelineError::io("read the directory", folder))?;
        }
        let made_from = Manifest::of(stage, &files, place.program.as_ref(), hasher)?;
        let found: BTreeSet<&str> = made_from
            .facts(FactKind::Input)
            .map(|(path, _)| path)
            .collect();
        let not_found = |path: &&String| !found.contains(path.as_str());
        missing.extend(stage.inputs.iter().filter(not_found).cloned());
        Ok(Self {
            made_from,
            files,
            missing,
        })
    }
}

/// What the ledger says about one stage.
pub(crate) struct Past {
    /// Its last good run.
    pub(crate) record: Option<Record>,
    /// Outputs of a run that was begun and not finished.
    pub(crate) unfinished: Option<Vec<String>>,
}

impl Past {
    pub(crate) fn of(stage: &Stage, ledger: &Ledger) -> Self {
        Self {
            record: ledger.stage.get(&stage.name).cloned(),
            unfinished: ledger.unfinished.get(&stage.name).cloned(),
        }
    }

    /// Whether `output` was made here, or begun: only such a file may be removed.
    pub(crate) fn made(&self, output: &str) -> bool {
        let recorded = self.record.as_ref();
        recorded.is_some_and(|record| record.outputs.contains_key(output))
            || self.unfinished.iter().flatten().any(|path| path == output)
    }

    /// Why `stage`, which would now be made from `now`, must run; empty if it need not.
    pub(crate) fn reasons(
        &self,
        stage: &Stage,
        now: &Manifest,
        hasher: &Hasher<'_>,
    ) -> Result<Vec<Reason>, PipelineError> {
        let Some(record) = &self.record else {
            return Ok(vec![match self.unfinished {
                Some(_) => Reason::Unfinished,
                None => Reason::NeverRun,
            }]);
        };
        let mut reasons = record.made_from.differences(now);
        for output in &stage.outputs {
            let path = output.clone();
            match (record.outputs.get(output), hasher.content(output)?) {
                (None, _) => reasons.push(Reason::OutputAdded { path }),
                (Some(_), None) => reasons.push(Reason::OutputMissing { path }),
                (Some(made), Some(found)) if *made != found => {
                    reasons.push(Reason::OutputEdited { path });
                }
                (Some(_), Some(_)) => {}
            }
        }
        Ok(reasons)
    }
}
