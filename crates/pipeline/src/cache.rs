//! Outputs by what they were made from, in a directory that several people may share.
//!
//! `made/` holds a small file for each run of a stage, named by the hash of what it was made
//! from; `content/` holds files, each named by its own hash. Everything appears whole by a
//! rename, so that the directory may lie on a network and many may write to it at once.
//! What is taken out is hashed again: a damaged cache costs time and nothing else.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crate::content::{Hasher, add_texts, hash_of};
use crate::store::{Store, is_executable, make_executable};
use crate::{PipelineError, Stage};

/// The format of the directory.
const FORMAT: &str = "v1";

pub(crate) struct Cache {
    store: Store,
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
        let belongs = |file: &CachedFile| {
            stage.outputs.contains(&file.output) && within(&file.within) && is_hash(&file.content)
        };
        self.digest == digest
            && outputs == stage.outputs.iter().collect()
            && contents
            && self.files.iter().all(belongs)
    }
}

fn is_hash(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

/// How a run ended that is to be kept.
pub(crate) struct Ran<'a> {
    pub(crate) seconds: f64,
    pub(crate) peak_memory: Option<u64>,
    pub(crate) summary: Option<&'a str>,
}

impl Cache {
    /// Opens a cache in a folder.
    ///
    /// # Errors
    /// As [`Store::open`].
    pub(crate) fn open(place: &Path) -> Result<Self, PipelineError> {
        Ok(Self { store: Store::open(place)? })
    }

    /// The name of a run of `stage` that was made from what has `digest`.
    fn key(stage: &Stage, digest: &str) -> String {
        let mut hasher = blake3::Hasher::new();
        add_texts(&mut hasher, [digest]);
        add_texts(&mut hasher, stage.outputs.iter().map(String::as_str));
        hasher.finalize().to_hex().to_string()
    }

    fn made_of(stage: &Stage, digest: &str) -> String {
        let key = Self::key(stage, digest);
        format!("{FORMAT}/made/{}/{key}.json", &key[..2])
    }

    fn content_of(hash: &str) -> String {
        format!("{FORMAT}/content/{}/{hash}", hash.get(..2).unwrap_or(""))
    }

    /// What a run made before; nothing if it is not known or not readable.
    ///
    /// # Errors
    /// [`Damaged`] for an entry that is not this stage's own: it could write anywhere.
    pub(crate) fn find(&self, stage: &Stage, digest: &str) -> Result<Option<Made>, Damaged> {
        if stage.outputs.is_empty() {
            return Ok(None); // it is run for what it does
        }
        let Some(bytes) = self.store.read(&Self::made_of(stage, digest)) else {
            return Ok(None);
        };
        let cached: Made = serde_json::from_slice(&bytes).map_err(|_| Damaged)?;
        if !cached.is_of(stage, digest) {
            return Err(Damaged);
        }
        Ok((!stage.summary || cached.summary.is_some()).then_some(cached))
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
        if !self.store.fetch(&Self::content_of(&file.content), target)? {
            return Ok(false);
        }
        let hash = fs::read(target).map(|bytes| hash_of(&bytes));
        if hash.map_err(PipelineError::io("read", target))? != file.content {
            return Ok(false);
        }
        if file.executable {
            make_executable(target).map_err(PipelineError::io("write", target))?;
        }
        Ok(true)
    }

    /// Removes a damaged entry and those of its files that are not what their names say.
    fn throw_out(&self, stage: &Stage, digest: &str, made: &Made) {
        self.store.remove(&Self::made_of(stage, digest));
        for file in &made.files {
            let name = Self::content_of(&file.content);
            let bytes = self.store.read(&name);
            let hash = bytes.map(|bytes| hash_of(&bytes));
            if hash.is_some_and(|hash| hash != file.content) {
                self.store.remove(&name);
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
                self.store.send(&path, &Self::content_of(&content), executable)?;
                files.push(CachedFile { output: output.clone(), within, content, executable });
            }
        }
        let cached = Made {
            digest: digest.to_owned(),
            outputs: outputs.clone(),
            files,
            seconds: ran.seconds,
            peak_memory: ran.peak_memory,
            summary: ran.summary.map(str::to_owned),
        };
        let name = Self::made_of(stage, digest);
        let json = serde_json::to_vec(&cached);
        let json =
            json.map_err(|e| PipelineError::io("write", &self.store.path(&name))(e.into()))?;
        self.store.write(&name, &json)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn an_entry_is_of_a_run_that_made_just_these_outputs_within_them() {
        let pipeline = crate::testing::pipeline(&[("a", &[], &["out", "b.csv"])]);
        let stage = &pipeline.stages()[0];
        let hash = "0123456789abcdef".repeat(4);
        let made = || Made {
            digest: "d".to_owned(),
            outputs: BTreeMap::from([
                ("out".to_owned(), format!("{hash} in 2 files")),
                ("b.csv".to_owned(), hash.clone()),
            ]),
            files: vec![CachedFile {
                output: "out".to_owned(),
                within: "/x/y".to_owned(),
                content: hash.clone(),
                executable: false,
            }],
            seconds: 1.0,
            peak_memory: None,
            summary: None,
        };
        assert!(made().is_of(stage, "d"));
        assert!(!made().is_of(stage, "e"));
        let with = |change: &dyn Fn(&mut Made)| {
            let mut made = made();
            change(&mut made);
            made.is_of(stage, "d")
        };
        for within in ["", "/x", "/x/y.z", "/.x", "/..x"] {
            assert!(with(&|m| m.files[0].within = within.to_owned()), "{within}");
        }
        for within in ["x", "/", "//x", "/x/", "/../x", "/x/..", "/.", "/x/./y"] {
            assert!(!with(&|m| m.files[0].within = within.to_owned()), "{within}");
        }
        for content in [
            "",
            "0123",
            &hash[1..],
            &hash.to_uppercase(),
            &format!("{hash}0"),
            &hash.replace('f', "g"),
        ] {
            assert!(!with(&|m| m.files[0].content = content.to_owned()), "{content}");
            let in_output =
                |m: &mut Made| drop(m.outputs.insert("b.csv".to_owned(), content.to_owned()));
            assert!(!with(&in_output), "{content}");
        }
        assert!(!with(&|m| m.files[0].output = "c".to_owned()), "of another output");
        assert!(!with(&|m| drop(m.outputs.insert("c".to_owned(), hash.clone()))), "one too many");
        assert!(!with(&|m| drop(m.outputs.remove("b.csv"))), "one too few");
        let many = format!("{hash} in some files");
        assert!(!with(&|m| drop(m.outputs.insert("out".to_owned(), many.clone()))));
    }
}
