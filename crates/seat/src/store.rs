//! People, answers and drives in one SQLite file.

use crate::{error::SeatError, parts::Carried, person::Person};
use rusqlite::{Connection, OptionalExtension as _, params};
use std::{
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};

/// Version of the tables.
const VERSION: i64 = 1;

/// What the tables are. What is deleted is overwritten.
const TABLES: &str = "
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
PRAGMA secure_delete = ON;
CREATE TABLE IF NOT EXISTS person (
    token TEXT PRIMARY KEY, participant TEXT NOT NULL UNIQUE, steps TEXT NOT NULL, at INTEGER NOT NULL DEFAULT 0,
    ended TEXT, fit TEXT, tab TEXT, made INTEGER NOT NULL) STRICT;
CREATE TABLE IF NOT EXISTS answer (
    participant TEXT NOT NULL, step INTEGER NOT NULL, body TEXT NOT NULL, given INTEGER NOT NULL,
    PRIMARY KEY (participant, step)) STRICT;
CREATE TABLE IF NOT EXISTS drive (
    participant TEXT NOT NULL, step INTEGER NOT NULL, attempt INTEGER NOT NULL, header TEXT NOT NULL,
    ticks INTEGER NOT NULL DEFAULT 0, end TEXT, begun INTEGER NOT NULL,
    PRIMARY KEY (participant, step, attempt)) STRICT;
CREATE TABLE IF NOT EXISTS piece (
    participant TEXT NOT NULL, step INTEGER NOT NULL, attempt INTEGER NOT NULL, from_tick INTEGER NOT NULL, line TEXT NOT NULL,
    PRIMARY KEY (participant, step, attempt, from_tick)) STRICT, WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS event (
    given INTEGER NOT NULL, participant TEXT, what TEXT NOT NULL) STRICT;
";

/// The file.
pub(crate) struct Store {
    path: PathBuf,
    connection: Mutex<Connection>,
}

/// How far a drive has come.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Begun {
    /// Counted from 1 within its step.
    pub(crate) attempt: u32,
    /// Steps that were kept.
    pub(crate) ticks: u64,
    /// Whether its end was kept.
    pub(crate) ended: bool,
}

/// A number of a step as SQLite has it: there are never so many.
fn whole(step: usize) -> i64 {
    i64::try_from(step).unwrap_or(i64::MAX)
}

fn now() -> i64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.map_or(0, |d| d.as_secs().cast_signed())
}

impl Store {
    /// Opens the file, or begins it.
    pub(crate) fn open(path: &Path) -> Result<Self, SeatError> {
        let bad = |source| SeatError::Store {
            path: path.to_owned(),
            source,
        };
        let connection = Connection::open(path).map_err(bad)?;
        let version =
            |c: &Connection| c.query_row("PRAGMA user_version", [], |r| r.get::<_, i64>(0));
        let tables: i64 = connection
            .query_row("SELECT COUNT(*) FROM sqlite_master", [], |r| r.get(0))
            .map_err(bad)?;
        if tables == 0 {
            connection
                .pragma_update(None, "user_version", VERSION)
                .map_err(bad)?;
        }
        let found = version(&connection).map_err(bad)?;
        if found != VERSION {
            return Err(SeatError::Version {
                path: path.to_owned(),
                found,
                expected: VERSION,
            });
        }
        connection.execute_batch(TABLES).map_err(bad)?;
        Ok(Self {
            path: path.to_owned(),
            connection: Mutex::new(connection),
        })
    }

    fn ask<T>(
        &self,
        question: impl FnOnce(&mut Connection) -> rusqlite::Result<T>,
    ) -> Result<T, SeatError> {
        // A panic while the file was open leaves a transaction that is rolled back.
        let mut connection: MutexGuard<'_, Connection> = self
            .connection
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        question(&mut connection).map_err(|source| SeatError::Store {
            path: self.path.clone(),
            source,
        })
    }

    /// Lets somebody in.
    pub(crate) fn add(&self, token: &str, participant: &str, steps: &str) -> Result<(), SeatError> {
        self.ask(|c| {
            c.execute(
                "INSERT INTO person (token, participant, steps, made) VALUES (?1, ?2, ?3, ?4)",
                params![token, participant, steps, now()],
            )
        })
        .map(drop)
    }

