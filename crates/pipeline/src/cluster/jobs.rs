//! What a cluster has to do for a pipeline, kept beside the ledger until it is settled.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use super::{ending::Ending, engine, script};
use crate::atomic_write::{Durability, atomic_write_bytes};
use crate::content::Hasher;
use crate::ledger::OpenLedger;
use crate::{Executor, Manifest, PipelineError, Place};

/// Everything that was handed in and is not settled, so that another process can follow it.
///
/// What happens is noted in the file line by line: with a hundred thousand tasks, writing all
/// of them whenever one ends would be terabytes.
#[derive(Debug)]
pub(super) struct Jobs {
    pub(super) engine: Executor,
    pub(super) tasks: BTreeMap<String, Task>,
    path: PathBuf,
    file: Option<File>,
}

/// A line of the file.
#[derive(Debug, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    /// The first line.
    Engine(Executor),
    /// A stage is about to be handed in.
    Task { stage: String, task: Task },
    /// The cluster has accepted a row of tasks.
    Job(Accepted),
    /// A stage is settled.
    Settled(String),
}

/// That the cluster has accepted tasks as a job.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Accepted {
    /// Where their scripts are.
    pub(super) spool: PathBuf,
    /// Their numbers in the plan.
    pub(super) tasks: std::ops::Range<u32>,
    /// As the cluster calls it.
    pub(super) job: String,
    /// Whether tasks have the plan's numbers in the job too; they count from 0 otherwise.
    pub(super) numbered: bool,
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
    /// Under which the ledger has noted that the stage was begun.
    pub(super) key: String,
}

impl Task {
    /// As the cluster calls it.
    pub(super) fn id(&self) -> String {
        format!("{}_{}", self.job, self.number)
    }

    /// Keeps a task that may still run from putting its outputs in place. If it has put none there, what stands there is noted as
    /// not its stage's.
    pub(super) fn give_up(
        &self,
        ledger: &mut OpenLedger,
        hasher: &Hasher<'_>,
    ) -> Result<(), PipelineError> {
        let _ = fs::remove_file(script::script(&self.spool, self.index));
        let is_first = fs::create_dir(script::first(&self.spool, self.index)).is_ok();
        let ending = || Ending::read(&self.spool, self.index);
        let has_moved_nothing = is_first || ending().is_some_and(|e| e.has_moved_nothing());
        let left = ledger.get().left.get(&self.key);
        let Some(left) = left.filter(|left| has_moved_nothing && !left.open.is_empty()) else {
            return Ok(());
        };
        let written = left.open.iter().filter(|path| !script::is_moved(path));
        let files = hasher.names_in(written)?;
        ledger.leave(&self.key, files)
    }
}

impl Jobs {
    pub(super) fn new(engine: Executor, path: PathBuf) -> Self {
        Self { engine, tasks: BTreeMap::new(), path, file: None }
    }

    pub(super) fn read(path: &Path) -> Result<Option<Self>, PipelineError> {
        let bytes = match fs::read(path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            bytes => bytes.map_err(PipelineError::io("read", path))?,
        };
        let damaged = |line: usize, message: String| PipelineError::LedgerDamaged {
            path: path.to_owned(),
            message: format!("line {line}: {message}"),
        };
        let text = String::from_utf8_lossy(&bytes);
        // A last line without its end was being written when the run was killed.
        let mut lines = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
        let line_in = |number: usize, line: &str| {
            serde_json::from_str::<Line>(line).map_err(|error| damaged(number, error.to_string()))
        };
        let first = lines.next().map(|line| line_in(1, line)).transpose()?;
        let engine = match first {
            None => return Ok(None),
            Some(Line::Engine(engine)) => engine,
            Some(_) => return Err(damaged(1, "the cluster's program was expected".to_owned())),
        };
        let mut jobs = Self::new(engine, path.to_owned());
        for (number, line) in lines.enumerate() {
            jobs.apply(line_in(number + 2, line)?);
        }
        Ok(Some(jobs))
    }

    fn apply(&mut self, line: Line) {
        match line {
            Line::Engine(_) => {}
            Line::Task { stage, task } => drop(self.tasks.insert(stage, task)),
            Line::Settled(stage) => drop(self.tasks.remove(&stage)),
            Line::Job(accepted) => {
                let tasks = self.tasks.values_mut();
                for task in tasks.filter(|task| task.spool == accepted.spool) {
                    if accepted.tasks.contains(&task.index) {
                        accepted.job.clone_into(&mut task.job);
                        if accepted.numbered {
                            task.number = task.index;
                        }
                    }
                }
            }
        }
    }

    /// Notes stages that are about to be handed in.
    pub(super) fn begin(&mut self, tasks: Vec<(String, Task)>) -> Result<(), PipelineError> {
        let lines = tasks.into_iter();
        let lines = lines.map(|(stage, task)| Line::Task { stage, task });
        self.note(lines.collect())?;
        self.sync()
    }

    /// Notes that the cluster has accepted tasks.
    pub(super) fn accept(&mut self, accepted: Accepted) -> Result<(), PipelineError> {
        self.note(vec![Line::Job(accepted)])?;
        self.sync()
    }

    /// Notes that a stage is settled.
    pub(super) fn settle(&mut self, stage: &str) -> Result<(), PipelineError> {
        self.note(vec![Line::Settled(stage.to_owned())])
    }

