//! Questions to the seat's file about drives: pieces as they come, each kept once.

use crate::{
    books::{Books, now, whole},
    error::SeatError,
    person::Person,
    steps::Step,
};
use rusqlite::{OptionalExtension as _, params};

/// Bytes that a drive may have beside its steps, and for each of them: inputs that change at every step have some forty.
const BYTES_BESIDE: u64 = 64 << 10;
const BYTES_A_TICK: u64 = 160;
/// A step that is begun again and again may take so often what one whole drive may.
const WHOLE_DRIVES: u64 = 10;

/// How far a drive has come.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Begun {
    /// Counted from 1 within its step.
    pub(crate) attempt: u32,
    pub(crate) ticks: u64,
    /// Whether its end was kept.
    pub(crate) ended: bool,
    /// Bytes of what was kept.
    pub(crate) bytes: u64,
    /// Whether it counts no more, since the step is driven again.
    pub(crate) set_aside: bool,
}

impl Begun {
    /// Whether this is the drive of its step.
    pub(crate) fn is_whole(&self) -> bool {
        self.ended && !self.set_aside
    }

    /// As its record is kept beside that of the drive of its step.
    pub(crate) fn kept_as(&self) -> String {
        let why = if self.set_aside { "repeated" } else { "cut" };
        format!("{why}{}", self.attempt)
    }
}

/// Most bytes of a drive of so many steps.
pub(crate) fn most_bytes(ticks: u64) -> u64 {
    BYTES_BESIDE + BYTES_A_TICK * ticks
}

/// Most bytes of all that is driven at a step of at most so many steps of 0.01 s.
pub(crate) fn most_bytes_of_step(ticks: u64) -> u64 {
    WHOLE_DRIVES * most_bytes(ticks)
}

