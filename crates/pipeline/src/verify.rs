//! Whether the files are still what the ledger says.

use std::collections::BTreeSet;

use crate::content::Hasher;
use crate::{FactKind, Graph, Ledger, Pipeline, PipelineError, Place};

/// What was found when all files were read again.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Verification {
    /// How many inputs and outputs (files or whole directories) were compared.
    pub compared: usize,
    /// Those that are not as they were.
    pub findings: Vec<Finding>,
    /// Stages of the pipeline without a record of a finished run.
    pub never_run: Vec<String>,
}

/// An input or output that is not as the ledger says.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Finding {
    /// The stage whose record says so.
    pub stage: String,
    /// The path, relative to the root.
    pub path: String,
    /// Whether the stage reads or makes it.
    pub role: Role,
    /// How it is now; never [`FileState::Same`].
    pub state: FileState,
}

/// What a path is to a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// The stage reads it.
    Input,
    /// The stage makes it.
    Output,
}

/// A file now, against what is recorded of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FileState {
    /// As it was.
    Same,
    /// With another content.
    Changed,
    /// Not there.
    Missing,
    /// There, and the pipeline no longer makes it; only [`verify`] says so.
    NoLongerMade,
}

impl FileState {
    pub(crate) fn compare(
        path: &str,
        recorded: &str,
        hasher: &Hasher<'_>,
    ) -> Result<Self, PipelineError> {
        Ok(match hasher.content(path)? {
            None => Self::Missing,
            Some(content) if content == recorded => Self::Same,
            Some(_) => Self::Changed,
        })
    }
}

/// Reads every input and output of every recorded stage and compares it with the ledger,
/// believing neither times nor remembered hashes.
///
/// # Errors
/// If the ledger or a file cannot be read.
pub fn verify(pipeline: &Pipeline, place: &Place) -> Result<Verification, PipelineError> {
    let ledger = Ledger::read(&place.ledger, pipeline.name())?;
    let hasher = Hasher::reading_all(&place.root);
    let mut compared = BTreeSet::new();
    let mut findings = Vec::new();
    let recorded = pipeline
        .stages()
        .iter()
        .filter_map(|stage| ledger.record_of(stage));
    for record in recorded {
        let inputs = record.made_from.facts(FactKind::Input);
        let outputs = record.outputs.iter();
        let outputs = outputs.map(|(path, content)| (Role::Output, path.as_str(), &**content));
        let inputs = inputs.map(|(path, content)| (Role::Input, path, content));
        for (role, path, content) in outputs.chain(inputs) {
            compared.insert(path.to_owned());
            let state = FileState::compare(path, content, &hasher)?;
            if state != FileState::Same {
                findings.push(Finding {
                    stage: record.stage.clone(),
                    path: path.to_owned(),
                    role,
                    state,
                });
            }
        }
    }
    let graph = Graph::new(pipeline)?;
    for key in crate::orphans::orphans(&graph, &ledger) {
        for path in ledger.made_by(&key).into_keys() {
            if place.root.join(path).symlink_metadata().is_ok() {
                compared.insert(path.to_owned());
                findings.push(Finding {
                    stage: ledger.stage_of(&key).unwrap_or_default().to_owned(),
                    path: path.to_owned(),
                    role: Role::Output,
                    state: FileState::NoLongerMade,
                });
            }
        }
    }
    let stages = pipeline.stages().iter();
    let never_run = stages.filter(|stage| ledger.record_of(stage).is_none());
    Ok(Verification {
        compared: compared.len(),
        findings,
        never_run: never_run.map(|stage| stage.name.clone()).collect(),
    })
}
