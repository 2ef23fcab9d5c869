//! What the seat collected, under pseudonyms: events and consents, notes where they are asked for.

use super::pseudonym::Pseudonyms;
use crate::{
    error::StudyError,
    named,
    tables::{
        TableName,
        collected::{
            CONSENTS, ConsentRow, EVENTS, EventRow, LENT, LentRow, NOT_ADMITTED, NOTES,
            NotAdmitted, NoteRow, read_lent, write_lent,
        },
        read_rows, write_rows,
    },
};
use maveric_domain::{DriveId, ParticipantId};
use std::{collections::BTreeSet, path::Path};

/// The three tables of a seat's folder.
#[derive(Default)]
pub(super) struct Collected {
    events: Vec<EventRow>,
    consents: Vec<ConsentRow>,
    notes: Option<Vec<NoteRow>>,
    not_admitted: Vec<NotAdmitted>,
    lent: Vec<LentRow>,
}

impl Collected {
    /// Reads the tables of a folder; notes only where they are asked for.
    ///
    /// # Errors
    /// [`StudyError::BadFile`] for a folder that has none of them; as [`read_rows`].
    pub(super) fn read(folder: &Path, notes: bool) -> Result<Self, StudyError> {
        if !folder.join(EVENTS).is_file() {
            return Err(StudyError::BadFile {
                path: folder.to_owned(),
                problem: format!("holds no {EVENTS}"),
                help: Some(
                    "name the folder in which the seat keeps what it collects: seat/ in the study’s folder"
                        .to_owned(),
                ),
            });
        }
        let held_back = folder.with_file_name(NOT_ADMITTED);
        let lent = folder.with_file_name(LENT);
        Ok(Self {
            events: read_rows(&folder.join(EVENTS))?,
            consents: read_rows(&folder.join(CONSENTS))?,
            notes: notes.then(|| read_rows(&folder.join(NOTES))).transpose()?,
            not_admitted: if held_back.is_file() {
                read_rows(&held_back)?
            } else {
                Vec::new()
            },
            lent: if lent.is_file() {
                read_lent(&lent)?
            } else {
                Vec::new()
            },
        })
    }

    /// Takes out whoever does not stay; their ids.
    pub(super) fn without(
        &mut self,
        stays: impl Fn(&ParticipantId) -> bool,
    ) -> BTreeSet<ParticipantId> {
        let mut gone = BTreeSet::new();
        let mut keeps = |id: &ParticipantId| {
            let keeps = stays(id);
            if !keeps {
                gone.insert(id.clone());
            }
            keeps
        };
        self.events.retain(|row| keeps(&row.participant));
        self.consents.retain(|row| keeps(&row.participant));
        self.lent.retain(|row| keeps(&row.participant));
        if let Some(notes) = &mut self.notes {
            notes.retain(|row| row.participant.as_ref().is_none_or(&mut keeps));
        }
        gone
    }

    /// Everybody who is in them.
    pub(super) fn people(&self) -> impl Iterator<Item = &ParticipantId> {
        let events = self.events.iter().map(|row| &row.participant);
        let consents = self.consents.iter().map(|row| &row.participant);
        let notes = self.notes.iter().flatten();
        let notes = notes.filter_map(|row| row.participant.as_ref());
        events.chain(consents).chain(notes)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.people().next().is_none()
    }

    /// Writes them into `out`, without times of day; warns of notes, whose words are somebody's own. A note that names anybody who is
    /// `left_out` is not given away.
    ///
    /// # Errors
    /// As [`write_rows`].
    pub(super) fn write(
        mut self,
        out: &Path,
        names: &Pseudonyms,
        left_out: &BTreeSet<String>,
    ) -> Result<Option<String>, StudyError> {
        if self.is_empty() {
            return Ok(None);
        }
        for row in &mut self.events {
            row.participant = names.of(&row.participant);
            row.at = None;
        }
        for row in &mut self.consents {
            row.participant = names.of(&row.participant);
            row.at = None;
        }
        // Sorted by pseudonym, so that the order of the rows gives nobody away; each person's stay in their order.
        self.events
            .sort_by(|a, b| a.participant.cmp(&b.participant));
        self.consents
            .sort_by(|a, b| a.participant.cmp(&b.participant));
        if !self.not_admitted.is_empty() {
            write_rows(
                TableName::NotAdmitted,
                &out.join(NOT_ADMITTED),
                &self.not_admitted,
            )?;
        }
        for row in &mut self.lent {
            row.participant = names.of(&row.participant);
            row.lent.donor = donor_given_away(&row.lent.donor, names)?;
        }
        if !self.lent.is_empty() {
            self.lent.sort_by(|a, b| a.participant.cmp(&b.participant));
            write_lent(&out.join(LENT), &self.lent)?;
        }
        let out = out.join("seat");
        write_rows(TableName::Events, &out.join(EVENTS), &self.events)?;
        write_rows(TableName::Consents, &out.join(CONSENTS), &self.consents)?;
        let Some(mut notes) = self.notes else {
            return Ok(None);
        };
        let all = notes.len();
        notes.retain(|row| !left_out.iter().any(|id| named::names(&row.text, id)));
        let withheld = all - notes.len();
        for row in &mut notes {
            row.text = names.rename(&row.text);
            row.participant = row.participant.as_ref().map(|id| names.of(id));
            row.at = None;
        }
        // Those of the day's course by their words: when each was written is not given away.
        notes.sort_by(|a, b| match (&a.participant, &b.participant) {
            (None, None) => a.text.cmp(&b.text),
            (a, b) => a.cmp(b),
        });
        write_rows(TableName::Notes, &out.join(NOTES), &notes)?;
        let by_hand = notes.iter().filter(|row| row.participant.is_none()).count();
        let warning = format!(
            "{by_hand} notes are given away as they were written: read seat/notes.csv, they may name somebody; {withheld} that name \
             somebody who is left out are not"
        );
        Ok((by_hand + withheld > 0).then_some(warning))
    }
}

/// The donor of a style by their pseudonym; of whoever is not in the export nothing is said.
fn donor_given_away(donor: &DriveId, names: &Pseudonyms) -> Result<DriveId, StudyError> {
    let renamed = names.rename(donor.as_str());
    let name = if renamed == donor.as_str() {
        "withheld"
    } else {
        &renamed
    };
    Ok(DriveId::new(name)?)
}
