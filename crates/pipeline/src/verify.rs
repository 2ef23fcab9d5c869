//! Whether the files are still what the ledger says.

use std::collections::BTreeSet;

use crate::content::Hasher;
use crate::{FactKind, Graph, Pipeline, PipelineError, Place, Stage, ledger};

/// What was found when all files were read again.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Verification {
    /// How many inputs and outputs (files or whole directories) were compared.
    pub compared: usize,
    /// Those that are not as they were.
    pub findings: Vec<Finding>,
    /// Stages of the pipeline that never ran.
    pub never_run: Vec<String>,
    /// Stages whose last run was begun and did not end well: nothing is known of what lies in their outputs.
    pub unfinished: Vec<String>,
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
        role: Role,
        hasher: &Hasher<'_>,
    ) -> Result<Self, PipelineError> {
        let now = match role {
            Role::Input => hasher.input(path)?,
            Role::Output => hasher.content(path)?,
        };
        Ok(match now {
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
    let ledger = ledger::load_at(place, pipeline.name())?.ledger;
    let hasher = Hasher::reading_all(&place.root);
    let mut compared = BTreeSet::new();
    let mut findings = Vec::new();
    let recorded = pipeline.stages().iter().filter_map(|stage| ledger.record_of(stage));
    for record in recorded {
        let inputs = record.made_from.facts(FactKind::Input);
        let outputs = record.outputs.iter();
        let outputs = outputs.map(|(path, content)| (Role::Output, path.as_str(), &**content));
        let inputs = inputs.map(|(path, content)| (Role::Input, path, content));
        for (role, path, content) in outputs.chain(inputs) {
            compared.insert(path.to_owned());
            let state = FileState::compare(path, content, role, &hasher)?;
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
    let (unfinished, never_run): (Vec<&Stage>, Vec<&Stage>) = stages
        .filter(|stage| ledger.record_of(stage).is_none())
        .partition(|stage| ledger.left.contains_key(&stage.key()));
    let names = |stages: Vec<&Stage>| stages.iter().map(|stage| stage.name.clone()).collect();
    Ok(Verification {
        compared: compared.len(),
        findings,
        never_run: names(never_run),
        unfinished: names(unfinished),
    })
}