    /// Lets in somebody with all that they gave, or not at all.
    pub(crate) fn take_in(&self, person: &Person, given: &Carried) -> Result<(), SeatError> {
        // Steps are made of what was checked.
        let steps = serde_json::to_string(&person.steps).unwrap_or_default();
        self.ask(|c| {
            let t = c.transaction()?;
            let who = &person.participant;
            t.execute(
                "INSERT INTO person (token, participant, steps, at, ended, fit, made) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
                params![person.token, who, steps, whole(person.at), person.ended, person.fit, now()],
            )?;
            for (step, sheet) in &given.sheets {
                t.execute(
                    "INSERT OR IGNORE INTO answer (participant, step, body, given) VALUES (?1, ?2, ?3, ?4)",
                    params![who, whole(*step), sheet, now()],
                )?;
            }
            for (step, attempt, parts) in &given.drives {
                let mut kept = 0;
                for (from, ticks, line) in &parts.pieces {
                    if *from == kept {
                        t.execute(
                            "INSERT OR IGNORE INTO piece VALUES (?1, ?2, ?3, ?4, ?5)",
                            params![who, whole(*step), attempt, kept.cast_signed(), line],
                        )?;
                        kept += ticks;
                    }
                }
                let end = parts.end.as_ref().filter(|(at, _)| *at == kept);
                t.execute(
                    "INSERT OR IGNORE INTO drive (participant, step, attempt, header, ticks, end, begun) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
                    params![who, whole(*step), attempt, parts.header, kept.cast_signed(), end.map(|(_, line)| line), now()],
                )?;
            }
            t.commit()
        })
    }

    /// The person of a token.
    pub(crate) fn person(&self, token: &str) -> Result<Option<Person>, SeatError> {
        self.ask(|c| {
            c.query_row(
                "SELECT token, participant, steps, at, ended, fit FROM person WHERE token = ?1",
                [token],
                Person::read,
            )
            .optional()
        })
    }

    /// Everybody, in the order in which they were let in.
    pub(crate) fn everybody(&self) -> Result<Vec<Person>, SeatError> {
        self.ask(|c| {
            let mut found = c.prepare_cached(
                "SELECT token, participant, steps, at, ended, fit FROM person ORDER BY rowid",
            )?;
            found.query_map([], Person::read)?.collect()
        })
    }

    /// Takes the page for itself: what another tab sends from now on is refused.
    pub(crate) fn claim(&self, token: &str, tab: &str) -> Result<(), SeatError> {
        self.ask(|c| c.execute("UPDATE person SET tab = ?2 WHERE token = ?1", [token, tab]))
            .map(drop)
    }

    /// Whether this tab is the one that was opened last.
    pub(crate) fn claimed(&self, token: &str, tab: &str) -> Result<bool, SeatError> {
        self.ask(|c| {
            c.query_row(
                "SELECT tab = ?2 FROM person WHERE token = ?1",
                [token, tab],
                |r| r.get::<_, Option<bool>>(0),
            )
        })
        .map(|same| same.unwrap_or(false))
    }

    /// Goes on from step `from` to the next; nothing where that was done before.
    pub(crate) fn go_on(&self, token: &str, from: usize) -> Result<(), SeatError> {
        self.ask(|c| {
            c.execute(
                "UPDATE person SET at = ?2 + 1 WHERE token = ?1 AND at = ?2",
                params![token, whole(from)],
            )
        })
        .map(drop)
    }

    /// Keeps the answers of a step and goes on, both or neither.
    pub(crate) fn answer(&self, person: &Person, step: usize, body: &str) -> Result<(), SeatError> {
        self.ask(|c| {
            let t = c.transaction()?;
            t.execute(
                "INSERT OR IGNORE INTO answer (participant, step, body, given) VALUES (?1, ?2, ?3, ?4)",
                params![person.participant, whole(step), body, now()],
            )?;
            t.execute(
                "UPDATE person SET at = ?2 + 1 WHERE token = ?1 AND at = ?2",
                params![person.token, whole(step)],
            )?;
            t.commit()
        })
    }

    /// Every answer of a person: step and body.
    pub(crate) fn answers(&self, participant: &str) -> Result<Vec<(usize, String)>, SeatError> {
        self.ask(|c| {
            let mut found = c.prepare_cached(
                "SELECT step, body FROM answer WHERE participant = ?1 ORDER BY step",
            )?;
            found
                .query_map([participant], |r| {
                    Ok((r.get::<_, i64>(0)? as usize, r.get(1)?))
                })?
                .collect()
        })
    }

