//! Where a pipeline runs and with what program.

use path_slash::PathExt as _;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::error::nearest;
use crate::paths::normalise;
use crate::{Pipeline, PipelineError, Stage};

/// The directories and files of one run, all chosen by the caller.
#[derive(Debug, Clone)]
pub struct Place {
    /// Relative paths of the pipeline file start here, and stages run here.
    pub root: PathBuf,
    /// What each output was made from; `<ledger>.journal` (what a run has done that is
    /// not over), `<ledger>.hashes` (a cache that may be deleted), `<ledger>.running` (the
    /// lock) and `<ledger>.jobs` (what a cluster has to do) stand beside it.
    pub ledger: PathBuf,
    /// Holds `<stage>.log`, everything the stage's last run printed. A relative path
    /// starts at the current directory, as does the ledger's.
    pub log_dir: PathBuf,
    /// The program that stages may call by name.
    pub program: Option<Program>,
}

/// A program whose commands stages call by its name, wherever it is installed.
///
/// Its version command by command, not its bytes, is what outputs are made from: an
/// unrelated release does not rebuild a study.
#[derive(Debug, Clone)]
pub struct Program {
    /// The first word of a stage's `cmd` that means this program.
    pub name: String,
    /// The executable that is run instead; absolute.
    pub path: PathBuf,
    /// Arguments before those of the stage, where the program is one of an interpreter (`python -m name`).
    pub leading: Vec<String>,
    /// Version of each command's numbers, by the command's name (the second word).
    pub versions: BTreeMap<String, String>,
}

impl Program {
    /// Refuses commands that it does not have.
    fn check(&self, pipeline: &Pipeline) -> Result<(), PipelineError> {
        for stage in pipeline.stages() {
            let command = stage.command.get(1).map_or("", String::as_str);
            if stage.command[0] == self.name && !self.versions.contains_key(command) {
                return Err(PipelineError::UnknownCommand {
                    stage: stage.name.clone(),
                    program: self.name.clone(),
                    command: command.to_owned(),
                    nearest: nearest(command, self.versions.keys().map(String::as_str)),
                });
            }
        }
        Ok(())
    }
}

impl Place {
    /// A run in a folder, with its ledger and logs in `.pipeline` there, of programs by their own names.
    pub fn below(root: &Path) -> Self {
        let folder = root.join(".pipeline");
        Self {
            root: root.to_owned(),
            ledger: folder.join("lock"),
            log_dir: folder.join("logs"),
            program: None,
        }
    }

    pub(crate) fn hash_cache(&self) -> PathBuf {
        self.beside_ledger(".hashes")
    }

    pub(crate) fn lock(&self) -> PathBuf {
        self.beside_ledger(".running")
    }

    /// What was handed to a cluster and is not settled.
    pub(crate) fn jobs(&self) -> PathBuf {
        self.beside_ledger(".jobs")
    }

    /// The executable that a stage's command means.
    pub(crate) fn program_of(&self, stage: &Stage) -> PathBuf {
        match &self.program {
            Some(program) if program.name == stage.command[0] => program.path.clone(),
            _ => PathBuf::from(&stage.command[0]),
        }
    }

    /// What that executable is given for a stage, of whose directories `files` are its own.
    pub(crate) fn arguments_of(&self, stage: &Stage, files: &[String]) -> Vec<String> {
        let arguments = stage.arguments(files);
        match &self.program {
            Some(program) if program.name == stage.command[0] => {
                program.leading.iter().cloned().chain(arguments).collect()
            }
            _ => arguments,
        }
    }

    pub(crate) fn log_of(&self, stage: &str) -> PathBuf {
        self.log_dir.join(format!("{stage}.log"))
    }

    /// What the last good run of a stage into the place with this key printed.
    pub(crate) fn stdout_of(&self, stage: &str, key: &str) -> PathBuf {
        let place = blake3::hash(key.as_bytes()).to_hex();
        self.log_dir.join(format!("{stage}.{}.out", &place[..8]))
    }

    /// Refuses stages that call a command which our program does not have, would remove what the run needs, or be changed by its ledger.
    pub(crate) fn check(&self, pipeline: &Pipeline) -> Result<(), PipelineError> {
        if let Some(program) = &self.program {
            program.check(pipeline)?;
        }
        let kept = [self.ledger.as_path(), &self.log_dir].map(|path| (path, one_spelling(path)));
        let fixed = [self.root.as_path(), pipeline.path()].map(|path| (path, one_spelling(path)));
        for stage in pipeline.stages() {
            for output in &stage.outputs {
                self.refuse_inside(stage, output, kept.iter().chain(&fixed))?;
            }
            for input in stage.reads() {
                self.refuse_inside(stage, input, kept.iter())?;
            }
        }
        Ok(())
    }

