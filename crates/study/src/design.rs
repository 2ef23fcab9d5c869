//! The design of a study as a file: where it is, and what its paths mean.

use crate::{
    atomic_write::read_text,
    error::StudyError,
    tables::participants::{Enrolled, read_enrolled},
};
use maveric_domain::{ConditionId, Design, DriveMeta, ParticipantId};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Name of a design in a study's folder.
pub const DESIGN_FILE: &str = "study.toml";

/// The paper's design, as it is shipped.
const PAPER: &str = include_str!("../../../study_data/designs/paper.toml");

/// A design, and where it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignFile {
    /// The file; none for the paper's that is built in.
    pub path: Option<PathBuf>,
    /// What it says.
    pub design: Design,
}

impl DesignFile {
    /// Reads a design.
    ///
    /// # Errors
    /// [`StudyError`] naming the file and the key.
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let text = read_text(path)?;
        let design = Design::from_toml(&text).map_err(|e| StudyError::BadFile {
            path: path.to_owned(),
            problem: e.to_string(),
            help: e.suggestion(),
        })?;
        Ok(Self {
            path: Some(path.to_owned()),
            design,
        })
    }

    /// The design that was asked for; else `study.toml` of the folder one stands in; else the paper's.
    ///
    /// # Errors
    /// As [`DesignFile::read`].
    pub fn find(given: Option<&Path>) -> Result<Self, StudyError> {
        match given {
            Some(path) => Self::read(path),
            None if Path::new(DESIGN_FILE).is_file() => Self::read(Path::new(DESIGN_FILE)),
            None => Self::paper(),
        }
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
        folder.map_or_else(|| path.to_owned(), |folder| folder.join(path))
    }

    /// Who takes part: `given`, or the design's own table.
    ///
    /// # Errors
    /// As [`read_enrolled`].
    pub fn people(&self, given: Option<&Path>) -> Result<People, StudyError> {
        let own = self.resolve(&self.design.people().file);
        let path = given.unwrap_or(&own);
        Ok(People {
            enrolled: read_enrolled(path, &self.design)?,
        })
    }

    /// Who takes part, of a run: `given`, or `participants.csv` among its results, or the design's own table.
    ///
    /// # Errors
    /// As [`read_enrolled`].
    pub fn people_of(&self, results: &Path, given: Option<&Path>) -> Result<People, StudyError> {
        let beside = results.join("participants.csv");
        self.people(given.or_else(|| beside.is_file().then_some(beside.as_path())))
    }

    /// The name of the file, for messages.
    pub fn name(&self) -> String {
        let path = self.path.as_ref();
        path.map_or_else(
            || "the paper's design".to_owned(),
            |p| p.display().to_string(),
        )
    }

    /// An error about a key of this design.
    pub fn wrong(&self, problem: impl Into<String>, help: Option<String>) -> StudyError {
        let problem = problem.into();
        match &self.path {
            Some(path) => StudyError::BadFile {
                path: path.clone(),
                problem,
                help,
            },
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

    /// Those whose drives the networks learn from.
    pub fn learned_from(&self) -> BTreeSet<ParticipantId> {
        let learned = self.enrolled.iter().filter(|p| p.learned_from);
        learned.map(|p| p.id.clone()).collect()
    }

    /// Those who sat through the conditions.
    pub fn tested(&self) -> BTreeSet<ParticipantId> {
        let tested = self.enrolled.iter().filter(|p| p.tested);
        tested.map(|p| p.id.clone()).collect()
    }
}

/// Why a drive belongs to no study of this design; none where it does.
pub fn stranger(meta: &DriveMeta, design: &Design, people: Option<&People>) -> Option<String> {
    if !design.knows(meta.condition) {
        return Some(format!(
            "condition `{}` is not in the design, which has {}",
            meta.condition,
            listed(&design.labels())
        ));
    }
    let people = people?;
    people.find(&meta.participant).is_none().then(|| {
        format!(
            "participant {} is not in the table of people",
            meta.participant
        )
    })
}

/// Ids in a row: `a, b, c`.
pub fn listed(ids: &[ConditionId]) -> String {
    let ids: Vec<&str> = ids.iter().map(ConditionId::as_str).collect();
    ids.join(", ")
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
    fn a_fault_names_the_file_the_key_and_the_nearest_word() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        std::fs::write(&path, "[study]\ntitel = \"x\"\n").unwrap();
        let error = DesignFile::read(&path).unwrap_err();
        let said = error.to_string();
        assert!(
            said.contains("study.toml: line 2: unknown field `titel`"),
            "{said}"
        );
        assert_eq!(error.suggestion().unwrap(), "did you mean `title`?");
    }
}
