//! Outputs by what they were made from, in a directory that several people may share.
//!
//! `made/` holds a small file for each run of a stage, named by the hash of what it was made
//! from; `content/` holds files, each named by its own hash. Everything appears whole by a
//! rename, so that the directory may lie on a network and many may write to it at once.
//! What is taken out is hashed again: a damaged cache costs time and nothing else.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::atomic_write::{self, Durability};
use crate::content::Hasher;
use crate::{PipelineError, Stage};

/// The format of the directory.
const FORMAT: &str = "v1";

pub(crate) struct Cache {
    folder: PathBuf,
}

/// What a run of a stage made.
#[derive(Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct Made {
    /// The hash of what it was made from.
    digest: String,
    /// Content of each output, as in the ledger.
    pub(crate) outputs: BTreeMap<String, String>,
    files: Vec<CachedFile>,
    pub(crate) seconds: f64,
    pub(crate) peak_memory: Option<u64>,
    /// Its standard output, if that belongs to the summary.
    pub(crate) summary: Option<String>,
}

#[derive(Debug, serde::Serialize, serde::Deserialize)]
struct CachedFile {
    output: String,
    /// Below the output, starting with `/`; empty if the output is the file.
    within: String,
    content: String,
    executable: bool,
}

/// An entry of the cache that is not what its name says.
#[derive(Debug)]
pub(crate) struct Damaged;

impl Made {
    /// Whether it is of this run and stays within the stage's outputs.
    fn is_of(&self, stage: &Stage, digest: &str) -> bool {
        let outputs = self.outputs.keys().collect::<BTreeSet<_>>();
        let contents = self.outputs.values().all(|content| {
            let (hash, files) = content.split_once(" in ").unwrap_or((content, "0 files"));
            let count = files.split(' ').next().unwrap_or_default();
            is_hash(hash) && count.parse::<u64>().is_ok()
        });
        let within = |within: &str| {
            let part = |part: &str| !matches!(part, "" | "." | "..");
            let parts = within.strip_prefix('/');
            within.is_empty() || parts.is_some_and(|parts| parts.split('/').all(part))
        };
        let own = |file: &CachedFile| {
            stage.outputs.contains(&file.output) && within(&file.within) && is_hash(&file.content)
        };
        self.digest == digest
            && outputs == stage.outputs.iter().collect()
            && contents
            && self.files.iter().all(own)
    }
}

fn is_hash(text: &str) -> bool {
    text.len() == 64
        && text
            .bytes()
            .all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

/// How a run ended that is to be kept.
pub(crate) struct Ran<'a> {
    pub(crate) seconds: f64,
    pub(crate) peak_memory: Option<u64>,
    pub(crate) summary: Option<&'a str>,
}

impl Cache {
    pub(crate) fn new(folder: &Path) -> Self {
        let folder = folder.join(FORMAT);
        Self { folder }
    }

