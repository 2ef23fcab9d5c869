//! A stage: a command whose arguments say what it reads, what it writes and what it does.

use crate::{
    design::{DESIGN_FILE, DesignFile},
    error::StudyError,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    tables::collected::{NOT_ADMITTED, STOPPED},
};
use std::path::{Path, PathBuf};

/// A command of the program: its fields are its arguments, with their help and defaults.
pub trait Stage: clap::Args {
    const NAME: &'static str;
    /// What is said before the reason when it fails.
    const FAILURE: &'static str;
    type Result: serde::Serialize;

    /// What it reads and what it writes, run in the folder `root`: paths as it would be given them there.
    ///
    /// # Errors
    /// [`StudyError`] where nothing says what it writes.
    fn files(&self, root: &Path) -> Result<Files, StudyError>;

    /// The work itself, by [`Stage::run`].
    ///
    /// # Errors
    /// As the stage says.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Self::Result>, StudyError>;

    /// Does the work, unless an output is one of its inputs.
    ///
    /// # Errors
    /// [`StudyError`] naming the file that cannot be read, used or written; [`StudyError::Interrupted`].
    fn run(&self, watch: Watch<'_>) -> Result<Outcome<Self::Result>, StudyError> {
        self.files(Path::new(""))?.spare_inputs()?;
        self.work(watch)
    }

    /// Takes the command that its page says to repeat, where none was given.
    fn repeated_by(&mut self, _command: &str) {}

    /// Whether the program may end well with this result.
    fn is_success(&self, _result: &Self::Result) -> bool {
        true
    }
}

/// What a stage reads and what it writes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Files {
    /// Files and whole folders without which it cannot work.
    pub inputs: Vec<PathBuf>,
    /// Files and whole folders that it reads if they are there.
    pub if_there: Vec<PathBuf>,
    /// Files and whole folders that it writes.
    pub outputs: Vec<PathBuf>,
    /// Files in the folders among them that no input may be.
    written: Vec<PathBuf>,
}

impl Files {
    #[must_use]
    pub fn reads(mut self, paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        self.inputs.extend(paths.into_iter().map(|p| p.as_ref().to_owned()));
        self
    }

    /// With inputs that need not be there.
    #[must_use]
    pub fn reads_if_there(mut self, paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        self.if_there.extend(paths.into_iter().map(|p| p.as_ref().to_owned()));
        self
    }

    /// With the design, if there is one to be read.
    #[must_use]
    pub fn reads_design(self, given: Option<&Path>) -> Self {
        match given {
            Some(design) => self.reads([design]),
            None => self.reads_if_there([DESIGN_FILE]),
        }
    }

    /// With the design, if there is one, and the table of who takes part.
    #[must_use]
    pub fn reads_people(
        self,
        root: &Path,
        design: Option<&Path>,
        participants: Option<&Path>,
    ) -> Self {
        let study = DesignFile::below(root, design);
        let of_design = study.as_ref().filter(|_| participants.is_none());
        let collected = |file: &str| study.as_ref().map(|s| s.resolve(Path::new(file)));
        self.reads_design(design)
            .reads(participants)
            .reads_if_there(of_design.map(|study| study.people_file(None)))
            .reads_if_there(collected(STOPPED))
            .reads_if_there(collected(NOT_ADMITTED))
    }

    /// With the questionnaires that say the range of a design's style, where the design does not say it itself.
    #[must_use]
    pub fn reads_style(self, study: Option<&DesignFile>) -> Self {
        let asks = |s: &&DesignFile| s.design.style().is_some_and(|style| style.range.is_none());
        let scales = |s: &DesignFile| s.resolve(&s.design.files().scales);
        self.reads_if_there(study.filter(asks).map(scales))
    }

    #[must_use]
    pub fn writes(mut self, paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        self.outputs.extend(paths.into_iter().map(|p| p.as_ref().to_owned()));
        self
    }

    /// With a folder as an output, and the files in it that no input may be.
    #[must_use]
    pub fn writes_into(mut self, folder: &Path, names: &[&str]) -> Self {
        self.written.extend(names.iter().map(|name| folder.join(name)));
        self.outputs.push(folder.to_owned());
        self
    }

    /// Refuses outputs that are inputs, and two outputs that are one file.
    fn spare_inputs(&self) -> Result<(), StudyError> {
        let inputs = self.inputs.iter().chain(&self.if_there);
        let whole = |folder: &&PathBuf| self.written.iter().all(|file| !file.starts_with(folder));
        let outputs = self.outputs.iter().filter(whole).chain(&self.written);
        spare_inputs(inputs.map(|p| &**p), outputs.map(|p| &**p))
    }
}
