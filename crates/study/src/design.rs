//! The design of a study as a file: where it is, and what its paths mean.

use crate::{
    atomic_write::{if_there, read_text},
    error::StudyError,
    forgotten::ForgottenList,
    tables::{
        collected::{
            LENT, LentRow, NOT_ADMITTED, NOT_AGREED, STOPPED, consents_of_study, read_consents,
            read_lent,
        },
        drives::{drives_in, read_drives},
        keys::composed,
        participants::{Enrolled, read_enrolled},
        read_rows,
    },
};
use maveric_analysis::{ConsentRow, NotAdmitted, NotAgreed, Stopped};
use maveric_domain::{Design, Drive, DriveMeta, ParticipantId};
use maveric_participants::Part;
use path_slash::PathExt as _;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Name of a design in a study's folder.
pub const DESIGN_FILE: &str = "study.toml";

/// Where the paper's design stands, from which its paths are seen.
const PAPERS_FOLDER: &str = "study_data/designs";
/// The paper's design, as it is shipped.
const PAPER: &str = maveric_data::DESIGNS_PAPER;

/// A design, and where it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignFile {
    /// The file; none for the paper's that is built in.
    pub path: Option<PathBuf>,
    pub design: Design,
}

impl DesignFile {
    /// Reads a design.
    ///
    /// # Errors
    /// [`StudyError`] naming the file and the key.
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let text = read_text(path)?;
        let design = Design::from_toml(&composed(&text)).map_err(|e| StudyError::BadFile {
            path: path.to_owned(),
            problem: e.to_string(),
            help: e.suggestion(),
        })?;
        Ok(Self { path: Some(path.to_owned()), design })
    }

    /// The design that was asked for; else `study.toml` of the current directory; else the paper's.
    pub fn find(given: Option<&Path>) -> Result<Self, StudyError> {
        Self::here(given)?.map_or_else(Self::paper, Ok)
    }

    /// The design that was asked for; else `study.toml` of the current directory; else none: what works without a design.
    pub fn here(given: Option<&Path>) -> Result<Option<Self>, StudyError> {
        let in_folder = || Some(Path::new(DESIGN_FILE)).filter(|path| path.is_file());
        given.or_else(in_folder).map(Self::read).transpose()
    }

    /// As [`DesignFile::here`] in the folder `root`, its paths seen from there, to say which files a stage reads; none where it cannot be
    /// read either, which the stage's work says.
    pub fn below(root: &Path, given: Option<&Path>) -> Option<Self> {
        let path = given.unwrap_or(Path::new(DESIGN_FILE));
        let study = Self::read(&root.join(path)).ok()?;
        Some(Self { path: Some(path.to_owned()), ..study })
    }

    /// The same, else the paper's.
    pub(crate) fn below_or_paper(root: &Path, given: Option<&Path>) -> Result<Self, StudyError> {
        Self::below(root, given).map_or_else(Self::paper, Ok)
    }

    /// The paper's design.
    ///
    /// # Errors
    /// None: a test reads the file that is built in.
    pub fn paper() -> Result<Self, StudyError> {
        let design = Design::from_toml(PAPER)
            .map_err(|e| StudyError::file(Path::new("paper.toml"), e.to_string()))?;
        Ok(Self { path: None, design })
    }

    /// A path of the design, seen from where one stands.
    pub fn resolve(&self, path: &Path) -> PathBuf {
        let folder = self.path.as_deref().and_then(Path::parent);
        folder.unwrap_or(Path::new(PAPERS_FOLDER)).join(path)
    }

    /// A file or folder of a study: `given`; else the design's own, where it is not the paper's that is built in; else as the paper's is
    /// shipped.
    fn chosen(&self, given: Option<&Path>, own: Option<&Path>, shipped: &str) -> PathBuf {
        let own = own.filter(|_| self.path.is_some());
        let own = || own.map(|path| self.resolve(path));
        let given = given.map(Path::to_owned);
        given.or_else(own).unwrap_or_else(|| shipped.into())
    }

    /// The folder of questionnaires: `given`, or the design's own.
    pub fn scales_folder(&self, given: Option<&Path>) -> PathBuf {
        let own = &self.design.files().scales;
        self.chosen(given, Some(own), "study_data/scales")
    }

    /// The sizes of the effects: `given`, or the design's own.
    pub(crate) fn effects_file(&self, given: Option<&Path>) -> PathBuf {
        let own = self.design.files().effects.as_deref();
        self.chosen(given, own, "study_data/effects.toml")
    }

    /// The table of who takes part: `given`, or the design's own.
    pub fn people_file(&self, given: Option<&Path>) -> PathBuf {
        let of_design = || self.resolve(&self.design.people().file);
        given.map_or_else(of_design, Path::to_owned)
    }

    /// Who takes part, by [`DesignFile::people_file`].
    pub fn people(&self, given: Option<&Path>) -> Result<People, StudyError> {
        let path = &self.people_file(given);
        let enrolled = read_enrolled(path, &self.design)?;
        self.forgotten()?.refuse(path, enrolled.iter().map(|p| &p.id))?;
        Ok(People { enrolled })
    }

    /// The folder of the study.
    pub fn folder(&self) -> PathBuf {
        self.resolve(Path::new("")).components().collect()
    }

    /// Whoever was forgotten; nobody of the paper's design that is built in.
    pub fn forgotten(&self) -> Result<ForgottenList, StudyError> {
        if self.path.is_none() {
            return Ok(ForgottenList::default());
        }
        ForgottenList::read(&self.folder())
    }

    /// The drives and rides that people stopped in the seat.
    pub(crate) fn stopped(&self) -> Result<Vec<Stopped>, StudyError> {
        self.collected(STOPPED, read_rows)
    }

    /// The people whom a rule of `[protocol] admit_if` held back.
    pub(crate) fn not_admitted(&self) -> Result<Vec<NotAdmitted>, StudyError> {
        self.collected(NOT_ADMITTED, read_rows)
    }

    /// The texts that people agreed to in the seat.
    pub(crate) fn consents(&self) -> Result<Vec<ConsentRow>, StudyError> {
        self.collected(consents_of_study(), read_consents)
    }

    /// How many people did not agree, by the text.
    pub(crate) fn not_agreed(&self) -> Result<Vec<NotAgreed>, StudyError> {
        self.collected(NOT_AGREED, read_rows)
    }

    /// The styles that were lent in the seat.
    pub(crate) fn lent(&self) -> Result<Vec<LentRow>, StudyError> {
        self.collected(LENT, read_lent)
    }

    /// The rows of a file that the seat writes once there is something; none before.
    fn collected<T>(
        &self,
        file: impl AsRef<Path>,
        read: fn(&Path) -> Result<Vec<T>, StudyError>,
    ) -> Result<Vec<T>, StudyError> {
        if self.path.is_none() {
            return Ok(Vec::new());
        }
        if_there(&self.resolve(file.as_ref()), read)
    }

    /// Who takes part, of a run: `given`, or `participants.csv` among its results, or the design's own table.
    pub fn people_of(&self, results: &Path, given: Option<&Path>) -> Result<People, StudyError> {
        let beside = results.join("participants.csv");
        self.people(given.or_else(|| beside.is_file().then_some(beside.as_path())))
    }

    /// Refuses what is not to be declared before there are data: a primary outcome whose test can never be run.
    pub(crate) fn declarable(&self) -> Result<(), StudyError> {
        let checked = self.design.runnable();
        checked.map_err(|error| self.wrong(error.to_string(), error.suggestion()))
    }

    /// The name of the file, for messages.
    pub fn name(&self) -> String {
        let path = self.path.as_ref();
        path.map_or_else(|| "the paper's design".to_owned(), |p| p.to_slash_lossy().into_owned())
    }

    /// An error about a key of this design.
    pub fn wrong(&self, problem: impl Into<String>, help: Option<String>) -> StudyError {
        let problem = problem.into();
        match &self.path {
            Some(path) => StudyError::BadFile { path: path.clone(), problem, help },
            None => StudyError::NotPossible { problem, help },
        }
    }
}

