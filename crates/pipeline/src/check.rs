//! Whether a stage must run, against the ledger and the files as they are.

use crate::content::Hasher;
use crate::{Ledger, Manifest, PipelineError, Place, Reason, Record, Stage};

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
    pub(crate) fn look(
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
            files = hasher.shares.files(share, &place.root)?;
        }
        let made_from = Manifest::list(stage, &files, place.program.as_ref(), hasher)?;
        let not_found = |path: &&String| !made_from.has_input(path);
        missing.extend(stage.inputs.iter().filter(not_found).cloned());
        Ok(Self { made_from, files, missing })
    }
}

/// What the ledger says about one stage.
pub(crate) struct Past {
    /// Its last good run.
    pub(crate) record: Option<Record>,
    /// Whether a run was begun that did not end well.
    pub(crate) begun: bool,
}

impl Past {
    pub(crate) fn in_ledger(stage: &Stage, ledger: &Ledger) -> Self {
        Self {
            record: ledger.record_of(stage).cloned(),
            begun: ledger.left.contains_key(&stage.key()),
        }
    }

    /// Why `stage`, which would now be made from `now`, must run; empty if it need not.
    pub(crate) fn reasons(
        &self,
        stage: &Stage,
        now: &Manifest,
        hasher: &Hasher<'_>,
    ) -> Result<Vec<Reason>, PipelineError> {
        let Some(record) = &self.record else {
            return Ok(vec![if self.begun { Reason::Unfinished } else { Reason::NeverRun }]);
        };
        let mut reasons = record.made_from.differences(now);
        for output in &stage.outputs {
            let path = output.clone();
            match (record.outputs.get(output), hasher.content(output)?) {
                (None, _) => reasons.push(Reason::OutputAdded { path }),
                (Some(_), None) => reasons.push(Reason::OutputMissing { path }),
                (Some(made), Some(found)) if *made != found => {
                    let foreign = added(output, record, hasher)?;
                    reasons.push(match foreign {
                        Some(path) => Reason::Foreign { path },
                        None => Reason::OutputEdited { path },
                    });
                }
                (Some(_), Some(_)) => {}
            }
        }
        Ok(reasons)
    }
}

/// The first file in a directory that its run had not made.
fn added(
    output: &str,
    record: &Record,
    hasher: &Hasher<'_>,
) -> Result<Option<String>, PipelineError> {
    let Some(files) = record.files.get(output) else {
        return Ok(None);
    };
    let names = hasher.names(output)?.unwrap_or_default();
    let added = names.iter().find(|name| files.binary_search(name).is_err());
    Ok(added.map(|name| format!("{output}/{name}")))
}
