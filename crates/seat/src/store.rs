//! People, answers and drives in one SQLite file that one program at a time has open.

use crate::{books::Books, error::SeatError, held::held};
use rusqlite::{Connection, TransactionBehavior};
use std::{
    ffi::OsString,
    fs::{File, OpenOptions},
    path::{Path, PathBuf},
    sync::Mutex,
    time::Duration,
};

const VERSION: i64 = 4;

/// How the file is kept: what is deleted is overwritten.
const KEPT: &str = "
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
PRAGMA secure_delete = ON;
";

const TABLES: &str = "
CREATE TABLE IF NOT EXISTS person (
    token TEXT PRIMARY KEY, participant TEXT NOT NULL UNIQUE, steps TEXT NOT NULL, at INTEGER NOT NULL DEFAULT 0,
    ended TEXT, fit TEXT, tab TEXT, listed INTEGER NOT NULL DEFAULT 0, row INTEGER, since INTEGER NOT NULL) STRICT;
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

/// A program that was killed a moment ago may still have the file open.
const OPEN_WITHIN: Duration = Duration::from_secs(3);
const LOOKED_EVERY: Duration = Duration::from_millis(50);
/// Questions that are kept ready.
const READY: usize = 64;

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
        Ok(Self { path: path.to_owned(), connection: Mutex::new(connection), _alone: alone })
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
        let done = work(&Books { connection: &transaction, path: &self.path })?;
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

/// Makes the tables of a new file; gives the version of the file.
fn prepare(connection: &mut Connection) -> rusqlite::Result<i64> {
    connection.execute_batch(KEPT)?;
    let begun = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let number = |question: &str| begun.query_row(question, [], |row| row.get::<_, i64>(0));
    let version = match number("SELECT COUNT(*) FROM sqlite_master")? {
        0 => VERSION,
        _ => number("PRAGMA user_version")?,
    };
    if version == VERSION {
        begun.execute_batch(TABLES)?;
        begun.pragma_update(None, "user_version", VERSION)?;
        begun.commit()?;
    }
    Ok(version)
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
                return Err(SeatError::InUse { path: path.to_owned() });
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
    file.set_permissions(std::os::unix::fs::PermissionsExt::from_mode(0o600)).map_err(io)?;
    drop(file);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_another_version_is_refused_and_left_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("seat.db");
        for found in [0, VERSION - 1, VERSION + 1] {
            let other = Connection::open(&path).unwrap();
            other.execute_batch("CREATE TABLE IF NOT EXISTS person (token TEXT)").unwrap();
            other.pragma_update(None, "user_version", found).unwrap();
            let refused = Store::open(&path).err().unwrap();
            let told = format!("found version {found} of the seat's state, expected {VERSION}");
            assert!(refused.to_string().contains(&told), "{refused}");
            assert!(refused.suggestion().is_some());
            let count = |question| other.query_row(question, [], |row| row.get::<_, i64>(0));
            assert_eq!(count("SELECT COUNT(*) FROM sqlite_master"), Ok(1));
            assert_eq!(count("PRAGMA user_version"), Ok(found));
        }
    }
}
