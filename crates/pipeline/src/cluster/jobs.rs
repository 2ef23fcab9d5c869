//! What a cluster has to do for a pipeline, kept beside the ledger until it is settled.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use super::{engine, script};
use crate::atomic_write::{self, Durability};
use crate::{Executor, Manifest, PipelineError, Place};

/// Everything that was handed in and is not settled, so that another process can follow it.
#[derive(Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Jobs {
    pub(super) engine: Executor,
    pub(super) tasks: BTreeMap<String, Task>,
}

/// One stage on the cluster.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Task {
    /// As the cluster calls the job; empty until it has accepted it.
    pub(super) job: String,
    /// Its number in the plan.
    pub(super) index: u32,
    /// Its number in the job.
    pub(super) number: u32,
    /// Scripts and endings.
    pub(super) spool: PathBuf,
    /// What the stage is made from, without the inputs that others were to make first.
    pub(super) made_from: Manifest,
}

impl Task {
    /// As the cluster calls it.
    pub(super) fn id(&self) -> String {
        format!("{}_{}", self.job, self.number)
    }

    /// Keeps a task that may still run from putting its outputs in place.
    pub(super) fn give_up(&self) {
        let _ = fs::remove_file(script::script(&self.spool, self.index));
    }
}

impl Jobs {
    pub(super) fn new(engine: Executor) -> Self {
        let tasks = BTreeMap::new();
        Self { engine, tasks }
    }

    pub(super) fn read(path: &Path) -> Result<Option<Self>, PipelineError> {
        let bytes = match fs::read(path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            bytes => bytes.map_err(PipelineError::io("read", path))?,
        };
        let jobs = serde_json::from_slice(&bytes);
        jobs.map(Some)
            .map_err(|error| PipelineError::LedgerDamaged {
                path: path.to_owned(),
                message: error.to_string(),
            })
    }

    /// Writes the file, or removes it if nothing is left.
    pub(super) fn write(&self, path: &Path) -> Result<(), PipelineError> {
        if self.tasks.is_empty() {
            return match fs::remove_file(path) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    Err(PipelineError::io("remove", path)(error))
                }
                _ => Ok(()),
            };
        }
        let json = serde_json::to_vec(self);
        let json = json.map_err(|error| PipelineError::io("write", path)(error.into()))?;
        atomic_write::write(path, &json, Durability::Synced)
    }

    pub(super) fn jobs(&self) -> BTreeSet<String> {
        let jobs = self.tasks.values().map(|task| &task.job);
        jobs.filter(|job| !job.is_empty()).cloned().collect()
    }
}

/// Refuses to work beside jobs that an earlier run left; forgets those that have ended.
pub(crate) fn refuse_while_jobs_run(place: &Place) -> Result<(), PipelineError> {
    let Some(mut jobs) = Jobs::read(&place.jobs())? else {
        return Ok(());
    };
    let all = jobs.jobs();
    let still: Vec<&Task> = match engine::alive(jobs.engine, &all) {
        Ok(alive) => jobs
            .tasks
            .values()
            .filter(|task| alive.contains(&task.id()))
            .collect(),
        Err(_) => jobs.tasks.values().collect(), // not to be known from here
    };
    if !still.is_empty() {
        return Err(PipelineError::OnCluster {
            stages: still.len(),
            engine: engine::name(jobs.engine),
            jobs: all.into_iter().collect(),
        });
    }
    jobs.tasks.values().for_each(Task::give_up);
    jobs.tasks.clear();
    jobs.write(&place.jobs())
}
