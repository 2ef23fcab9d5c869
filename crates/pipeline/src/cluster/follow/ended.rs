//! A task that has told how it ended: what of it is believed, and what is entered into the ledger.

use std::collections::BTreeSet;
use std::fs;

use super::Follower;
use crate::attempt::{Attempt, News, Run};
use crate::cluster::{ending::Ending, jobs::Task, script};
use crate::{FailureCause, PipelineError, Stage};

/// Last lines of a failed stage that are told.
const TOLD_LINES: usize = 20;

impl Follower<'_> {
    /// Enters a stage that has ended by itself.
    pub(super) fn ended(
        &self,
        index: usize,
        task: &Task,
        ending: &Ending,
        tell: &mut dyn FnMut(News),
    ) -> Result<Attempt, PipelineError> {
        let (stage, seconds) = (self.graph.stage(index), ending.seconds);
        let log = self.keep_log(stage, task)?;
        let moved = || stage.outputs.iter().filter(|path| script::is_moved(path));
        let mut stamps = Vec::new();
        if ending.code == 0 {
            for output in moved() {
                stamps.extend(self.workshop.hasher.stamps(output)?);
            }
            stamps.sort_unstable();
        }
        let is_as_made = ending.code == 0 && stamps == ending.made;
        let failed = |cause| {
            // What stands where nothing was moved is not the task's own. Where it is no longer what the task made, or only some was
            // moved, nobody knows whose it is: its outputs stay open.
            if ending.has_moved_nothing() {
                self.workshop.leave_some(stage, |path| !script::is_moved(path))?;
            } else if is_as_made {
                self.workshop.leave(stage)?;
            }
            let failure = self.workshop.failure(stage, &[], cause, log.clone(), Some(seconds));
            Ok(Attempt::Failed(failure))
        };
        if ending.code != 0 {
            let root = &self.workshop.place.root;
            let is_there = |path: &&String| {
                let full = root.join(path);
                // A link to an empty folder is where its output may go.
                let is_room = full.is_symlink()
                    && fs::read_dir(&full).is_ok_and(|mut entries| entries.next().is_none());
                full.symlink_metadata().is_ok() && !is_room
            };
            let paths: Vec<String> = moved().filter(is_there).cloned().collect();
            let in_the_way = ending.word.as_deref() == Some(script::IN_THE_WAY);
            return failed(if in_the_way && !paths.is_empty() {
                FailureCause::Foreign { paths }
            } else {
                FailureCause::Exit { code: ending.code }
            });
        }
        if !ending.made.is_empty() && !is_as_made {
            let paths = stage.outputs.clone();
            return failed(FailureCause::OutputsChanged { paths });
        }
        let paths = self.makers_apart(index, task)?;
        if !paths.is_empty() {
            return failed(self.workshop.inputs_changed(paths)?);
        }
        let stdout = read_text(&script::printed(&task.spool, task.index, "out"));
        let now = self.workshop.look(stage)?;
        let is_open = |path: &str| was_open(stage, task, path);
        let run = Run {
            made_from: task.made_from.clone().with_inputs(&now.made_from, is_open),
            seconds,
            peak_memory: None,
            stdout: &stdout,
        };
        match self.workshop.record(stage, run, tell)? {
            None => Ok(Attempt::Done { seconds, peak_memory: None }),
            Some(cause) => failed(cause),
        }
    }

    /// What makers made that had not ended when a task was handed in, and that is no longer as they had left it: nobody knows from which
    /// content the task made its outputs.
    fn makers_apart(&self, index: usize, task: &Task) -> Result<Vec<String>, PipelineError> {
        let ledger = self.workshop.ledger();
        let mut apart = BTreeSet::new();
        for need in self.graph.needs(index) {
            if !was_open(self.graph.stage(index), task, &need.input) {
                continue;
            }
            let maker = self.graph.stage(need.maker);
            let record = ledger.get().record_of(maker);
            let outputs = match record {
                Some(record) if record.outputs.contains_key(&need.input) => {
                    std::slice::from_ref(&need.input)
                }
                _ => &maker.outputs[..],
            };
            for output in outputs {
                let content = record.and_then(|record| record.outputs.get(output));
                if content.is_none() || self.workshop.hasher.content(output)?.as_ref() != content {
                    apart.insert(output.clone());
                }
            }
        }
        Ok(apart.into_iter().collect())
    }

    /// Puts what a task printed where a local run would have, and returns its last lines.
    pub(super) fn keep_log(
        &self,
        stage: &Stage,
        task: &Task,
    ) -> Result<Vec<String>, PipelineError> {
        let printed = |stream| read_text(&script::printed(&task.spool, task.index, stream));
        let command = crate::shell::quoted(&stage.command);
        let text = format!("$ {command}\n{}{}", printed("out"), printed("err"));
        let path = self.workshop.place.log_of(&stage.name);
        fs::write(&path, &text).map_err(PipelineError::io("write the log", &path))?;
        let lines: Vec<&str> = text.lines().skip(1).collect();
        let last = lines.len().saturating_sub(TOLD_LINES);
        Ok(lines[last..].iter().map(|line| (*line).to_owned()).collect())
    }
}

/// Whether an input was still to be made when its task was handed in; a shard is handed in when all its files are there.
pub(super) fn was_open(stage: &Stage, task: &Task, input: &str) -> bool {
    stage.share.is_none() && !task.made_from.has_input(input)
}

fn read_text(path: &std::path::Path) -> String {
    fs::read(path)
        .map_or_else(|_| String::new(), |bytes| String::from_utf8_lossy(&bytes).into_owned())
}
