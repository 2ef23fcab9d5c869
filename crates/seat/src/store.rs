//! People, answers and drives in one SQLite file that one program at a time has open.

use crate::{books::Books, error::SeatError, held::held, token};
use rusqlite::{Connection, TransactionBehavior};
use std::{
    ffi::OsString,
    fs::{File, OpenOptions},
    path::{Path, PathBuf},
    sync::Mutex,
    time::Duration,
};

/// Version of the tables.
const VERSION: i64 = 3;

/// How the file is kept: what is deleted is overwritten.
const KEPT: &str = "
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
PRAGMA secure_delete = ON;
";

/// What the tables are.
const TABLES: &str = "
CREATE TABLE IF NOT EXISTS person (
    token TEXT PRIMARY KEY, participant TEXT NOT NULL UNIQUE, steps TEXT NOT NULL, at INTEGER NOT NULL DEFAULT 0,
    ended TEXT, fit TEXT, tab TEXT, made INTEGER NOT NULL, listed INTEGER NOT NULL DEFAULT 0, row INTEGER, since INTEGER) STRICT;
CREATE TABLE IF NOT EXISTS answer (
    participant TEXT NOT NULL, step INTEGER NOT NULL, body TEXT NOT NULL, given INTEGER NOT NULL, listed INTEGER NOT NULL DEFAULT 0,
    PRIMARY KEY (participant, step)) STRICT;
CREATE TABLE IF NOT EXISTS drive (
    participant TEXT NOT NULL, step INTEGER NOT NULL, attempt INTEGER NOT NULL, header TEXT NOT NULL,
    ticks INTEGER NOT NULL DEFAULT 0, end TEXT, begun INTEGER NOT NULL, bytes INTEGER NOT NULL DEFAULT 0,
    PRIMARY KEY (participant, step, attempt)) STRICT;
CREATE TABLE IF NOT EXISTS piece (
    participant TEXT NOT NULL, step INTEGER NOT NULL, attempt INTEGER NOT NULL, from_tick INTEGER NOT NULL, line TEXT NOT NULL,
    PRIMARY KEY (participant, step, attempt, from_tick)) STRICT, WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS left_out (
    participant TEXT NOT NULL, step INTEGER NOT NULL, what TEXT NOT NULL, given INTEGER NOT NULL, PRIMARY KEY (participant, step)) STRICT;
CREATE TABLE IF NOT EXISTS repeated (
    participant TEXT NOT NULL, step INTEGER NOT NULL, attempt INTEGER NOT NULL, what TEXT NOT NULL, given INTEGER NOT NULL,
    PRIMARY KEY (participant, step, attempt)) STRICT;
CREATE TABLE IF NOT EXISTS decided (
    participant TEXT NOT NULL, step INTEGER NOT NULL, what TEXT NOT NULL, given INTEGER NOT NULL) STRICT;
CREATE TABLE IF NOT EXISTS event (
    given INTEGER NOT NULL, participant TEXT, what TEXT NOT NULL) STRICT;
CREATE TABLE IF NOT EXISTS forgotten (
    participant TEXT PRIMARY KEY, link TEXT UNIQUE, swept INTEGER NOT NULL DEFAULT 0) STRICT;