    fn note(&mut self, lines: Vec<Line>) -> Result<(), PipelineError> {
        let failed = || PipelineError::io("write", &self.path);
        let mut text = String::new();
        if self.file.is_none() {
            if !self.path.exists() {
                text = json(&Line::Engine(self.engine)).map_err(failed())?;
            }
            let mut options = fs::OpenOptions::new();
            let file = options.create(true).append(true).open(&self.path);
            self.file = Some(file.map_err(failed())?);
        }
        for line in &lines {
            text.push_str(&json(line).map_err(PipelineError::io("write", &self.path))?);
        }
        let file = self.file.as_mut();
        let written = file.map_or(Ok(()), |file| file.write_all(text.as_bytes()));
        written.map_err(PipelineError::io("write", &self.path))?;
        for line in lines {
            self.apply(line);
        }
        Ok(())
    }

    fn sync(&self) -> Result<(), PipelineError> {
        let file = self.file.as_ref().map_or(Ok(()), File::sync_data);
        file.map_err(PipelineError::io("write", &self.path))
    }

    /// Writes the file anew with what is open, or removes it if nothing is.
    pub(super) fn compact(&mut self) -> Result<(), PipelineError> {
        self.file = None;
        if self.tasks.is_empty() {
            return match fs::remove_file(&self.path) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    Err(PipelineError::io("remove", &self.path)(error))
                }
                _ => Ok(()),
            };
        }
        let failed = || PipelineError::io("write", &self.path);
        let mut text = json(&Line::Engine(self.engine)).map_err(failed())?;
        for (stage, task) in &self.tasks {
            let line = Line::Task { stage: stage.clone(), task: task.clone() };
            text.push_str(&json(&line).map_err(failed())?);
        }
        atomic_write_bytes(&self.path, text.as_bytes(), Durability::Synced)
    }

    pub(super) fn jobs(&self) -> BTreeSet<String> {
        let jobs = self.tasks.values().map(|task| &task.job);
        jobs.filter(|job| !job.is_empty()).cloned().collect()
    }

    /// The tasks that have told how they ended, found by one listing of each folder: a look at
    /// a file that is not there is what network file systems answer from memory.
    pub(super) fn ended(&self) -> BTreeSet<(PathBuf, u32)> {
        let spools: BTreeSet<&PathBuf> = self.tasks.values().map(|task| &task.spool).collect();
        let mut ended = BTreeSet::new();
        for spool in spools {
            for entry in fs::read_dir(spool).into_iter().flatten().flatten() {
                let name = entry.file_name();
                let number = name.to_str().and_then(|name| name.strip_suffix(".ended"));
                if let Some(number) = number.and_then(|number| number.parse().ok()) {
                    ended.insert((spool.clone(), number));
                }
            }
        }
        ended
    }
}

/// A line with its end.
fn json(line: &Line) -> std::io::Result<String> {
    Ok(serde_json::to_string(line)? + "\n")
}

/// Refuses to work beside jobs that an earlier run left; forgets those that have ended.
pub(crate) fn refuse_while_jobs_run(
    place: &Place,
    ledger: &mut OpenLedger,
    hasher: &Hasher<'_>,
) -> Result<(), PipelineError> {
    let Some(mut jobs) = Jobs::read(&place.jobs())? else {
        return Ok(());
    };
    let ids = jobs.jobs();
    let still: Vec<&Task> = match engine::alive(jobs.engine, &ids) {
        Ok(alive) => jobs.tasks.values().filter(|task| alive.contains(&task.id())).collect(),
        Err(_) => jobs.tasks.values().collect(), // not to be known from here
    };
    if !still.is_empty() {
        return Err(PipelineError::OnCluster {
            stages: still.len(),
            engine: engine::name(jobs.engine),
            jobs: ids.into_iter().collect(),
        });
    }
    for task in jobs.tasks.values() {
        task.give_up(ledger, hasher)?;
    }
    jobs.tasks.clear();
    jobs.compact()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_noted_line_by_line_is_read_and_a_half_line_is_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.jobs");
        let task = |index| Task {
            job: String::new(),
            index,
            number: index,
            spool: "/s".into(),
            made_from: Manifest::default(),
            key: String::new(),
        };
        let mut jobs = Jobs::new(Executor::Slurm, path.clone());
        let tasks = (0..5).map(|i| (format!("t{i}"), task(i))).collect();
        jobs.begin(tasks).unwrap();
        let accepted =
            Accepted { spool: "/s".into(), tasks: 1..3, job: "7".to_owned(), numbered: false };
        jobs.accept(accepted).unwrap();
        let before = fs::metadata(&path).unwrap().len();
        jobs.settle("t1").unwrap();
        let line = fs::metadata(&path).unwrap().len() - before;
        assert!(line < 20, "a task that ends costs {line} bytes");
        let read = || {
            let jobs = Jobs::read(&path).unwrap().unwrap();
            let ids = jobs.tasks.iter().map(|(stage, task)| format!("{stage}:{}", task.job));
            ids.collect::<Vec<_>>().join(" ")
        };
        assert_eq!(read(), "t0: t2:7 t3: t4:");
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, format!("{text}{{\"settled\":\"t0")).unwrap();
        assert_eq!(read(), "t0: t2:7 t3: t4:");
        Jobs::read(&path).unwrap().unwrap().compact().unwrap();
        assert_eq!(read(), "t0: t2:7 t3: t4:");
        fs::write(&path, "{}\n").unwrap();
        assert!(matches!(Jobs::read(&path), Err(PipelineError::LedgerDamaged { .. })));
    }
}
