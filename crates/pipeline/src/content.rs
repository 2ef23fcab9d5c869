//! Hashes of files and directories, remembered as long as a file looks untouched.

use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{SystemTime, UNIX_EPOCH};

use rayon::prelude::*;

use crate::atomic_write::{Durability, atomic_write_bytes};
use crate::shares::Shares;
use crate::{PipelineError, Place};

/// File systems stamp times in ticks of up to 10 ms: a file changed this lately could
/// change again without looking changed, so its hash is not remembered.
const SETTLED_AFTER_NS: i64 = 25_000_000;
/// How much of a file is read at a time.
const BLOCK: u64 = 4 << 20;
/// From this size on, a file is hashed on several threads.
const WORTH_THREADS: usize = 256 << 10;

/// The flag of work that nobody interrupts.
static NEVER: AtomicBool = AtomicBool::new(false);

/// What tells an untouched file: if all of it is the same, the content is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
struct Look {
    size: u64,
    modified_ns: i64,
    /// Of the file's record: also moves when a copy keeps the time of its original.
    changed_ns: i64,
    inode: u64,
}

type Cache = BTreeMap<String, (Look, String)>;

/// Hashes contents below a root; shared by all workers of a run.
pub(crate) struct Hasher<'a> {
    root: &'a Path,
    cache_file: PathBuf,
    /// What is remembered, and whether anything is new in it.
    cache: Arc<Mutex<(Cache, bool)>>,
    cancel: &'a AtomicBool,
    pub(crate) shares: Shares,
}

impl<'a> Hasher<'a> {
    /// Starts from the cache file. One that is missing or damaged only costs time.
    pub(crate) fn new(root: &'a Path, cache_file: PathBuf, cancel: &'a AtomicBool) -> Self {
        let cache = fs::read(&cache_file)
            .ok()
            .and_then(|bytes| serde_json::from_slice(&bytes).ok())
            .unwrap_or_default();
        Self {
            root,
            cache_file,
            cache: Arc::new(Mutex::new((cache, false))),
            cancel,
            shares: Shares::default(),
        }
    }

    /// For work in a place that nobody interrupts.
    pub(crate) fn of_place(place: &'a Place) -> Self {
        Self::new(&place.root, place.hash_cache(), &NEVER)
    }

    /// Believes nothing that was remembered before: reads every file, once.
    pub(crate) fn reading_all(root: &'a Path) -> Self {
        Self {
            root,
            cache_file: PathBuf::new(),
            cache: Arc::default(),
            cancel: &NEVER,
            shares: Shares::default(),
        }
    }

