//! Commands that say themselves what they read and write, in the place of `inputs` and `outputs`.

use super::value::{Located, Value};
use crate::error::FileProblem;
use crate::paths::{normalise, with_ancestors};
use crate::stage::{FILES, Stage};
use std::collections::BTreeSet;
use std::path::Path;

/// A program that knows the files of its own commands: a stage that calls it needs neither `inputs` nor `outputs`.
#[derive(Debug, Clone, Copy)]
pub struct Commands {
    /// The first word of a stage's `cmd` that means this program.
    pub program: &'static str,
    /// What a command reads and writes, by the words after the program's name, run in the folder that comes first; none of a
    /// command whose files it does not know. An error says why the words are no such command.
    pub files: fn(&Path, &[String]) -> Result<Option<CommandFiles>, String>,
}

/// What a command reads and writes; paths from the folder where it runs.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CommandFiles {
    /// Files or whole directories that it reads.
    pub inputs: Vec<String>,
    /// Those that it reads if they are there: inputs where a stage makes them or they stand on the disk.
    pub if_there: Vec<String>,
    /// Files or whole directories that it makes.
    pub outputs: Vec<String>,
}

impl Commands {
    /// The files of a stage's command, paths in one spelling.
    pub(super) fn files_of(
        self,
        root: &Path,
        command: &[String],
        at: usize,
    ) -> Result<Option<CommandFiles>, Located> {
        let Some((program, words)) = command.split_first() else {
            return Ok(None);
        };
        if program != self.program {
            return Ok(None);
        }
        let files = (self.files)(root, words).map_err(|message| Located {
            at,
            problem: FileProblem::NoCommand { message },
        })?;
        let Some(files) = files else { return Ok(None) };
        let spelled = |paths: Vec<String>| {
            let mut spelled: Vec<String> = Vec::new();
            for path in paths.into_iter().filter(|path| path != FILES) {
                let Some(path) = normalise(&path) else {
                    let problem = FileProblem::BadPath { path };
                    return Err(Located { at, problem });
                };
                if !spelled.contains(&path) {
                    spelled.push(path);
                }
            }
            Ok(spelled)
        };
        Ok(Some(CommandFiles {
            inputs: spelled(files.inputs)?,
            if_there: spelled(files.if_there)?,
            outputs: spelled(files.outputs)?,
        }))
    }
}

impl CommandFiles {
    /// Refuses a list of a pipeline file that says something else.
    pub(super) fn check(
        &self,
        key: &'static str,
        value: Option<&Value<'_>>,
        written: &[String],
    ) -> Result<(), Located> {
        let Some(value) = value else { return Ok(()) };
        let (must, others) = match key {
            "inputs" => (&self.inputs, &self.if_there[..]),
            _ => (&self.outputs, &[][..]),
        };
        let lacks = must.iter().filter(|path| !written.contains(path));
        let known = |path: &&String| must.contains(path) || others.contains(path);
        let strange = written.iter().filter(|path| !known(path));
        let (lacks, strange): (Vec<_>, Vec<_>) =
            (lacks.cloned().collect(), strange.cloned().collect());
        if lacks.is_empty() && strange.is_empty() {
            return Ok(());
        }
        Err(Located {
            at: value.span().start,
            problem: FileProblem::OtherFiles {
                key,
                lacks,
                strange,
            },
        })
    }

    /// Whether a path is in any of its own.
    pub(super) fn has_in_path(&self, text: &str) -> bool {
        let mut all = self
            .inputs
            .iter()
            .chain(&self.if_there)
            .chain(&self.outputs);
        all.any(|path| path.contains(text))
    }
}

/// Adds to each stage what it reads if it is there: made by another stage, fetched, or on the disk.
pub(super) fn add_what_is_there<'f>(
    stages: &mut [Stage],
    if_there: Vec<Vec<String>>,
    fetched: impl Iterator<Item = &'f String>,
    root: &Path,
) {
    let made = stages.iter().flat_map(|stage| &stage.outputs).cloned();
    let made: BTreeSet<String> = made.chain(fetched.cloned()).collect();
    for (stage, paths) in stages.iter_mut().zip(if_there) {
        for path in paths {
            let folder = format!("{path}/");
            let inside = made.range(folder.clone()..).next();
            let is_made = with_ancestors(&path).any(|above| made.contains(above))
                || inside.is_some_and(|first| first.starts_with(&folder));
            let own = stage.outputs.iter().any(|output| {
                with_ancestors(&path).any(|above| above == output) || output.starts_with(&folder)
            });
            if !own && !stage.inputs.contains(&path) && (is_made || root.join(&path).exists()) {
                stage.inputs.push(path);
            }
        }
    }
}
