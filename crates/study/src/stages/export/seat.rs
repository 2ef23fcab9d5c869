//! What the seat collected, under pseudonyms: events and consents, notes where they are asked for.

use super::pseudonym::Pseudonyms;
use crate::{
    atomic_write::if_there,
    error::StudyError,
    named,
    tables::{
        TableName,
        collected::{
            CONSENTS, ConsentRow, EVENTS, EventRow, LENT, LentRow, NOT_ADMITTED, NOT_AGREED, NOTES,
            NotAdmitted, NotAgreed, NoteRow, SEAT, STOPPED, Stopped, read_consents, read_lent,
            write_lent,
        },
        read_rows, write_rows,
    },
};
use maveric_domain::{DriveId, ParticipantId};
use std::{collections::BTreeSet, path::Path};

/// The tables of a seat's folder.
#[derive(Default)]
pub(super) struct Collected {
    events: Vec<EventRow>,
    consents: Vec<ConsentRow>,
    notes: Option<Vec<NoteRow>>,
    not_admitted: Vec<NotAdmitted>,
    not_agreed: Vec<NotAgreed>,
    stopped: Vec<Stopped>,
    lent: Vec<LentRow>,
}

impl Collected {
    /// Reads the tables of a folder; notes only where they are asked for.
    ///
    /// # Errors
    /// [`StudyError::BadFile`] for a folder that has none of them; as [`read_rows`].
    pub(super) fn read(folder: &Path, notes: bool) -> Result<Self, StudyError> {
        if !folder.join(EVENTS).is_file() {
            let help = "name the folder in which the seat keeps what it collects: seat/ in the study’s folder";
            return Err(StudyError::file(folder, format!("holds no {EVENTS}")).with_help(help));
        }
        Ok(Self {
            events: read_rows(&folder.join(EVENTS))?,
            consents: read_consents(&folder.join(CONSENTS))?,
            notes: notes.then(|| read_rows(&folder.join(NOTES))).transpose()?,
            not_admitted: if_there(&folder.with_file_name(NOT_ADMITTED), read_rows)?,
            not_agreed: if_there(&folder.with_file_name(NOT_AGREED), read_rows)?,
            stopped: if_there(&folder.with_file_name(STOPPED), read_rows)?,
            lent: if_there(&folder.with_file_name(LENT), read_lent)?,
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
        self.stopped.retain(|row| keeps(&row.participant));
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
    pub(super) fn write(
        mut self,
        out: &Path,
        names: &Pseudonyms,
        left_out: &BTreeSet<String>,
    ) -> Result<Option<String>, StudyError> {
        if self.is_empty() {
            return Ok(None);
        }
        let with_notes = self.notes.is_some();
        let cleared = |text: &str| match text.split_once(": ") {
            // Words of the experimenter's are notes.
            Some((act, _)) if !with_notes || named_in(text, left_out) => act.to_owned(),
            _ => names.rename(text),
        };
        for row in &mut self.events {
            row.participant = names.pseudonym(&row.participant);
            // What a page says has no time of day, but for answers.
            if row.at.take().is_some() {
                row.what = cleared(&row.what);
            }
        }
        for row in &mut self.stopped {
            row.participant = names.pseudonym(&row.participant);
            row.reason = cleared(&row.reason);
        }
        if !self.stopped.is_empty() {
            let ride = |row: &Stopped| (row.condition, row.session, row.trial);
            self.stopped.sort_by(|a, b| (&a.participant, ride(a)).cmp(&(&b.participant, ride(b))));
            write_rows(TableName::Stopped, &out.join(STOPPED), &self.stopped)?;
        }
        for row in &mut self.consents {
            row.participant = names.pseudonym(&row.participant);
            row.at = None;
        }
        // Sorted by pseudonym, so that the order of the rows gives nobody away; each person's stay in their order.
        self.events.sort_by(|a, b| a.participant.cmp(&b.participant));
        self.consents.sort_by(|a, b| a.participant.cmp(&b.participant));
        if !self.not_admitted.is_empty() {
            write_rows(TableName::NotAdmitted, &out.join(NOT_ADMITTED), &self.not_admitted)?;
        }
        if !self.not_agreed.is_empty() {
            write_rows(TableName::NotAgreed, &out.join(NOT_AGREED), &self.not_agreed)?;
        }
        for row in &mut self.lent {
            row.participant = names.pseudonym(&row.participant);
            row.lent.donor = donor_given_away(&row.lent.donor, names)?;
        }
        if !self.lent.is_empty() {
            self.lent.sort_by(|a, b| a.participant.cmp(&b.participant));
            write_lent(&out.join(LENT), &self.lent)?;
        }
        let out = out.join(SEAT);
        write_rows(TableName::Events, &out.join(EVENTS), &self.events)?;
        write_rows(TableName::Consents, &out.join(CONSENTS), &self.consents)?;
        let Some(mut notes) = self.notes else {
            return Ok(None);
        };
        let total = notes.len();
        notes.retain(|row| !named_in(&row.text, left_out));
        let withheld = total - notes.len();
        for row in &mut notes {
            row.text = names.rename(&row.text);
            row.participant = row.participant.as_ref().map(|id| names.pseudonym(id));
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

/// Whether a text names anybody of these.
fn named_in(text: &str, people: &BTreeSet<String>) -> bool {
    people.iter().any(|id| named::names(text, id))
}

/// The donor of a style by their pseudonym; of whoever is not in the export nothing is said.
fn donor_given_away(donor: &DriveId, names: &Pseudonyms) -> Result<DriveId, StudyError> {
    let renamed = names.rename(donor.as_str());
    let name = if renamed == donor.as_str() { "withheld" } else { &renamed };
    Ok(DriveId::new(name)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn collected(notes: Option<Vec<NoteRow>>) -> Collected {
        let event = |what: &str, at: Option<&str>| EventRow {
            participant: ParticipantId::new("P1").unwrap(),
            step: 3,
            page: "calm".to_owned(),
            moment: None,
            attempt: Some(1),
            time_s: Some(4.0),
            what: what.to_owned(),
            value: None,
            at: at.map(str::to_owned),
        };
        let stop = |reason: &str| Stopped {
            participant: ParticipantId::new("P1").unwrap(),
            condition: "calm".parse().unwrap(),
            session: maveric_domain::occasion::first(),
            trial: maveric_domain::occasion::first(),
            time_s: 4.0,
            reason: reason.to_owned(),
        };
        Collected {
            events: vec![
                event("stopped: misc >= 6", None),
                event("skipped: P1 was ill", Some("2026-11-26T10:00:00Z")),
                event("aborted: as P9 said", Some("2026-11-26T10:00:00Z")),
            ],
            stopped: vec![stop("misc >= 6"), stop("skipped: P1 was ill")],
            notes,
            ..Collected::default()
        }
    }

    /// What is given away of the events and of what was stopped, where P9 is left out.
    fn given(notes: Option<Vec<NoteRow>>) -> (String, String) {
        let folder = tempfile::tempdir().unwrap();
        let key = folder.path().join("study.key");
        std::fs::write(&key, "0123456789abcdef0123456789abcdef").unwrap();
        let out = folder.path().join("shared");
        let mut names = Pseudonyms::read(&key, &out).unwrap();
        names.add_all([&ParticipantId::new("P1").unwrap()].into_iter()).unwrap();
        let left_out = BTreeSet::from(["P9".to_owned()]);
        collected(notes).write(&out, &names, &left_out).unwrap();
        let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
        (read("seat/events.csv"), read(STOPPED))
    }

    #[test]
    fn what_the_experimenter_said_of_a_step_is_given_away_with_the_notes_alone() {
        let (events, stopped) = given(None);
        for table in [&events, &stopped] {
            assert!(table.contains("misc >= 6") && table.contains("skipped"), "{table}");
            assert!(!table.contains("ill") && !table.contains("P1"), "{table}");
        }
        let (events, stopped) = given(Some(Vec::new()));
        for table in [&events, &stopped] {
            assert!(table.contains("was ill") && !table.contains("P1"), "{table}");
        }
        assert!(events.contains("aborted") && !events.contains("P9"), "{events}");
    }
}