    /// The same without reading: what is not remembered counts as interrupted.
    pub(crate) fn remembering(&self) -> Hasher<'a> {
        static STOPPED: AtomicBool = AtomicBool::new(true);
        Hasher {
            root: self.root,
            cache_file: self.cache_file.clone(),
            cache: self.cache.clone(),
            cancel: &STOPPED,
            shares: self.shares.clone(),
        }
    }

    /// The content of a file (64 hexadecimal digits) or a directory (the same, and the
    /// number of files): names and contents of all files in it. `None` if nothing is there.
    pub(crate) fn content(&self, path: &str) -> Result<Option<String>, PipelineError> {
        let full = self.root.join(path);
        match fs::metadata(&full) {
            Ok(metadata) if metadata.is_dir() => self.listing(&list(&full, "")?).map(Some),
            Ok(metadata) => self.file(&full, &metadata).map(Some),
            Err(error)
                if matches!(
                    error.kind(),
                    std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory
                ) =>
            {
                Ok(None)
            }
            Err(error) => Err(PipelineError::io("read", full)(error)),
        }
    }

    /// The names of the files in a directory, below it and in order; the empty name for a
    /// file. `None` if nothing is there.
    pub(crate) fn names(&self, path: &str) -> Result<Option<Vec<String>>, PipelineError> {
        let full = self.root.join(path);
        if !full.is_dir() {
            let itself = full.symlink_metadata().is_ok();
            return Ok(itself.then(|| vec![String::new()]));
        }
        let mut names: Vec<String> = list(&full, "")?
            .into_iter()
            .map(|entry| entry.within.trim_start_matches('/').to_owned())
            .collect();
        names.sort();
        Ok(Some(names))
    }

    /// The content that a directory would have with only `files` in it, in order.
    pub(crate) fn content_of_some(
        &self,
        path: &str,
        files: &[String],
    ) -> Result<String, PipelineError> {
        let full = self.root.join(path);
        let mut entries = list(&full, "")?;
        let is_one = |name: &str| files.binary_search_by(|f| (**f).cmp(name)).is_ok();
        entries.retain(|entry| is_one(entry.within.trim_start_matches('/')));
        self.listing(&entries)
    }

    /// The files of an output, each below it (empty for a file by itself) and with its
    /// hash; `None` if there is anything else among them, such as a link.
    pub(crate) fn files(&self, path: &str) -> Result<Option<Vec<(String, String)>>, PipelineError> {
        let full = self.root.join(path);
        let metadata = fs::symlink_metadata(&full).map_err(PipelineError::io("read", &full))?;
        if metadata.is_file() {
            return Ok(Some(vec![(String::new(), self.file(&full, &metadata)?)]));
        }
        if !metadata.is_dir() {
            return Ok(None);
        }
        let mut files = Vec::new();
        for entry in list(&full, "")? {
            match entry.kind {
                FoundKind::File(full, metadata)
                    if metadata.is_file() && !full.is_symlink() && full.to_str().is_some() =>
                {
                    files.push((entry.within, self.file(&full, &metadata)?));
                }
                _ => return Ok(None),
            }
        }
        Ok(Some(files))
    }

    /// Writes the cache back if anything is new. Not being able to only costs time later.
    pub(crate) fn save(&self) {
        let Ok(mut guard) = self.cache.lock() else {
            return;
        };
        let (cache, dirty) = &mut *guard;
        if *dirty && let Ok(json) = serde_json::to_vec(cache) {
            *dirty = atomic_write_bytes(&self.cache_file, &json, Durability::Written).is_err();
        }
    }

    fn listing(&self, entries: &[Found]) -> Result<String, PipelineError> {
        let remembered = |entry: &Found| match &entry.kind {
            FoundKind::Link(target) => Some(target.clone()),
            FoundKind::File(full, metadata) => self.remembered(full, metadata),
        };
        let mut contents: Vec<Option<String>> = entries.iter().map(remembered).collect();
        // Only what must be read is worth several threads.
        contents
            .par_iter_mut()
            .zip(entries)
            .filter(|(content, _)| content.is_none())
            .try_for_each(|(content, entry)| {
                if let FoundKind::File(full, metadata) = &entry.kind {
                    *content = Some(self.file(full, metadata)?);
                }
                Ok(())
            })?;
        let mut listing = blake3::Hasher::new();
        for (entry, content) in entries.iter().zip(contents.iter().flatten()) {
            add_texts(&mut listing, [entry.within.as_str(), content.as_str()]);
        }
        let files = entries.len();
        let noun = if files == 1 { "file" } else { "files" };
        Ok(format!("{} in {files} {noun}", listing.finalize().to_hex()))
    }

    fn remembered(&self, full: &Path, metadata: &Metadata) -> Option<String> {
        if !metadata.is_file() {
            return Some("no regular file".to_owned()); // a pipe or a device has no content
        }
        let guard = self.cache.lock().ok()?;
        let (seen, hash) = guard.0.get(self.key(full)?)?;
        (*seen == Look::from_metadata(metadata)).then(|| hash.clone())
    }

    fn file(&self, full: &Path, metadata: &Metadata) -> Result<String, PipelineError> {
        if let Some(hash) = self.remembered(full, metadata) {
            return Ok(hash);
        }
        let look = Look::from_metadata(metadata);
        let settled = look.is_settled_at(SystemTime::now());
        let hash = self.read(full, look.size)?;
        if let (true, Some(key), Ok(mut guard)) = (settled, self.key(full), self.cache.lock()) {
            guard.0.insert(key.to_owned(), (look, hash.clone()));
            guard.1 = true;
        }
        Ok(hash)
    }

    fn key<'p>(&self, full: &'p Path) -> Option<&'p str> {
        full.strip_prefix(self.root).unwrap_or(full).to_str()
    }

    /// Hashes a block on all cores while the next one is read.
    fn read(&self, full: &Path, size: u64) -> Result<String, PipelineError> {
        if self.cancel.load(Ordering::Relaxed) {
            return Err(PipelineError::Interrupted);
        }
        let failed = || PipelineError::io("read", full);
        let mut file = File::open(full).map_err(failed())?;
        let mut hasher = blake3::Hasher::new();
        let block = size.clamp(1, BLOCK) as usize + 1; // one more, so that a small file ends in one read
        let mut ahead = vec![0; block];
        let mut filled = fill(&mut file, &mut ahead).map_err(failed())?;
        let mut current = Vec::new();
        while filled > 0 {
            if self.cancel.load(Ordering::Relaxed) {
                return Err(PipelineError::Interrupted);
            }
            std::mem::swap(&mut current, &mut ahead);
            let hashed = &current[..filled];
            if filled < block {
                if filled < WORTH_THREADS {
                    hasher.update(hashed);
                } else {
                    hasher.update_rayon(hashed);
                }
                break;
            }
            ahead.resize(block, 0);
            let (_, read) = rayon::join(
                || hasher.update_rayon(hashed).count(),
                || fill(&mut file, &mut ahead),
            );
            filled = read.map_err(failed())?;
        }
        Ok(hasher.finalize().to_hex().to_string())
    }
}

