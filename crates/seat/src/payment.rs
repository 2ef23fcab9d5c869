//! Whom a platform pays: their id on it is in one file of its owner alone, and known elsewhere by a keyed digest.

use crate::{
    books::Books,
    error::SeatError,
    files::Files,
    let_in::Invitation,
    person::{NEVER_CAME, NOT_ADMITTED, Person},
    seat::Seat,
    store::Store,
    token,
};
use maveric_domain::{ParticipantId, design::Redirect};
use maveric_study::{DesignFile, tables::collected::PaymentRow};
use serde::Serialize;
use std::path::Path;

/// How somebody's part ended who stopped in a drive, or was stopped.
const STOPPED: &str = "stopped";

/// The name under which the key of ids on a platform is kept.
const KEY: &str = "platform";

/// Whether a text could be an id on a platform.
fn possible(id: &str) -> bool {
    let known = |b: u8| b.is_ascii_alphanumeric() || b"_-.".contains(&b);
    (1..=128).contains(&id.len()) && id.bytes().all(known)
}

impl Books<'_> {
    /// The digest of an id by the study's key, which is made up once.
    fn platform_digest(&self, id: &str) -> Result<String, SeatError> {
        let question = "SELECT value FROM secret WHERE name = ?1";
        let kept: Option<String> = self.row(question, [KEY], |row| row.get(0))?;
        let key = if let Some(key) = kept {
            key
        } else {
            let key = token::new()? + &token::new()?;
            self.change("INSERT INTO secret VALUES (?1, ?2)", [KEY, key.as_str()])?;
            key
        };
        let key = blake3::derive_key("maveric seat ids of a platform v1", key.as_bytes());
        let digest = blake3::keyed_hash(&key, id.as_bytes());
        Ok(digest.to_hex().to_string())
    }

    /// The link of who came with this digest before.
    fn joined(&self, digest: &str) -> Result<Option<String>, SeatError> {
        let question = "SELECT token FROM platform WHERE id = ?1";
        self.row(question, [digest], |row| row.get(0))
    }

    /// How somebody's part ended, as it is paid: none while it goes on.
    fn paid_as(&self, person: &Person) -> Result<Option<String>, SeatError> {
        let early = person.ended.as_deref() == Some("done") && self.stopped_early(person)?;
        Ok(if early { Some(STOPPED.to_owned()) } else { person.ended.clone() })
    }

    /// Whether somebody stopped in a drive, or the experimenter ended their driving.
    fn stopped_early(&self, person: &Person) -> Result<bool, SeatError> {
        let who = &person.participant;
        let mut early = self.is_aborted(who)?;
        let driven = person.steps.iter().enumerate();
        for (step, found) in driven.filter(|(_, found)| found.world().is_some()) {
            early = early || self.stopped(who, (step, found))?.is_some();
        }
        Ok(early)
    }

    /// Where somebody's page leads back to, once their part has ended.
    pub(crate) fn leads_to<'a>(
        &self,
        redirect: Option<&'a Redirect>,
        person: &Person,
    ) -> Result<Option<&'a str>, SeatError> {
        let Some(redirect) = redirect else {
            return Ok(None);
        };
        let how = self.paid_as(person)?;
        Ok(match how.as_deref() {
            None | Some(NEVER_CAME) => None,
            Some("done") => redirect.done.as_deref(),
            Some(NOT_ADMITTED) => redirect.screened_out.as_deref(),
            // Whoever stops or leaves is paid.
            Some(_) => redirect.stopped.as_deref(),
        })
    }
}

impl Seat {
    /// The link of whoever comes from the platform with this id: the one that they had, or a new one. None for a study without a
    /// platform, or what can be no id.
    pub(crate) fn join(&self, id: &str) -> Result<Option<String>, SeatError> {
        if self.settings.design.protocol().platform.is_none() || !possible(id) {
            return Ok(None);
        }
        // One after the other: nobody is let in twice.
        self.without_writing(|files| {
            let digest = self.store.within(|b| b.platform_digest(id))?;
            let before = self.store.look(|b| b.joined(&digest))?;
            let token = if let Some(token) = before {
                token
            } else {
                let token = self.invite(&Invitation::default())?;
                let statement = "INSERT INTO platform VALUES (?1, ?2)";
                self.store.within(|b| b.change(statement, [&digest, &token]))?;
                token
            };
            // Of who is forgotten since, nothing is written down again.
            if let Some(participant) = self.whose(&token) {
                files.comes(&participant, id)?;
            }
            Ok(Some(token))
        })
    }
}

impl Files {
    /// Writes down whom a platform pays, once.
    fn comes(&self, participant: &str, id: &str) -> Result<(), SeatError> {
        let participant = ParticipantId::new(participant)?;
        let mut rows = self.payment()?;
        if rows.iter().any(|row| row.participant == participant) {
            return Ok(());
        }
        rows.push(PaymentRow { participant, platform_id: id.to_owned(), ended: None });
        self.write_payment(&rows)
    }

    /// Writes how the parts of those ended whom a platform pays.
    pub(crate) fn ended(&self, b: &Books<'_>) -> Result<(), SeatError> {
        let mut rows = self.payment()?;
        let mut changed = false;
        for row in rows.iter_mut().filter(|row| row.ended.is_none()) {
            row.ended = match b.called(row.participant.as_str()) {
                Ok(person) => b.paid_as(&person)?,
                // Of a seat of before, whose file is no longer there.
                Err(SeatError::Nobody { .. }) => None,
                Err(error) => return Err(error),
            };
            changed |= row.ended.is_some();
        }
        if changed {
            self.write_payment(&rows)?;
        }
        Ok(())
    }
}

/// What became of the rows of those whom a platform pays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Paid {
    /// Rows that were deleted: of people whose part had ended.
    pub deleted: usize,
    /// Rows of people whose part goes on.
    pub left: usize,
}

/// Deletes the ids on the platform of everybody whose part has ended, in the folder of a study whose seat is closed.
///
/// # Errors
/// [`SeatError::InUse`] while the seat is open; [`SeatError::Store`]; [`SeatError::Study`] if the file cannot be read or changed.
pub fn paid(study: &DesignFile, state: &Path) -> Result<Paid, SeatError> {
    let files = Files::of(study, state.parent().unwrap_or(state).to_owned());
    let _alone = state.is_file().then(|| Store::open(state)).transpose()?;
    let rows = files.payment()?;
    let (ended, on): (Vec<_>, Vec<_>) = rows.into_iter().partition(|row| row.ended.is_some());
    if !ended.is_empty() {
        files.write_payment(&on)?;
    }
    Ok(Paid { deleted: ended.len(), left: on.len() })
}