CREATE TABLE IF NOT EXISTS not_admitted (rule TEXT PRIMARY KEY, people INTEGER NOT NULL) STRICT;
CREATE TABLE IF NOT EXISTS not_agreed (text_sha256 TEXT PRIMARY KEY, people INTEGER NOT NULL) STRICT;
CREATE TABLE IF NOT EXISTS platform (id TEXT PRIMARY KEY, token TEXT NOT NULL) STRICT;
CREATE TABLE IF NOT EXISTS secret (name TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT;
";

/// What the first version had not. Who was through then had been written into the study's tables.
const FROM_1: &str = "
ALTER TABLE person ADD COLUMN listed INTEGER NOT NULL DEFAULT 0;
ALTER TABLE answer ADD COLUMN listed INTEGER NOT NULL DEFAULT 0;
ALTER TABLE drive ADD COLUMN bytes INTEGER NOT NULL DEFAULT 0;
UPDATE person SET listed = 1 WHERE ended IS NOT NULL;
UPDATE answer SET listed = 1 WHERE participant IN (SELECT participant FROM person WHERE ended IS NOT NULL);
";

/// What the second version had not: the row of the square that somebody has, and since when they are at their step.
const FROM_2: &str = "
ALTER TABLE person ADD COLUMN row INTEGER;
ALTER TABLE person ADD COLUMN since INTEGER;
";

/// A program that was killed a moment ago may still have the file open.
const OPEN_WITHIN: Duration = Duration::from_secs(3);
const LOOKED_EVERY: Duration = Duration::from_millis(50);
/// Questions that are kept ready.
const READY: usize = 64;

/// The file.
pub(crate) struct Store {
    path: PathBuf,
    connection: Mutex<Connection>,
    /// Locked as long as the file is open here.
    _alone: File,
}

impl Store {
    /// Opens the file, or begins it.
    pub(crate) fn open(path: &Path) -> Result<Self, SeatError> {
        let alone = alone(path)?;
        for ending in ["", "-wal", "-shm"] {
            owners_alone(&beside(path, ending), ending.is_empty())?;
        }
        let bad = |source| SeatError::store(path, source);
        let mut connection = Connection::open(path).map_err(bad)?;
        connection.set_prepared_statement_cache_capacity(READY);
        let version = prepare(&mut connection).map_err(bad)?;
        if version != VERSION {
            return Err(SeatError::Version {
                path: path.to_owned(),
                found: version,
                expected: VERSION,
            });
        }
        Ok(Self {
            path: path.to_owned(),
            connection: Mutex::new(connection),
            _alone: alone,
        })
    }

    /// Asks and writes in one transaction: all of it is kept, or nothing.
    ///
    /// # Errors
    /// [`SeatError::Store`], and what `work` says.
    pub(crate) fn within<T, E: From<SeatError>>(
        &self,
        work: impl FnOnce(&Books<'_>) -> Result<T, E>,
    ) -> Result<T, E> {
        self.transaction(TransactionBehavior::Immediate, work)
    }

    /// Asks in one transaction: what is read belongs together.
    pub(crate) fn look<T, E: From<SeatError>>(
        &self,
        work: impl FnOnce(&Books<'_>) -> Result<T, E>,
    ) -> Result<T, E> {
        self.transaction(TransactionBehavior::Deferred, work)
    }

    fn transaction<T, E: From<SeatError>>(
        &self,
        behaviour: TransactionBehavior,
        work: impl FnOnce(&Books<'_>) -> Result<T, E>,
    ) -> Result<T, E> {
        let bad = |source| SeatError::store(&self.path, source);
        let mut connection = held(&self.connection);
        let transaction = connection.transaction_with_behavior(behaviour);
        let transaction = transaction.map_err(bad)?;
        let done = work(&Books {
            connection: &transaction,
            path: &self.path,
        })?;
        transaction.commit().map_err(bad)?;
        Ok(done)
    }

    /// Rebuilds the file from what is kept, and empties what lies beside it: bytes of deleted rows are nowhere any more.
    pub(crate) fn sweep(&self) -> Result<(), SeatError> {
        let connection = held(&self.connection);
        let swept = connection
            .execute_batch("VACUUM")
            .and_then(|()| empty_log(&connection))
            .and_then(|()| connection.execute("UPDATE forgotten SET swept = 1", []))
            .and_then(|_| empty_log(&connection));
        swept.map_err(|source| SeatError::store(&self.path, source))
    }

    /// Whether a file is this one, or lies beside it for it.
    pub(crate) fn has(&self, path: &Path) -> bool {
        let name = |path: &Path| path.file_name().map(|n| n.to_string_lossy().into_owned());
        name(path).is_some_and(|n| n.starts_with(&name(&self.path).unwrap_or(n.clone())))
    }
}

/// Writes what lies in the log beside the file into the file, and leaves the log empty.
fn empty_log(connection: &Connection) -> rusqlite::Result<()> {
    connection.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |row| {
        match row.get::<_, i64>(0)? {
            0 => Ok(()),
            _ => Err(rusqlite::Error::SqliteFailure(
                rusqlite::ffi::Error::new(rusqlite::ffi::SQLITE_BUSY),
                Some("another program reads the file: close it".to_owned()),
            )),
        }
    })
}

/// Makes the tables, or brings those of an older version up to date, all of it or nothing; gives the version they now have.
fn prepare(connection: &mut Connection) -> rusqlite::Result<i64> {
    connection.execute_batch(KEPT)?;
    let older = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let number = |question: &str| older.query_row(question, [], |row| row.get::<_, i64>(0));
    let version = match number("SELECT COUNT(*) FROM sqlite_master")? {
        0 => VERSION,
        _ => number("PRAGMA user_version")?,
    };
    match version {
        VERSION => older.execute_batch(TABLES)?,
        1 => {
            older.execute_batch(FROM_1)?;
            older.execute_batch(FROM_2)?;
            older.execute_batch(TABLES)?;
            forget_deleted(&older)?;
        }
        2 => {
            older.execute_batch(FROM_2)?;
            older.execute_batch(TABLES)?;
        }
        _ => return Ok(version),
    }
    older.pragma_update(None, "user_version", VERSION)?;
    older.commit()?;
    Ok(VERSION)
}

/// Who was deleted by the first version had left their link, their order and their time.
fn forget_deleted(older: &Connection) -> rusqlite::Result<()> {
    let deleted: Vec<(String, String)> = older
        .prepare("SELECT participant, token FROM person WHERE ended = 'deleted'")?
        .query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?
        .collect::<Result<_, _>>()?;
    for (participant, link) in deleted {
        older.execute(
            "INSERT OR IGNORE INTO forgotten (participant, link) VALUES (?1, ?2)",
            [&participant, &token::sha256(&link)],
        )?;
        older.execute("DELETE FROM person WHERE participant = ?1", [&participant])?;
    }
    Ok(())
}

fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(ending);
    PathBuf::from(name)
}

/// Keeps other seats from the same file as long as what is given back lives.
fn alone(path: &Path) -> Result<File, SeatError> {
    let lock = beside(path, "-lock");
    let io = |source| SeatError::io(&lock, source);
    owners_alone(&lock, true)?;
    let file = File::open(&lock).map_err(io)?;
    let begun = std::time::Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(std::fs::TryLockError::WouldBlock) if begun.elapsed() < OPEN_WITHIN => {
                std::thread::sleep(LOOKED_EVERY);
            }
            Err(std::fs::TryLockError::WouldBlock) => {
                return Err(SeatError::InUse {
                    path: path.to_owned(),
                });
            }
            Err(std::fs::TryLockError::Error(source)) => return Err(io(source)),
        }
    }
}

/// Lets nobody but its owner read a file; `makes` begins one that is not there.
fn owners_alone(path: &Path, makes: bool) -> Result<(), SeatError> {
    if !makes && !path.exists() {
        return Ok(());
    }
    let io = |source| SeatError::io(path, source);
    let mut options = OpenOptions::new();
    options.append(true).create(makes);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let file = options.open(path).map_err(io)?;
    #[cfg(unix)]
    file.set_permissions(std::os::unix::fs::PermissionsExt::from_mode(0o600))
        .map_err(io)?;
    drop(file);
    Ok(())
}