/// BLAKE3 of bytes, in hexadecimal.
pub(crate) fn hash_of(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// Adds texts to a hash, each with its length, so that none runs into the next.
pub(crate) fn add_texts<'t>(hasher: &mut blake3::Hasher, texts: impl IntoIterator<Item = &'t str>) {
    for text in texts {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    }
}

/// One entry of a directory, with its name below the directory.
struct Found {
    within: String,
    kind: FoundKind,
}

enum FoundKind {
    File(PathBuf, Metadata),
    /// A link to a directory or to nothing: where it points, not what is there, so that a
    /// link to a directory above it has an end.
    Link(String),
}

/// All files below `folder` in the order of their names, which begin with `prefix`.
fn list(folder: &Path, prefix: &str) -> Result<Vec<Found>, PipelineError> {
    let failed = || PipelineError::io("read the directory", folder);
    let entries = fs::read_dir(folder).map_err(failed())?;
    let mut names = Vec::new();
    for entry in entries {
        let entry = entry.map_err(failed())?;
        names.push((entry.file_name(), entry.file_type().map_err(failed())?));
    }
    names.sort_by(|a, b| a.0.cmp(&b.0));
    let mut files = Vec::new();
    for (name, kind) in names {
        let full = folder.join(&name);
        let Some(text) = name.to_str() else {
            return Err(PipelineError::NameNotText { path: full });
        };
        let within = format!("{prefix}/{text}");
        if kind.is_dir() {
            files.extend(list(&full, &within)?);
            continue;
        }
        let kind = match fs::metadata(&full) {
            Ok(metadata) if !metadata.is_dir() => FoundKind::File(full, metadata),
            _ => {
                let target = fs::read_link(&full).map_err(PipelineError::io("read", &full))?;
                FoundKind::Link(target.to_string_lossy().into_owned())
            }
        };
        files.push(Found { within, kind });
    }
    Ok(files)
}

/// Reads until the buffer is full or the file ends.
fn fill(file: &mut File, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match file.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(n) => filled += n,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}

impl Look {
    #[cfg(unix)]
    fn from_metadata(metadata: &Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        let ns = |seconds: i64, ns: i64| seconds.saturating_mul(1_000_000_000).saturating_add(ns);
        Self {
            size: metadata.len(),
            modified_ns: ns(metadata.mtime(), metadata.mtime_nsec()),
            changed_ns: ns(metadata.ctime(), metadata.ctime_nsec()),
            inode: metadata.ino(),
        }
    }

    /// Windows has no time of a change to what is known of a file, and no stable number of it here: when it was made stands for it.
    #[cfg(not(unix))]
    fn from_metadata(metadata: &Metadata) -> Self {
        let modified_ns = metadata.modified().map_or(i64::MAX, nanos_since_epoch);
        let made_ns = metadata.created().map_or(0, nanos_since_epoch);
        Self {
            size: metadata.len(),
            modified_ns,
            changed_ns: modified_ns,
            inode: made_ns.cast_unsigned(),
        }
    }

    /// A time in the future never counts as settled, so a wrong clock costs time only.
    fn is_settled_at(&self, now: SystemTime) -> bool {
        let last = self.modified_ns.max(self.changed_ns);
        nanos_since_epoch(now) > last.saturating_add(SETTLED_AFTER_NS)
    }
}