    /// The name of a run of `stage` that was made from what has `digest`.
    fn key(stage: &Stage, digest: &str) -> String {
        let mut hasher = blake3::Hasher::new();
        for part in std::iter::once(digest).chain(stage.outputs.iter().map(String::as_str)) {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part.as_bytes());
        }
        hasher.finalize().to_hex().to_string()
    }

    fn made_of(&self, stage: &Stage, digest: &str) -> PathBuf {
        let key = Self::key(stage, digest);
        self.folder
            .join("made")
            .join(&key[..2])
            .join(format!("{key}.json"))
    }

    fn content_of(&self, hash: &str) -> PathBuf {
        let start = hash.get(..2).unwrap_or("");
        self.folder.join("content").join(start).join(hash)
    }

    /// What a run made before; nothing if it is not known or not readable.
    ///
    /// # Errors
    /// [`Damaged`] for an entry that is not this stage's own: it could write anywhere.
    pub(crate) fn find(&self, stage: &Stage, digest: &str) -> Result<Option<Made>, Damaged> {
        if stage.outputs.is_empty() {
            return Ok(None); // it is run for what it does
        }
        let Ok(bytes) = fs::read(self.made_of(stage, digest)) else {
            return Ok(None);
        };
        let made: Made = serde_json::from_slice(&bytes).map_err(|_| Damaged)?;
        if !made.is_of(stage, digest) {
            return Err(Damaged);
        }
        Ok((!stage.summary || made.summary.is_some()).then_some(made))
    }

    /// Brings the outputs, for which there is room, as they were; `false` if what is in the
    /// cache is damaged, which is then thrown out.
    pub(crate) fn restore(
        &self,
        stage: &Stage,
        digest: &str,
        made: &Made,
        root: &Path,
        hasher: &Hasher<'_>,
    ) -> Result<bool, PipelineError> {
        for output in &stage.outputs {
            let target = root.join(output);
            if made.outputs[output].contains(" in ") {
                fs::create_dir_all(&target).map_err(PipelineError::io("create", &target))?;
            }
        }
        let mut whole = true;
        for file in &made.files {
            let target = root.join(format!("{}{}", file.output, file.within));
            whole = whole && self.restore_file(file, &target)?;
        }
        for output in &stage.outputs {
            whole = whole && hasher.content(output)?.as_ref() == made.outputs.get(output);
        }
        if !whole {
            self.throw_out(stage, digest, made);
        }
        Ok(whole)
    }

    fn restore_file(&self, file: &CachedFile, target: &Path) -> Result<bool, PipelineError> {
        if let Some(folder) = target.parent() {
            fs::create_dir_all(folder).map_err(PipelineError::io("create", folder))?;
        }
        if let Err(error) = fs::copy(self.content_of(&file.content), target) {
            return match error.kind() {
                std::io::ErrorKind::NotFound => Ok(false),
                _ => Err(PipelineError::io("write", target)(error)),
            };
        }
        let hash = fs::read(target).map(|bytes| blake3::hash(&bytes).to_hex().to_string());
        if hash.map_err(PipelineError::io("read", target))? != file.content {
            return Ok(false);
        }
        set_mode(target, file.executable).map_err(PipelineError::io("write", target))?;
        Ok(true)
    }

    /// Removes a damaged entry and those of its files that are not what their names say.
    fn throw_out(&self, stage: &Stage, digest: &str, made: &Made) {
        let _ = fs::remove_file(self.made_of(stage, digest));
        for file in &made.files {
            let path = self.content_of(&file.content);
            let hash = fs::read(&path).map(|bytes| blake3::hash(&bytes).to_hex().to_string());
            if hash.is_ok_and(|hash| hash != file.content) {
                let _ = fs::remove_file(path);
            }
        }
    }

    /// Keeps what a stage has just made. Directories with links in them are not kept.
    pub(crate) fn keep(
        &self,
        stage: &Stage,
        digest: &str,
        outputs: &BTreeMap<String, String>,
        ran: &Ran<'_>,
        root: &Path,
        hasher: &Hasher<'_>,
    ) -> Result<(), PipelineError> {
        if stage.outputs.is_empty() {
            return Ok(());
        }
        let mut files = Vec::new();
        for output in &stage.outputs {
            let Some(found) = hasher.files(output)? else {
                return Ok(());
            };
            for (within, content) in found {
                let path = root.join(format!("{output}{within}"));
                let executable = is_executable(&path);
                self.keep_file(&path, &content, executable)?;
                files.push(CachedFile {
                    output: output.clone(),
                    within,
                    content,
                    executable,
                });
            }
        }
        let made = Made {
            digest: digest.to_owned(),
            outputs: outputs.clone(),
            files,
            seconds: ran.seconds,
            peak_memory: ran.peak_memory,
            summary: ran.summary.map(str::to_owned),
        };
        let path = self.made_of(stage, digest);
        let json = serde_json::to_vec(&made);
        let json = json.map_err(|e| PipelineError::io("write", &path)(e.into()))?;
        atomic_write::write(&path, &json, Durability::Written)
    }

    fn keep_file(&self, from: &Path, hash: &str, executable: bool) -> Result<(), PipelineError> {
        let target = self.content_of(hash);
        if target.exists() {
            return Ok(());
        }
        let failed = || PipelineError::io("write into the cache", &target);
        let folder = target.parent().unwrap_or(&self.folder);
        fs::create_dir_all(folder).map_err(failed())?;
        let beside = tempfile::Builder::new()
            .prefix(".writing-")
            .tempfile_in(folder)
            .map_err(failed())?
            .into_temp_path();
        fs::copy(from, &beside).map_err(failed())?;
        set_mode(&beside, executable).map_err(failed())?;
        beside.persist(&target).map_err(|e| failed()(e.error))
    }
}

#[cfg(unix)]
fn is_executable(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    fs::metadata(path).is_ok_and(|metadata| metadata.permissions().mode() & 0o100 != 0)
}

#[cfg(not(unix))]
fn is_executable(_path: &Path) -> bool {
    false
}

/// Copies take over the mode of what is copied: a cache for all must be readable for all.
#[cfg(unix)]
fn set_mode(path: &Path, executable: bool) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let mode = if executable { 0o755 } else { 0o644 };
    fs::set_permissions(path, fs::Permissions::from_mode(mode))
}

#[cfg(not(unix))]
fn set_mode(_path: &Path, _executable: bool) -> std::io::Result<()> {
    Ok(())
}