/// The people of a study.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct People {
    /// In the order of their table.
    pub enrolled: Vec<Enrolled>,
}

impl People {
    /// The person of this id.
    pub fn find(&self, id: &ParticipantId) -> Option<&Enrolled> {
        self.enrolled.iter().find(|p| p.id == *id)
    }

    /// Those whose drives the networks learn from, less those who are left out.
    pub fn learned_from(&self) -> BTreeSet<ParticipantId> {
        self.left_in(|p| p.learned_from)
    }

    /// Those who sat through the conditions, less those who are left out.
    pub fn tested(&self) -> BTreeSet<ParticipantId> {
        self.left_in(|p| p.tested)
    }

    fn left_in(&self, takes_part: fn(&Enrolled) -> bool) -> BTreeSet<ParticipantId> {
        let left_in = self.enrolled.iter().filter(|p| p.excluded.is_none());
        let theirs = left_in.filter(|p| takes_part(p));
        theirs.map(|p| p.id.clone()).collect()
    }
}

/// The drives of a folder: all; with a design those of the people whom it learns from or, of those whom it tests, the drives that
/// the car is fitted to: the baseline by hand.
///
/// # Errors
/// [`StudyError`] if a drive or the design cannot be read, or none is left.
pub(crate) fn drives_of(
    folder: &Path,
    design: Option<&Path>,
    participants: Option<&Path>,
    part: Part,
) -> Result<Vec<Drive>, StudyError> {
    let Some(study) = DesignFile::here(design)? else {
        return read_drives(folder);
    };
    let people = study.people(participants)?;
    let (ids, whom) = match part {
        Part::Learn => (people.learned_from(), "learned from"),
        Part::Test => (people.tested(), "tested"),
    };
    let baseline = study.design.baseline_id();
    let fits = |meta: &DriveMeta| {
        let in_part = part == Part::Learn || Some(meta.condition) == baseline;
        in_part && ids.contains(&meta.participant)
    };
    let mut drives = Vec::new();
    for drive in drives_in(folder)? {
        drives.extend(Some(drive?).filter(|drive| fits(drive.meta())));
    }
    if drives.is_empty() {
        let problem = format!("holds no drive by hand of the {} people who are {whom}", ids.len());
        let help = format!(
            "who is {whom} is said by [people] of {}, whose drives these are by [names] of the mapping; [baseline] names the drive by hand",
            study.name()
        );
        return Err(StudyError::file(folder, problem).with_help(help));
    }
    Ok(drives)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_design_is_built_in() {
        let paper = DesignFile::paper().unwrap();
        assert_eq!(paper.design.conditions().len(), 4);
    }

    #[test]
    fn questionnaires_and_effects_are_those_given_else_the_designs_else_as_shipped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        let design = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[condition]]\nid = \"sporty\"\n[files]\nscales = \"asked\"\n";
        std::fs::write(&path, design).unwrap();
        let (own, paper) = (DesignFile::read(&path).unwrap(), DesignFile::paper().unwrap());
        let given = Path::new("given");
        for study in [&own, &paper] {
            assert_eq!(study.scales_folder(Some(given)), given);
            assert_eq!(study.effects_file(Some(given)), given);
            let shipped = Path::new("study_data/effects.toml");
            assert_eq!(study.effects_file(None), shipped);
        }
        assert_eq!(own.scales_folder(None), folder.path().join("asked"));
        assert_eq!(paper.scales_folder(None), Path::new("study_data/scales"));
    }

    #[test]
    fn a_fault_names_the_file_the_key_and_the_nearest_word() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        std::fs::write(&path, "[study]\ntitel = \"x\"\n").unwrap();
        let error = DesignFile::read(&path).unwrap_err();
        let said = error.to_string();
        assert!(said.contains("study.toml: line 2: unknown field `titel`"), "{said}");
        assert_eq!(error.suggestion().unwrap(), "did you mean `title`?");
    }
}