fn nanos_since_epoch(time: SystemTime) -> i64 {
    time.duration_since(UNIX_EPOCH).map_or(0, |since| {
        i64::try_from(since.as_nanos()).unwrap_or(i64::MAX)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(root: &Path, path: &str) -> Option<String> {
        let hasher = Hasher::new(root, root.join(".hashes"), &NEVER);
        hasher.content(path).unwrap()
    }

    #[test]
    fn a_directory_changes_with_names_and_contents_below_it() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::create_dir_all(root.join("d/e")).unwrap();
        fs::write(root.join("d/e/one"), "1").unwrap();
        let first = content(root, "d").unwrap();
        assert!(first.ends_with(" in 1 file"));
        fs::rename(root.join("d/e/one"), root.join("d/e/two")).unwrap();
        let renamed = content(root, "d").unwrap();
        fs::write(root.join("d/e/two"), "2").unwrap();
        let rewritten = content(root, "d").unwrap();
        assert!(first != renamed && renamed != rewritten);
        assert_eq!(content(root, "nothing"), None);
        assert_eq!(content(root, "d/e/two/below a file"), None);
    }

    #[test]
    fn a_remembered_hash_is_dropped_when_the_file_changes() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::write(root.join("f"), "one").unwrap();
        std::thread::sleep(std::time::Duration::from_millis(40));
        let hasher = Hasher::new(root, root.join(".hashes"), &NEVER);
        let one = hasher.content("f").unwrap();
        hasher.save();
        let cached: Cache =
            serde_json::from_slice(&fs::read(root.join(".hashes")).unwrap()).unwrap();
        assert_eq!(cached.keys().collect::<Vec<_>>(), ["f"]);
        assert_eq!(content(root, "f"), one);
        fs::write(root.join("f"), "two").unwrap();
        assert_ne!(content(root, "f"), one);
    }

    #[test]
    fn a_file_is_settled_some_ticks_after_its_last_change_and_never_in_the_future() {
        let at = |ns: i64| UNIX_EPOCH + std::time::Duration::from_nanos(ns.cast_unsigned());
        let ago = |modified_ns: i64, changed_ns: i64| Look {
            size: 1,
            modified_ns,
            changed_ns,
            inode: 1,
        };
        let last = 5_000_000_000;
        for look in [ago(last, last), ago(last, 1), ago(1, last)] {
            let settles = last + SETTLED_AFTER_NS;
            assert!(look.is_settled_at(at(settles + 1)));
            assert!(!look.is_settled_at(at(settles)));
            assert!(!look.is_settled_at(at(0)));
        }
        assert!(!ago(i64::MAX, 1).is_settled_at(at(i64::MAX - 1)));
    }

    #[test]
    fn a_file_that_has_just_changed_is_not_remembered() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        let path = root.join("f");
        fs::write(&path, "one").unwrap();
        // As if its clock were ahead.
        let ahead = SystemTime::now() + std::time::Duration::from_hours(1);
        File::options()
            .write(true)
            .open(&path)
            .unwrap()
            .set_modified(ahead)
            .unwrap();
        let hasher = Hasher::new(root, root.join(".hashes"), &NEVER);
        hasher.content("f").unwrap();
        hasher.save();
        assert!(!root.join(".hashes").exists());
    }

    #[test]
    fn a_damaged_cache_is_ignored() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::write(root.join("f"), "one").unwrap();
        fs::write(root.join(".hashes"), "{ not json").unwrap();
        assert_eq!(content(root, "f").unwrap().len(), 64);
    }

    #[test]
    fn a_hash_does_not_depend_on_the_blocks_in_which_a_file_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        let block = BLOCK as usize;
        for size in [
            0,
            1,
            WORTH_THREADS,
            block - 1,
            block,
            block + 1,
            2 * block + 3,
        ] {
            let bytes: Vec<u8> = (0..size).map(|i| (i * i / 7) as u8).collect();
            fs::write(root.join("f"), &bytes).unwrap();
            assert_eq!(content(root, "f"), Some(hash_of(&bytes)), "{size} bytes");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_directory_above_has_an_end() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::create_dir(root.join("d")).unwrap();
        std::os::unix::fs::symlink("../d", root.join("d/loop")).unwrap();
        assert!(content(root, "d").unwrap().ends_with(" in 1 file"));
    }
}
