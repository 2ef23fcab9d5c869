//! Hashes of files and directories, remembered as long as a file looks untouched.

use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::SystemTime;

use rayon::prelude::*;

use crate::atomic_write::{Durability, atomic_write_bytes};
use crate::look::{Look, SECOND_NS};
use crate::shares::Shares;
use crate::{PipelineError, Place};

/// How much of a file is read at a time.
const BLOCK: u64 = 4 << 20;
/// From this size on, a file is hashed on several threads.
const WORTH_THREADS: usize = 256 << 10;

/// The flag of work that nobody interrupts.
static NEVER: AtomicBool = AtomicBool::new(false);

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
    ///
    /// A link to a directory in it counts by where it points: nothing behind it is an output.
    pub(crate) fn content(&self, path: &str) -> Result<Option<String>, PipelineError> {
        self.content_by(path, |folder| list(folder, "", None))
    }

    /// The same of an input, which goes on behind links to directories: a stage reads what is there.
    pub(crate) fn input(&self, path: &str) -> Result<Option<String>, PipelineError> {
        self.content_by(path, |folder| {
            let mut files = list(folder, "", Some(&[]))?;
            // What Python keeps of the scripts that it ran is no source.
            files.retain(|file| !file.within.split('/').any(|part| part == "__pycache__"));
            Ok(files)
        })
    }

    fn content_by(
        &self,
        path: &str,
        list: impl FnOnce(&Path) -> Result<Vec<Found>, PipelineError>,
    ) -> Result<Option<String>, PipelineError> {
        let full = self.root.join(path);
        match fs::metadata(&full) {
            Ok(metadata) if metadata.is_dir() => self.listing(&list(&full)?).map(Some),
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
        let mut names: Vec<String> = list(&full, "", None)?
            .into_iter()
            .map(|entry| entry.within.trim_start_matches('/').to_owned())
            .collect();
        names.sort();
        Ok(Some(names))
    }

    /// The same of each of `paths` where anything is.
    pub(crate) fn names_in<'p>(
        &self,
        paths: impl IntoIterator<Item = &'p String>,
    ) -> Result<BTreeMap<String, Vec<String>>, PipelineError> {
        let mut files = BTreeMap::new();
        for path in paths {
            if let Some(names) = self.names(path)? {
                files.insert(path.clone(), names);
            }
        }
        Ok(files)
    }

    /// The content that a directory would have with only `files` in it, in order.
    pub(crate) fn content_of_some(
        &self,
        path: &str,
        files: &[String],
    ) -> Result<String, PipelineError> {
        let full = self.root.join(path);
        let mut entries = list(&full, "", None)?;
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
        for entry in list(&full, "", None)? {
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

    /// Of each file of an output, links in it left out, its size and the second of its last change.
    pub(crate) fn stamps(&self, path: &str) -> Result<Vec<(u64, i64)>, PipelineError> {
        let full = self.root.join(path);
        let stamp = |metadata: &Metadata| {
            let look = Look::from_metadata(metadata);
            (look.size, look.modified_ns.div_euclid(SECOND_NS))
        };
        if !full.is_dir() {
            let metadata = fs::metadata(&full).ok();
            let metadata = metadata.filter(Metadata::is_file);
            return Ok(metadata.iter().map(stamp).collect());
        }
        let stamp_of = |found: &Found| match &found.kind {
            FoundKind::File(full, metadata) if metadata.is_file() && !full.is_symlink() => {
                Some(stamp(metadata))
            }
            _ => None,
        };
        Ok(list(&full, "", None)?.iter().filter_map(stamp_of).collect())
    }

    /// Of the files in an input folder the one that changed last.
    pub(crate) fn newest(&self, folder: &str) -> Result<Option<String>, PipelineError> {
        let files = list(&self.root.join(folder), "", Some(&[]))?;
        let changed = |found: &Found| match &found.kind {
            FoundKind::File(_, metadata) => Some(Look::from_metadata(metadata).changed_ns),
            FoundKind::Link(_) => None,
        };
        let newest = files.iter().max_by_key(|found| changed(found));
        Ok(newest.map(|found| format!("{folder}{}", found.within)))
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
            let (_, read) =
                rayon::join(|| hasher.update_rayon(hashed).count(), || fill(&mut file, &mut ahead));
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
    /// A link to a directory that is not followed, or to nothing: where it points.
    Link(String),
}

/// All files below `folder` in the order of their names, which begin with `prefix`. Links to directories are followed where the
/// real paths of the `followed` so far are given; one to a directory above has an end there.
fn list(
    folder: &Path,
    prefix: &str,
    followed: Option<&[PathBuf]>,
) -> Result<Vec<Found>, PipelineError> {
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
            files.extend(list(&full, &within, followed)?);
            continue;
        }
        if let Some(followed) = followed
            && let Some(followed) = followed_by(folder, &full, followed)?
        {
            files.extend(list(&full, &within, Some(&followed))?);
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

/// The real paths above what a link in `folder` leads to; `None` if it leads to no directory, or to one of those.
fn followed_by(
    folder: &Path,
    link: &Path,
    followed: &[PathBuf],
) -> Result<Option<Vec<PathBuf>>, PipelineError> {
    if !link.is_symlink() || !link.is_dir() {
        return Ok(None);
    }
    let real = |path: &Path| fs::canonicalize(path).map_err(PipelineError::io("read", path));
    let target = real(link)?;
    let mut above = followed.to_vec();
    above.push(real(folder)?);
    let is_loop = above.iter().any(|path| path.starts_with(&target));
    Ok((!is_loop).then_some(above))
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

#[cfg(test)]
mod tests;
