//! Names that only the key's keeper can make again.

use crate::{error::StudyError, named};
use maveric_domain::ParticipantId;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// A key shorter than this can be guessed.
const SHORTEST_KEY: usize = 16;

/// Letters of a pseudonym after its `P`: 40 bits, so that a thousand people meet once in two million studies.
const LETTERS: usize = 10;

/// Pseudonyms of the people of one study.
#[derive(Default)]
pub(super) struct Pseudonyms {
    key: [u8; 32],
    names: BTreeMap<ParticipantId, ParticipantId>,
}

impl Pseudonyms {
    /// Takes the key from a file, which must not lie where the export goes.
    pub(super) fn read(key: &Path, out: &Path) -> Result<Self, StudyError> {
        let help =
            "make one with `openssl rand -hex 32 > study.key`, and keep it where the data are not";
        let bad = |problem: String| StudyError::file(key, problem).with_help(help);
        let absolute = |path: &Path| std::path::absolute(path).map_err(StudyError::read(path));
        if absolute(key)?.starts_with(absolute(out)?) {
            return Err(bad("the key lies in the folder that is given away".to_owned()));
        }
        let bytes = std::fs::read(key).map_err(StudyError::read(key))?;
        let secret = bytes.trim_ascii();
        if secret.len() < SHORTEST_KEY {
            let length = secret.len();
            return Err(bad(format!(
                "a key of {length} characters, expected at least {SHORTEST_KEY}"
            )));
        }
        Ok(Self {
            key: blake3::derive_key("maveric study export pseudonyms v1", secret),
            names: BTreeMap::new(),
        })
    }

    /// Makes a pseudonym for each of them.
    ///
    /// # Errors
    /// [`StudyError::NotPossible`] where two would have the same.
    pub(super) fn add_all<'a>(
        &mut self,
        ids: impl Iterator<Item = &'a ParticipantId>,
    ) -> Result<(), StudyError> {
        for id in ids {
            self.add(id)?;
        }
        Ok(())
    }

    /// Makes a pseudonym for somebody; the same one whenever asked.
    fn add(&mut self, id: &ParticipantId) -> Result<(), StudyError> {
        if self.names.contains_key(id) {
            return Ok(());
        }
        let hash = blake3::keyed_hash(&self.key, id.as_str().as_bytes()).to_hex();
        let name = ParticipantId::new(format!("P{}", &hash[..LETTERS]))?;
        if self.names.values().any(|n| *n == name) {
            let problem = format!("two participants would both be called {name}");
            return Err(StudyError::not_possible(problem).with_help("use another key"));
        }
        self.names.insert(id.clone(), name);
        Ok(())
    }

    /// The pseudonym of somebody who was added.
    pub(super) fn pseudonym(&self, id: &ParticipantId) -> ParticipantId {
        #[expect(
            clippy::expect_used,
            reason = "a name that slips through must stop the export, not leave under its own name"
        )]
        self.names.get(id).expect("everybody was added").clone()
    }

    /// Whether this is the pseudonym of somebody who was added.
    pub(super) fn has(&self, name: &str) -> bool {
        self.names.values().any(|n| n.as_str() == name)
    }

    /// A text with pseudonyms for the ids of those who were added; `…` for an id of digits alone, which may be a number like any other.
    pub(super) fn rename(&self, text: &str) -> String {
        let mut text = text.to_owned();
        for (id, name) in &self.names {
            let id = id.as_str();
            let name = if named::is_number(id) { named::HIDDEN } else { name.as_str() };
            text = named::with(&text, id, name);
        }
        text
    }

    pub(super) fn len(&self) -> usize {
        self.names.len()
    }
}

/// Ids that must stand in no text of an export: those of the people who are in it under other names, and of people and drives that are not.
pub(super) struct Ids(Vec<String>);

impl Ids {
    pub(super) fn new(names: &Pseudonyms, left_out: &BTreeSet<String>) -> Self {
        let originals = names.names.keys().map(ToString::to_string);
        Self(originals.chain(left_out.iter().cloned()).collect())
    }

    /// Whether a path or a command names somebody.
    pub(super) fn named_in(&self, text: &str) -> bool {
        self.0.iter().any(|id| named::names(text, id))
    }

    /// The id that words name, be it no mere number.
    pub(super) fn in_words(&self, text: &str) -> Option<&str> {
        let mut ids = self.0.iter().map(String::as_str);
        ids.find(|id| named::is_about(text, id))
    }

    /// Words with `…` for each id; none where there is no id.
    pub(super) fn hidden(&self, text: &str) -> Option<String> {
        self.in_words(text)?;
        let ids = self.0.iter().map(String::as_str);
        Some(named::without(text, ids.filter(|id| !named::is_number(id))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_makes_the_name_and_another_key_another() {
        let folder = tempfile::tempdir().unwrap();
        let with = |name: &str, key: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, key).unwrap();
            Pseudonyms::read(&path, &folder.path().join("out"))
        };
        let id = ParticipantId::new("Anna").unwrap();
        let name = |mut names: Pseudonyms| {
            names.add(&id).unwrap();
            names.add(&id).unwrap();
            assert_eq!(names.len(), 1);
            names.pseudonym(&id).to_string()
        };
        let one = name(with("a", "0123456789abcdef\n").unwrap());
        assert_eq!(one, name(with("b", "0123456789abcdef").unwrap()));
        assert_ne!(one, name(with("c", "0123456789abcdeg").unwrap()));
        assert!(one.starts_with('P') && one.len() == 11 && !one.contains("Anna"));
        let error = with("d", "short").err().unwrap().to_string();
        assert!(error.contains("5 characters"), "{error}");
        let inside = Pseudonyms::read(&folder.path().join("a"), folder.path()).err().unwrap();
        assert!(inside.to_string().contains("given away"));
    }
}
