//! Questions to the seat's file, within one transaction: people and what they answered.

use crate::{
    error::SeatError,
    listed::{KeptSheet, Listed},
    person::Person,
    steps::Step,
    token,
};
use maveric_domain::nearest;
use maveric_study::forget::is_about;
use rusqlite::{Connection, OptionalExtension as _, Params, Row, params};
use std::{collections::BTreeSet, path::Path};

/// What is asked within one transaction.
pub(crate) struct Books<'a> {
    pub(crate) connection: &'a Connection,
    pub(crate) path: &'a Path,
}

/// A number of a step as SQLite has it: there are never so many.
pub(crate) fn whole(step: usize) -> i64 {
    i64::try_from(step).unwrap_or(i64::MAX)
}

pub(crate) fn now() -> i64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.map_or(0, |d| d.as_secs().cast_signed())
}

const PERSON: &str = "SELECT token, participant, steps, at, ended, fit, listed, row FROM person";

impl Books<'_> {
    pub(crate) fn ask<T>(
        &self,
        question: impl FnOnce(&Connection) -> rusqlite::Result<T>,
    ) -> Result<T, SeatError> {
        question(self.connection).map_err(|source| SeatError::store(self.path, source))
    }

    pub(crate) fn change(&self, statement: &str, values: impl Params) -> Result<(), SeatError> {
        self.ask(|c| c.execute(statement, values)).map(drop)
    }

    /// The rows that answer a question.
    pub(crate) fn rows<T, C: FromIterator<T>>(
        &self,
        question: &str,
        values: impl Params,
        read: impl FnMut(&Row<'_>) -> rusqlite::Result<T>,
    ) -> Result<C, SeatError> {
        self.ask(|c| {
            let mut rows = c.prepare_cached(question)?;
            rows.query_map(values, read)?.collect()
        })
    }

    /// The first row that answers a question, if there is one.
    pub(crate) fn row<T>(
        &self,
        question: &str,
        values: impl Params,
        read: impl FnOnce(&Row<'_>) -> rusqlite::Result<T>,
    ) -> Result<Option<T>, SeatError> {
        self.ask(|c| {
            let mut row = c.prepare_cached(question)?;
            row.query_row(values, read).optional()
        })
    }

    pub(crate) fn add(&self, person: &Person) -> Result<(), SeatError> {
        // Steps are made of what was checked.
        let steps = serde_json::to_string(&person.steps).unwrap_or_default();
        self.change(
            "INSERT INTO person (token, participant, steps, at, ended, fit, row, since) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
            params![person.token, person.participant, steps, whole(person.at), person.ended, person.fit, person.row.map(whole), now()],
        )
    }

    /// The person of a token.
    pub(crate) fn person(&self, token: &str) -> Result<Option<Person>, SeatError> {
        self.row(&format!("{PERSON} WHERE token = ?1"), [token], Person::read)
    }

    /// The person of an id.
    pub(crate) fn called(&self, participant: &str) -> Result<Person, SeatError> {
        let question = format!("{PERSON} WHERE participant = ?1");
        let person = self.row(&question, [participant], Person::read)?;
        let ids = self.ids()?;
        person.ok_or_else(|| SeatError::Nobody {
            participant: participant.to_owned(),
            nearest: nearest(participant, ids.iter().map(String::as_str)).map(str::to_owned),
        })
    }

    /// The ids of everybody, in the order in which they were let in.
    pub(crate) fn ids(&self) -> Result<Vec<String>, SeatError> {
        let question = "SELECT participant FROM person ORDER BY rowid";
        self.rows(question, [], |row| row.get(0))
    }

    /// Everybody, in the order in which they were let in.
    pub(crate) fn everybody(&self) -> Result<Vec<Person>, SeatError> {
        self.rows(&format!("{PERSON} ORDER BY rowid"), [], Person::read)
    }

    /// Takes the page for itself: what another tab sends from now on is refused.
    pub(crate) fn claim(&self, token: &str, tab: &str) -> Result<(), SeatError> {
        self.change("UPDATE person SET tab = ?2 WHERE token = ?1", [token, tab])
    }

    /// Whether this tab is the one that was opened last.
    pub(crate) fn claimed(&self, token: &str, tab: &str) -> Result<bool, SeatError> {
        self.ask(|c| {
            c.prepare_cached("SELECT tab = ?2 FROM person WHERE token = ?1")?
                .query_row([token, tab], |row| row.get::<_, Option<bool>>(0))
        })
        .map(|same| same.unwrap_or(false))
    }

    /// Goes on from step `from` to the next; nothing where that was done before.
    pub(crate) fn go_on(&self, person: &Person, from: usize) -> Result<(), SeatError> {
        let passed = matches!(person.steps.get(from + 1), Some(Step::Aftercare { .. }));
        self.go_to(person, from, from + 1 + usize::from(passed))
    }

    /// Goes from step `from` to `to`; nothing where somebody is elsewhere.
    pub(crate) fn go_to(&self, person: &Person, from: usize, to: usize) -> Result<(), SeatError> {
        self.change(
            "UPDATE person SET at = ?3, since = ?4 WHERE token = ?1 AND at = ?2",
            params![person.token, whole(from), whole(to), now()],
        )
    }

    /// Goes from a step at which somebody stopped to what they are told then, or to the end: nothing is driven any more.
    pub(crate) fn stop(&self, person: &Person, from: usize) -> Result<(), SeatError> {
        let is_aftercare = |step: &Step| matches!(step, Step::Aftercare { .. });
        let aftercare = person.steps.iter().position(is_aftercare);
        let end = person.steps.len().saturating_sub(1);
        self.go_to(person, from, aftercare.unwrap_or(end))
    }

    /// Keeps the answers of a step and goes on.
    pub(crate) fn answer(&self, person: &Person, step: usize, body: &str) -> Result<(), SeatError> {
        self.keep_sheet(person, step, body)?;
        self.go_on(person, step)
    }

    /// Keeps the answers of a step; what was answered before stays.
    pub(crate) fn keep_sheet(
        &self,
        person: &Person,
        step: usize,
        body: &str,
    ) -> Result<(), SeatError> {
        self.change(
            "INSERT OR IGNORE INTO answer (participant, step, body, given) VALUES (?1, ?2, ?3, ?4)",
            params![person.participant, whole(step), body, now()],
        )
    }

    /// The sheet of a step as it is kept; none where nothing was answered.
    pub(crate) fn answered(
        &self,
        participant: &str,
        step: usize,
    ) -> Result<Option<String>, SeatError> {
        let question = "SELECT body FROM answer WHERE participant = ?1 AND step = ?2";
        self.row(question, params![participant, whole(step)], |row| row.get(0))
    }

    /// Every sheet of a person, in the order of the steps.
    pub(crate) fn answers(&self, participant: &str) -> Result<Vec<KeptSheet>, SeatError> {
        self.rows(
            "SELECT step, body, given, listed FROM answer WHERE participant = ?1 ORDER BY step",
            [participant],
            |row| {
                Ok(KeptSheet {
                    step: row.get::<_, i64>(0)? as usize,
                    body: row.get(1)?,
                    given: row.get(2)?,
                    listed: Listed::read(row.get(3)?),
                })
            },
        )
    }

    /// Says what stands of a person in the study's table of people.
    pub(crate) fn list_person(&self, participant: &str, listed: Listed) -> Result<(), SeatError> {
        self.change(
            "UPDATE person SET listed = ?2 WHERE participant = ?1",
            params![participant, listed.number()],
        )
    }

    /// Says what stands of a sheet in the study's table of answers.
    pub(crate) fn list_answer(
        &self,
        (participant, step): (&str, usize),
        listed: Listed,
    ) -> Result<(), SeatError> {
        self.change(
            "UPDATE answer SET listed = ?3 WHERE participant = ?1 AND step = ?2",
            params![participant, whole(step), listed.number()],
        )
    }

    pub(crate) fn fit(&self, person: &Person, fit: &str) -> Result<(), SeatError> {
        self.change("UPDATE person SET fit = ?2 WHERE token = ?1", [&*person.token, fit])
    }

    /// Keeps a person's steps anew.
    pub(crate) fn set_steps(&self, participant: &str, steps: &[Step]) -> Result<(), SeatError> {
        self.ask(|c| {
            let steps = serde_json::to_string(steps)
                .map_err(|e| rusqlite::Error::ToSqlConversionFailure(Box::new(e)))?;
            c.execute("UPDATE person SET steps = ?2 WHERE participant = ?1", [participant, &*steps])
        })
        .map(drop)
    }

    /// Ends a person's part, as [`Person::ended`] says; how it ended before stays.
    pub(crate) fn ended(&self, person: &Person, how: &str) -> Result<(), SeatError> {
        self.change(
            "UPDATE person SET ended = ?2, since = ?3 WHERE token = ?1 AND ended IS NULL",
            params![person.token, how, now()],
        )
    }

    /// Takes away all that is kept of a person, and every note that names them, but the id, which nobody gets again, and the digest of their link, so that it says what
    /// became of it and no file of theirs is taken in again. Gives their token, if they had one here.
    pub(crate) fn forget(&self, participant: &str) -> Result<Option<String>, SeatError> {
        self.without_donor(participant)?;
        let question = "SELECT token FROM person WHERE participant = ?1";
        let token: Option<String> = self.row(question, [participant], |row| row.get(0))?;
        self.ask(|c| {
            for table in [
                "person", "answer", "drive", "piece", "event", "left_out", "repeated", "decided",
            ] {
                c.execute(
                    &format!("DELETE FROM {table} WHERE participant = ?1"),
                    [participant],
                )?;
            }
            let mut events = c.prepare("SELECT rowid, what FROM event")?;
            let rows: Vec<(i64, String)> = events
                .query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?
                .collect::<Result<_, _>>()?;
            for (row, _) in rows.iter().filter(|(_, text)| is_about(text, participant)) {
                c.execute("DELETE FROM event WHERE rowid = ?1", [row])?;
            }
            c.execute(
                "INSERT INTO forgotten (participant, link) VALUES (?1, ?2) ON CONFLICT DO UPDATE SET swept = 0",
                params![participant, token.as_deref().map(token::sha256)],
            )
        })?;
        Ok(token)
    }

    /// The ids that are not given again.
    pub(crate) fn forgotten(&self) -> Result<Vec<String>, SeatError> {
        let question = "SELECT participant FROM forgotten ORDER BY participant";
        self.rows(question, [], |row| row.get(0))
    }

    /// Those of whom something may be left, since the seat was stopped on the way.
    pub(crate) fn not_swept(&self) -> Result<Vec<String>, SeatError> {
        let question = "SELECT participant FROM forgotten WHERE swept = 0";
        self.rows(question, [], |row| row.get(0))
    }

    /// The digests of the links of who is forgotten.
    pub(crate) fn links_forgotten(&self) -> Result<BTreeSet<String>, SeatError> {
        let question = "SELECT link FROM forgotten WHERE link IS NOT NULL";
        self.rows(question, [], |row| row.get(0))
    }

    /// Whether this was the link of somebody who was forgotten.
    pub(crate) fn link_forgotten(&self, token: &str) -> Result<bool, SeatError> {
        self.ask(|c| {
            c.prepare_cached("SELECT COUNT(*) FROM forgotten WHERE link = ?1")?
                .query_row([token::sha256(token)], |row| row.get::<_, i64>(0))
        })
        .map(|count| count > 0)
    }

    /// What happened, the newest first, with whom it happened to: at most so many.
    pub(crate) fn events(&self, most: u32) -> Result<Vec<(Option<String>, String)>, SeatError> {
        let question = "SELECT participant, what FROM event ORDER BY rowid DESC LIMIT ?1";
        self.rows(question, [most], |row| Ok((row.get(0)?, row.get(1)?)))
    }

    pub(crate) fn event(&self, participant: Option<&str>, what: &str) -> Result<(), SeatError> {
        self.change("INSERT INTO event VALUES (?1, ?2, ?3)", params![now(), participant, what])
    }
}
