//! The people who were forgotten: ids that are not given again, and the models that had learned from them.

use crate::{
    atomic_write::if_there,
    error::StudyError,
    tables::{TableName, read_rows, write_rows},
};
use maveric_domain::ParticipantId;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::Path};

/// Name of the list in a study's folder.
pub const FORGOTTEN_FILE: &str = "forgotten.csv";

/// Between the hashes of a row.
const BETWEEN: char = ' ';

/// Whoever was forgotten, by id.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ForgottenList {
    /// BLAKE3 of each model that had learned from the person.
    models: BTreeMap<ParticipantId, Vec<String>>,
}

#[derive(Serialize, Deserialize)]
struct Row {
    participant: ParticipantId,
    models: Option<String>,
}

impl ForgottenList {
    /// The list of a study's folder; empty where nobody was forgotten.
    pub fn read(folder: &Path) -> Result<Self, StudyError> {
        let rows: Vec<Row> = if_there(&folder.join(FORGOTTEN_FILE), read_rows)?;
        let hashes = |row: &Row| {
            let hashes = row.models.as_deref().unwrap_or_default().split(BETWEEN);
            let hashes = hashes.filter(|hash| !hash.is_empty());
            hashes.map(str::to_owned).collect()
        };
        let models = rows.into_iter().map(|row| (hashes(&row), row.participant));
        Ok(Self { models: models.map(|(hashes, who)| (who, hashes)).collect() })
    }

    /// Whether somebody was forgotten: their id is nobody else's.
    pub fn has(&self, id: &ParticipantId) -> bool {
        self.models.contains_key(id)
    }

    pub fn ids(&self) -> impl Iterator<Item = &ParticipantId> {
        self.models.keys()
    }

    /// Adds somebody, with the hashes of the models that had learned from them.
    pub(crate) fn add(&mut self, id: &ParticipantId, hashes: impl IntoIterator<Item = String>) {
        let known = self.models.entry(id.clone()).or_default();
        known.extend(hashes);
        known.sort();
        known.dedup();
    }

    /// Who was forgotten, of those from whom this model learned.
    pub(crate) fn learned(&self, hash: &str) -> Option<&ParticipantId> {
        let mut models = self.models.iter();
        let learned = models.find(|(_, hashes)| hashes.iter().any(|h| h == hash));
        learned.map(|(who, _)| who)
    }

    /// Refuses a table of people with an id of somebody who was forgotten.
    ///
    /// # Errors
    /// [`StudyError::BadFile`] naming the table and the person.
    pub(crate) fn refuse<'a>(
        &self,
        table: &Path,
        mut ids: impl Iterator<Item = &'a ParticipantId>,
    ) -> Result<(), StudyError> {
        let Some(id) = ids.find(|id| self.has(id)) else {
            return Ok(());
        };
        let problem =
            format!("{id} was forgotten, and {FORGOTTEN_FILE} says that the id is not given again");
        let help = "take the row out; somebody new needs another id";
        Err(StudyError::file(table, problem).with_help(help))
    }

    /// Writes the list of a study's folder.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), StudyError> {
        let rows = self.models.iter().map(|(who, hashes)| Row {
            participant: who.clone(),
            models: Some(hashes.join(&BETWEEN.to_string())).filter(|text| !text.is_empty()),
        });
        write_rows(TableName::Forgotten, &folder.join(FORGOTTEN_FILE), rows)
    }
}
