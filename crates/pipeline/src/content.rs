//! Hashes of files and directories, remembered as long as a file looks untouched.

use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use crate::PipelineError;
use crate::atomic_write::{self, Durability};

/// File systems stamp times in ticks of up to 10 ms: a file changed this lately could
/// change again without looking changed, so its hash is not remembered.
const SETTLED_AFTER_NS: i64 = 25_000_000;

/// What tells an untouched file: if all of it is the same, the content is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
struct Look {
    size: u64,
    modified_ns: i64,
    /// Of the file's record: also moves when a copy keeps the time of its original.
    changed_ns: i64,
    inode: u64,
}

#[derive(Debug, Default, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
struct Cache(BTreeMap<String, (Look, String)>);

/// Hashes contents below a root; shared by all workers of a run.
pub(crate) struct Hasher<'a> {
    root: &'a Path,
    cache_file: PathBuf,
    cache: Mutex<(Cache, bool)>,
    cancel: &'a AtomicBool,
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
            cache: Mutex::new((cache, false)),
            cancel,
        }
    }

    /// The content of a file (64 hexadecimal digits) or a directory (the same, and the
    /// number of files): names and contents of all files in it. `None` if nothing is there.
    pub(crate) fn content(&self, path: &str) -> Result<Option<String>, PipelineError> {
        let full = self.root.join(path);
        match fs::metadata(&full) {
            Ok(metadata) if metadata.is_dir() => self.directory(&full).map(Some),
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

    /// Writes the cache back if anything is new. Not being able to only costs time later.
    pub(crate) fn save(&self) {
        let Ok(mut guard) = self.cache.lock() else {
            return;
        };
        let (cache, dirty) = &mut *guard;
        if *dirty && let Ok(json) = serde_json::to_vec(cache) {
            *dirty = atomic_write::write(&self.cache_file, &json, Durability::Written).is_err();
        }
    }

    fn directory(&self, full: &Path) -> Result<String, PipelineError> {
        let mut listing = blake3::Hasher::new();
        let files = self.list(full, "", &mut listing)?;
        let noun = if files == 1 { "file" } else { "files" };
        Ok(format!("{} in {files} {noun}", listing.finalize().to_hex()))
    }

    /// Adds all files below `folder` to the listing in the order of their names.
    fn list(
        &self,
        folder: &Path,
        prefix: &str,
        listing: &mut blake3::Hasher,
    ) -> Result<usize, PipelineError> {
        let failed = || PipelineError::io("read the directory", folder);
        let entries = fs::read_dir(folder).map_err(failed())?;
        let mut names = Vec::new();
        for entry in entries {
            names.push(entry.map_err(failed())?.file_name());
        }
        names.sort();
        let mut files = 0;
        for name in names {
            let full = folder.join(&name);
            let within = format!("{prefix}/{}", name.to_string_lossy());
            let reading = || PipelineError::io("read", &full);
            let link = fs::symlink_metadata(&full).map_err(reading())?;
            let target = fs::metadata(&full);
            let content = if link.is_dir() {
                files += self.list(&full, &within, listing)?;
                continue;
            } else if let Ok(metadata) = &target
                && !metadata.is_dir()
            {
                self.file(&full, metadata)?
            } else {
                // A link to a directory or to nothing: where it points, not what is there,
                // so that a link to a directory above it has an end.
                let target = fs::read_link(&full).map_err(reading())?;
                target.to_string_lossy().into_owned()
            };
            for part in [&within, &content] {
                listing.update(&(part.len() as u64).to_le_bytes());
                listing.update(part.as_bytes());
            }
            files += 1;
        }
        Ok(files)
    }

    fn file(&self, full: &Path, metadata: &Metadata) -> Result<String, PipelineError> {
        if !metadata.is_file() {
            return Ok("no regular file".to_owned()); // a pipe or a device has no content
        }
        let look = Look::of(metadata);
        let key = full.strip_prefix(self.root).unwrap_or(full).to_str();
        if let (Some(key), Ok(guard)) = (key, self.cache.lock())
            && let Some((seen, hash)) = guard.0.0.get(key)
            && *seen == look
        {
            return Ok(hash.clone());
        }
        let settled = look.is_settled_at(SystemTime::now());
        let hash = self.read(full)?;
        if let (true, Some(key), Ok(mut guard)) = (settled, key, self.cache.lock()) {
            guard.0.0.insert(key.to_owned(), (look, hash.clone()));
            guard.1 = true;
        }
        Ok(hash)
    }

    fn read(&self, full: &Path) -> Result<String, PipelineError> {
        let failed = || PipelineError::io("read", full);
        let mut file = File::open(full).map_err(failed())?;
        let mut hasher = blake3::Hasher::new();
        let mut buffer = vec![0; 256 * 1024];
        loop {
            if self.cancel.load(Ordering::Relaxed) {
                return Err(PipelineError::Interrupted);
            }
            match file.read(&mut buffer) {
                Ok(0) => return Ok(hasher.finalize().to_hex().to_string()),
                Ok(n) => hasher.update(&buffer[..n]),
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(failed()(error)),
            };
        }
    }
}

impl Look {
    #[cfg(unix)]
    fn of(metadata: &Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        let ns = |seconds: i64, ns: i64| seconds.saturating_mul(1_000_000_000).saturating_add(ns);
        Self {
            size: metadata.len(),
            modified_ns: ns(metadata.mtime(), metadata.mtime_nsec()),
            changed_ns: ns(metadata.ctime(), metadata.ctime_nsec()),
            inode: metadata.ino(),
        }
    }

    #[cfg(not(unix))]
    fn of(metadata: &Metadata) -> Self {
        let modified_ns = metadata.modified().map_or(i64::MAX, nanos_since_epoch);
        Self {
            size: metadata.len(),
            modified_ns,
            changed_ns: modified_ns,
            inode: 0,
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

    static NO: AtomicBool = AtomicBool::new(false);

    fn content(root: &Path, path: &str) -> Option<String> {
        let hasher = Hasher::new(root, root.join(".hashes"), &NO);
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
        let hasher = Hasher::new(root, root.join(".hashes"), &NO);
        let one = hasher.content("f").unwrap();
        hasher.save();
        let cached: Cache =
            serde_json::from_slice(&fs::read(root.join(".hashes")).unwrap()).unwrap();
        assert_eq!(cached.0.keys().collect::<Vec<_>>(), ["f"]);
        assert_eq!(content(root, "f"), one);
        fs::write(root.join("f"), "two").unwrap();
        assert_ne!(content(root, "f"), one);
    }

    #[test]
    fn a_damaged_cache_is_ignored() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::write(root.join("f"), "one").unwrap();
        fs::write(root.join(".hashes"), "{ not json").unwrap();
        assert_eq!(content(root, "f").unwrap().len(), 64);
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