    fn refuse_inside<'a>(
        &self,
        stage: &Stage,
        directory: &str,
        mut paths: impl Iterator<Item = &'a (&'a Path, PathBuf)>,
    ) -> Result<(), PipelineError> {
        let full = one_spelling(&self.root.join(directory));
        match paths.find(|(_, path)| path.starts_with(&full)) {
            None => Ok(()),
            Some((path, _)) => Err(PipelineError::HoldsOurs {
                stage: stage.name.clone(),
                directory: directory.to_owned(),
                path: path.to_path_buf(),
            }),
        }
    }

    /// The root as seen from the ledger's folder, which is there: a project that is moved as a whole keeps it.
    pub(crate) fn root_from_ledger(&self) -> String {
        from_folder(&self.ledger_folder(), &real(&self.root))
    }

    /// The folder that [`Place::root_from_ledger`] means.
    pub(crate) fn folder_from_ledger(&self, way: &str) -> PathBuf {
        one_spelling(&self.ledger_folder().join(way))
    }

    fn ledger_folder(&self) -> PathBuf {
        match self.ledger.parent() {
            Some(folder) if folder != Path::new("") => real(folder),
            _ => real(Path::new(".")),
        }
    }

    fn beside_ledger(&self, suffix: &str) -> PathBuf {
        let mut name = self.ledger.as_os_str().to_owned();
        name.push(suffix);
        PathBuf::from(name)
    }
}

/// The absolute path without links; of what is not there, as it is spelled.
fn real(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| one_spelling(path))
}

/// The way from one folder to another, both absolute; the other itself where they have nothing in common.
fn from_folder(folder: &Path, other: &Path) -> String {
    let common = folder.components().zip(other.components());
    let common = common.take_while(|(a, b)| a == b).count();
    if common == 0 {
        return other.to_slash_lossy().into_owned();
    }
    let up = folder.components().skip(common).map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(other.components().skip(common)).collect();
    if way == Path::new("") { ".".to_owned() } else { way.to_slash_lossy().into_owned() }
}

/// The absolute path without `..`; symbolic links are not looked at.
fn one_spelling(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    match absolute.to_str().and_then(normalise) {
        Some(text) => PathBuf::from(text),
        None => absolute,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn a_run_s_own_files_stand_beside_its_ledger_and_below_its_logs() {
        let place = Place {
            root: PathBuf::from("/study"),
            ledger: PathBuf::from("/study/own/lock"),
            log_dir: PathBuf::from("/study/own/logs"),
            program: None,
        };
        assert_eq!(place.hash_cache(), Path::new("/study/own/lock.hashes"));
        assert_eq!(place.lock(), Path::new("/study/own/lock.running"));
        assert_eq!(place.jobs(), Path::new("/study/own/lock.jobs"));
        assert_eq!(place.log_of("a"), Path::new("/study/own/logs/a.log"));
        assert_ne!(place.stdout_of("a", "one"), place.stdout_of("a", "two"));
    }

    #[test]
    fn the_way_from_the_ledger_to_the_root_is_that_of_the_project_wherever_it_lies() {
        for (folder, root, way) in [
            ("/study/pipelines", "/study", ".."),
            ("/study", "/study", "."),
            ("/study", "/study/sub", "sub"),
            ("/elsewhere/study/own", "/elsewhere/other", "../../other"),
        ] {
            assert_eq!(from_folder(Path::new(folder), Path::new(root)), way);
        }
    }

    #[test]
    fn a_stage_that_calls_the_program_by_name_gets_its_path_and_leading_words() {
        let pipeline = crate::testing::pipeline(&[("a", &[], &["b"])]);
        let stage = &pipeline.stages()[0];
        let mut place = Place::below(Path::new("/study"));
        assert_eq!(place.ledger, Path::new("/study/.pipeline/lock"));
        assert_eq!(place.program_of(stage), Path::new("x"));
        assert_eq!(place.arguments_of(stage, &[]), stage.arguments(&[]));
        for (name, is_it) in [("x", true), ("y", false)] {
            place.program = Some(Program {
                name: name.to_owned(),
                path: PathBuf::from("/bin/python"),
                leading: vec!["-m".to_owned(), "x".to_owned()],
                versions: BTreeMap::new(),
            });
            let program = if is_it { "/bin/python" } else { "x" };
            assert_eq!(place.program_of(stage), Path::new(program));
            let leading = if is_it { 2 } else { 0 };
            let arguments = place.arguments_of(stage, &[]);
            assert_eq!(arguments.len(), stage.arguments(&[]).len() + leading);
            assert_eq!(arguments[leading..], stage.arguments(&[]));
        }
    }
}