impl Books<'_> {
    /// The drives begun at a step, in order.
    pub(crate) fn begun(&self, participant: &str, step: usize) -> Result<Vec<Begun>, SeatError> {
        self.rows(
            "SELECT attempt, ticks, end IS NOT NULL, bytes,
                attempt <= (SELECT COALESCE(MAX(attempt), 0) FROM repeated WHERE participant = ?1 AND step = ?2)
             FROM drive WHERE participant = ?1 AND step = ?2 ORDER BY attempt",
            params![participant, whole(step)],
            |row| {
                Ok(Begun {
                    attempt: row.get(0)?,
                    ticks: row.get::<_, i64>(1)?.cast_unsigned(),
                    ended: row.get(2)?,
                    bytes: row.get::<_, i64>(3)?.cast_unsigned(),
                    set_aside: row.get(4)?,
                })
            },
        )
    }

    /// The record of the drive by hand that somebody's style is learned of; none before it has ended.
    pub(crate) fn own_drive(&self, person: &Person) -> Result<Option<String>, SeatError> {
        let Some(step) = person.steps.iter().position(Step::is_learned_of) else {
            return Ok(None);
        };
        let begun = self.begun(&person.participant, step)?;
        let whole = begun.iter().find(|begun| begun.is_whole());
        whole.map(|begun| self.record(&person.participant, (step, begun.attempt))).transpose()
    }

    /// The step and attempt that somebody drove last.
    pub(crate) fn last_drive(&self, participant: &str) -> Result<Option<(usize, u32)>, SeatError> {
        self.row(
            "SELECT step, attempt FROM drive WHERE participant = ?1 ORDER BY step DESC, attempt DESC LIMIT 1",
            [participant],
            |row| Ok((row.get::<_, i64>(0)? as usize, row.get(1)?)),
        )
    }

    /// Begins a drive; the same header again changes nothing.
    pub(crate) fn begin(
        &self,
        participant: &str,
        (step, attempt): (usize, u32),
        header: &str,
    ) -> Result<(), SeatError> {
        self.change(
            "INSERT OR IGNORE INTO drive (participant, step, attempt, header, begun) VALUES (?1, ?2, ?3, ?4, ?5)",
            params![participant, whole(step), attempt, header, now()],
        )
    }

    /// Keeps pieces that follow on one another, `(from_tick, ticks, line)`. Gives the step up to which all is kept; none where a piece is
    /// another than the one that is there already: somebody else drives this attempt.
    pub(crate) fn keep(
        &self,
        participant: &str,
        (step, attempt): (usize, u32),
        pieces: &[(u64, u64, String)],
    ) -> Result<Option<u64>, SeatError> {
        self.ask(|c| {
            let (mut kept, mut bytes): (i64, i64) = c
                .prepare_cached("SELECT ticks, bytes FROM drive WHERE participant = ?1 AND step = ?2 AND attempt = ?3")?
                .query_row(params![participant, whole(step), attempt], |row| Ok((row.get(0)?, row.get(1)?)))?;
            let (before, mut same) = (kept, true);
            for (from, ticks, line) in pieces {
                let place = params![participant, whole(step), attempt, from.cast_signed()];
                if from.cast_signed() == kept {
                    c.prepare_cached("INSERT INTO piece VALUES (?1, ?2, ?3, ?4, ?5)")?
                        .execute(params![participant, whole(step), attempt, kept, line])?;
                    kept += ticks.cast_signed();
                    bytes += whole(line.len());
                } else if from.cast_signed() < before {
                    let there: Option<String> = c
                        .prepare_cached("SELECT line FROM piece WHERE participant = ?1 AND step = ?2 AND attempt = ?3 AND from_tick = ?4")?
                        .query_row(place, |row| row.get(0))
                        .optional()?;
                    same &= there.as_ref() == Some(line);
                }
            }
            c.prepare_cached("UPDATE drive SET ticks = ?4, bytes = ?5 WHERE participant = ?1 AND step = ?2 AND attempt = ?3")?
                .execute(params![participant, whole(step), attempt, kept, bytes])?;
            Ok(same.then_some(kept.cast_unsigned()))
        })
    }

    /// Keeps the end of a drive.
    pub(crate) fn end(
        &self,
        participant: &str,
        (step, attempt): (usize, u32),
        end: &str,
    ) -> Result<(), SeatError> {
        self.change(
            "UPDATE drive SET end = ?4 WHERE participant = ?1 AND step = ?2 AND attempt = ?3 AND end IS NULL",
            params![participant, whole(step), attempt, end],
        )
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
                |row| Ok((row.get(0)?, row.get(1)?)),
            )?;
            let mut pieces = c.prepare_cached(
                "SELECT line FROM piece WHERE participant = ?1 AND step = ?2 AND attempt = ?3 ORDER BY from_tick",
            )?;
            let mut lines = header + "\n";
            for line in pieces.query_map(key, |row| row.get::<_, String>(0))? {
                lines += &(line? + "\n");
            }
            if let Some(end) = end {
                lines += &(end + "\n");
            }
            Ok(lines)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{person::Person, store::Store};

    fn store() -> (tempfile::TempDir, Store) {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("seat.db")).unwrap();
        let person = Person::new("t".to_owned(), "P01".to_owned(), Vec::new());
        store.within(|b| b.add(&person)).unwrap();
        (folder, store)
    }

    fn piece(from: u64, line: &str) -> (u64, u64, String) {
        (from, 100, line.to_owned())
    }

    #[test]
    fn pieces_are_kept_once_in_order_a_gap_waits_and_another_drive_is_told_apart() {
        let (_folder, store) = store();
        let here = ("P01", (3, 1));
        store.within(|b| b.begin(here.0, here.1, "head")).unwrap();
        let keep = |pieces: &[(u64, u64, String)]| {
            store.within(|b| b.keep(here.0, here.1, pieces)).unwrap()
        };
        assert_eq!(keep(&[piece(0, "a"), piece(100, "b")]), Some(200));
        assert_eq!(keep(&[piece(100, "b")]), Some(200));
        assert_eq!(keep(&[piece(100, "another")]), None);
        assert_eq!(keep(&[piece(300, "too soon")]), Some(200));
        assert_eq!(keep(&[piece(200, "c"), piece(300, "d")]), Some(400));
        store.within(|b| b.end(here.0, here.1, "end")).unwrap();
        let record = store.look(|b| b.record(here.0, here.1)).unwrap();
        assert_eq!(record, "head\na\nb\nc\nd\nend\n");
        let begun = store.look(|b| b.begun("P01", 3)).unwrap();
        assert_eq!((begun[0].bytes, begun[0].ended), (4, true));
    }

    #[test]
    fn what_was_kept_is_there_when_the_file_is_opened_again_and_what_failed_is_not() {
        let (folder, store) = store();
        let person = |store: &Store| store.look(|b| b.person("t")).unwrap().unwrap();
        let me = person(&store);
        store.within(|b| b.answer(&me, 0, "{}")).unwrap();
        // The same page sent twice, as after a lost reply; and one of which a part failed.
        store.within(|b| b.answer(&me, 0, "{\"other\":1}")).unwrap();
        let failed: Result<(), SeatError> = store.within(|b| {
            b.answer(&me, 1, "{}")?;
            Err(SeatError::NoRecord(folder.path().to_owned()))
        });
        assert!(failed.is_err());
        drop(store);
        let again = Store::open(&folder.path().join("seat.db")).unwrap();
        assert_eq!(person(&again).at, 1);
        let answers = again.look(|b| b.answers("P01")).unwrap();
        assert_eq!(answers.len(), 1);
        assert_eq!(answers[0].body, "{}");
    }
}