    /// The drives begun at a step, in order.
    pub(crate) fn begun(&self, participant: &str, step: usize) -> Result<Vec<Begun>, SeatError> {
        self.ask(|c| {
            let mut found = c.prepare_cached(
                "SELECT attempt, ticks, end IS NOT NULL FROM drive WHERE participant = ?1 AND step = ?2 ORDER BY attempt",
            )?;
            let read = |r: &rusqlite::Row<'_>| {
                Ok(Begun {
                    attempt: r.get(0)?,
                    ticks: r.get::<_, i64>(1)?.cast_unsigned(),
                    ended: r.get(2)?,
                })
            };
            found.query_map(params![participant, whole(step)], read)?.collect()
        })
    }

    /// The step and attempt that somebody drove last.
    pub(crate) fn last_drive(&self, participant: &str) -> Result<Option<(usize, u32)>, SeatError> {
        self.ask(|c| {
            c.query_row(
                "SELECT step, attempt FROM drive WHERE participant = ?1 ORDER BY step DESC, attempt DESC LIMIT 1",
                [participant],
                |r| Ok((r.get::<_, i64>(0)? as usize, r.get(1)?)),
            )
            .optional()
        })
    }

    /// Begins a drive; the same header again changes nothing.
    pub(crate) fn begin(
        &self,
        participant: &str,
        step: usize,
        attempt: u32,
        header: &str,
    ) -> Result<(), SeatError> {
        self.ask(|c| {
            c.execute(
                "INSERT OR IGNORE INTO drive (participant, step, attempt, header, begun) VALUES (?1, ?2, ?3, ?4, ?5)",
                params![participant, whole(step), attempt, header, now()],
            )
        })
        .map(drop)
    }

    /// Keeps pieces that follow on one another, `(from_tick, ticks, line)`; those that are there already are left as they are. Gives the
    /// step up to which all is kept.
    pub(crate) fn keep(
        &self,
        participant: &str,
        (step, attempt): (usize, u32),
        pieces: &[(u64, u64, String)],
    ) -> Result<u64, SeatError> {
        self.ask(|c| {
            let t = c.transaction()?;
            let key = params![participant, whole(step), attempt];
            let mut kept: i64 = t.query_row(
                "SELECT ticks FROM drive WHERE participant = ?1 AND step = ?2 AND attempt = ?3",
                key,
                |r| r.get(0),
            )?;
            for (from, ticks, line) in pieces {
                if from.cast_signed() == kept {
                    t.prepare_cached("INSERT OR IGNORE INTO piece VALUES (?1, ?2, ?3, ?4, ?5)")?
                        .execute(params![participant, whole(step), attempt, kept, line])?;
                    kept += ticks.cast_signed();
                }
            }
            t.prepare_cached(
                "UPDATE drive SET ticks = ?4 WHERE participant = ?1 AND step = ?2 AND attempt = ?3",
            )?
            .execute(params![participant, whole(step), attempt, kept])?;
            t.commit()?;
            Ok(kept.cast_unsigned())
        })
    }

    /// Keeps the end of a drive.
    pub(crate) fn end(
        &self,
        participant: &str,
        (step, attempt): (usize, u32),
        end: &str,
    ) -> Result<(), SeatError> {
        self.ask(|c| {
            c.execute(
                "UPDATE drive SET end = ?4 WHERE participant = ?1 AND step = ?2 AND attempt = ?3 AND end IS NULL",
                params![participant, whole(step), attempt, end],
            )
        })
        .map(drop)
    }

    /// The record of a drive, as lines.
    pub(crate) fn record(
        &self,
        participant: &str,
        (step, attempt): (usize, u32),
    ) -> Result<String, SeatError> {
        self.ask(|c| {
            let key = params![participant, whole(step), attempt];
            let (header, end): (String, Option<String>) = c.query_row(
                "SELECT header, end FROM drive WHERE participant = ?1 AND step = ?2 AND attempt = ?3",
                key,
                |r| Ok((r.get(0)?, r.get(1)?)),
            )?;
            let mut pieces = c.prepare_cached(
                "SELECT line FROM piece WHERE participant = ?1 AND step = ?2 AND attempt = ?3 ORDER BY from_tick",
            )?;
            let mut lines = header + "\n";
            for line in pieces.query_map(key, |r| r.get::<_, String>(0))? {
                lines += &(line? + "\n");
            }
            if let Some(end) = end {
                lines += &(end + "\n");
            }
            Ok(lines)
        })
    }

    /// Keeps a person's style.
    pub(crate) fn fit(&self, token: &str, fit: &str) -> Result<(), SeatError> {
        self.ask(|c| c.execute("UPDATE person SET fit = ?2 WHERE token = ?1", [token, fit]))
            .map(drop)
    }

    /// Ends a person's part: `done`, `left`, or `deleted`, which takes away what they gave.
    pub(crate) fn ended(&self, person: &Person, how: &str) -> Result<(), SeatError> {
        self.ask(|c| {
            let t = c.transaction()?;
            if how == "deleted" {
                for table in ["answer", "drive", "piece", "event"] {
                    t.execute(
                        &format!("DELETE FROM {table} WHERE participant = ?1"),
                        [&person.participant],
                    )?;
                }
                t.execute(
                    "UPDATE person SET fit = NULL WHERE token = ?1",
                    [&person.token],
                )?;
            }
            t.execute(
                "UPDATE person SET ended = ?2 WHERE token = ?1 AND ended IS NULL",
                [&*person.token, how],
            )?;
            t.commit()
        })
    }

    /// What happened, the newest first, with whom it happened to: at most so many.
    pub(crate) fn events(&self, most: u32) -> Result<Vec<(Option<String>, String)>, SeatError> {
        self.ask(|c| {
            let mut found = c.prepare_cached(
                "SELECT participant, what FROM event ORDER BY rowid DESC LIMIT ?1",
            )?;
            found
                .query_map([most], |r| Ok((r.get(0)?, r.get(1)?)))?
                .collect()
        })
    }

    /// Writes down what happened.
    pub(crate) fn event(&self, participant: Option<&str>, what: &str) -> Result<(), SeatError> {
        self.ask(|c| {
            c.execute(
                "INSERT INTO event VALUES (?1, ?2, ?3)",
                params![now(), participant, what],
            )
        })
        .map(drop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn store() -> (tempfile::TempDir, Store) {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("seat.db")).unwrap();
        store.add("t", "P01", "[]").unwrap();
        (folder, store)
    }

    fn piece(from: u64, line: &str) -> (u64, u64, String) {
        (from, 100, line.to_owned())
    }

    #[test]
    fn pieces_are_kept_once_in_order_and_a_gap_waits() {
        let (_folder, store) = store();
        store.begin("P01", 3, 1, "head").unwrap();
        let keep = |pieces: &[(u64, u64, String)]| store.keep("P01", (3, 1), pieces).unwrap();
        assert_eq!(keep(&[piece(0, "a"), piece(100, "b")]), 200);
        assert_eq!(keep(&[piece(100, "again")]), 200);
        assert_eq!(keep(&[piece(300, "too soon")]), 200);
        assert_eq!(keep(&[piece(200, "c"), piece(300, "d")]), 400);
        store.end("P01", (3, 1), "end").unwrap();
        assert_eq!(
            store.record("P01", (3, 1)).unwrap(),
            "head\na\nb\nc\nd\nend\n"
        );
    }

    #[test]
    fn what_was_kept_is_there_when_the_file_is_opened_again() {
        let (folder, store) = store();
        let person = store.person("t").unwrap().unwrap();
        store.answer(&person, 0, "{}").unwrap();
        // The same page sent twice, as after a lost reply.
        store.answer(&person, 0, "{\"other\":1}").unwrap();
        std::mem::forget(store);
        let again = Store::open(&folder.path().join("seat.db")).unwrap();
        assert_eq!(again.person("t").unwrap().unwrap().at, 1);
        assert_eq!(again.answers("P01").unwrap(), [(0, "{}".to_owned())]);
    }

    #[test]
    fn who_leaves_and_asks_for_it_leaves_nothing_behind() {
        let (_folder, store) = store();
        let person = store.person("t").unwrap().unwrap();
        store.answer(&person, 0, "{}").unwrap();
        store.begin("P01", 1, 1, "head").unwrap();
        store.ended(&person, "deleted").unwrap();
        assert!(store.answers("P01").unwrap().is_empty());
        assert!(store.begun("P01", 1).unwrap().is_empty());
        assert_eq!(
            store.person("t").unwrap().unwrap().ended.as_deref(),
            Some("deleted")
        );
    }
}
