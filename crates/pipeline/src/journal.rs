//! What happened since the ledger was last written, a line an event.
//!
//! Writing the whole ledger after each stage would cost more than a short stage. Appending
//! a line does not, and a line that a killed run left half-written is known by its hash.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::PipelineError;
use crate::content::hash_of;
use crate::ledger::{LEDGER_VERSION, Ledger, Record};

/// Digits of a line's hash.
const HASH_DIGITS: usize = 16;

/// One event.
#[derive(Debug, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Entry {
    /// The first line: what the rest adds to.
    Onto {
        version: u32,
        pipeline: String,
        /// The hash of the ledger's bytes; `None` if there was no ledger.
        ledger: Option<String>,
    },
    /// A stage is about to run, so what its outputs are is not known.
    Begun {
        key: String,
        stage: String,
        outputs: Vec<String>,
        /// Other runs that had made something in these outputs.
        from: Vec<String>,
    },
    /// A stage has run well.
    Finished { key: String, record: Box<Record> },
    /// A stage did not end well and left these files in its outputs.
    Left { key: String, files: BTreeMap<String, Vec<String>> },
    /// The outputs of a run were removed.
    Forgotten { key: String },
}

impl Entry {
    /// Does to the ledger what happened.
    pub(crate) fn apply(self, ledger: &mut Ledger) {
        match self {
            Self::Onto { .. } => {}
            Self::Begun { key, stage, outputs, from } => {
                ledger.begin(&key, &stage, &outputs, &from);
            }
            Self::Finished { key, record } => {
                ledger.left.remove(&key);
                ledger.run.insert(key, *record);
            }
            Self::Left { key, files } => {
                if let Some(left) = ledger.left.get_mut(&key) {
                    left.open.clear();
                    left.files = files;
                }
            }
            Self::Forgotten { key } => ledger.forget(&key),
        }
    }
}

/// The journal of the run that holds the lock.
#[derive(Debug)]
pub(crate) struct Journal {
    path: PathBuf,
    file: File,
    /// A write failed: what would follow a half line could not be read.
    broken: bool,
}

impl Journal {
    /// Starts a journal in the place of any that is there.
    pub(crate) fn create(
        path: &Path,
        pipeline: &str,
        ledger: Option<String>,
    ) -> Result<Self, PipelineError> {
        let failed = || PipelineError::io("write", path);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(failed())?;
        }
        let mut journal = Self {
            path: path.to_owned(),
            file: File::create(path).map_err(failed())?,
            broken: false,
        };
        journal.append(&Entry::Onto {
            version: LEDGER_VERSION,
            pipeline: pipeline.to_owned(),
            ledger,
        })?;
        Ok(journal)
    }

    /// Adds a line, which outlives the death of this process from then on.
    pub(crate) fn append(&mut self, entry: &Entry) -> Result<(), PipelineError> {
        let failed = || PipelineError::io("write", &self.path);
        if self.broken {
            return Err(failed()(std::io::Error::other("an earlier line could not be written")));
        }
        let json = serde_json::to_string(entry).map_err(|e| failed()(e.into()))?;
        let line = format!("{} {json}\n", line_hash(&json));
        self.file.write_all(line.as_bytes()).map_err(|error| {
            self.broken = true;
            PipelineError::io("write", &self.path)(error)
        })
    }
}

/// Adds to `ledger`, whose bytes have the hash `hash`, what a run noted that did not come
/// to write the ledger itself; says whether there was anything.
///
/// A journal of another ledger counts for nothing: whoever deleted or restored the ledger
/// meant all of it. So does everything from the first damaged line on: those stages run
/// again.
pub(crate) fn replay(
    path: &Path,
    hash: Option<&String>,
    ledger: &mut Ledger,
) -> Result<bool, PipelineError> {
    if !fs::metadata(path).is_ok_and(|metadata| metadata.is_file()) {
        return Ok(false);
    }
    let bytes = fs::read(path).map_err(PipelineError::io("read", path))?;
    let text = String::from_utf8_lossy(&bytes);
    let mut entries = text.split_inclusive('\n').map_while(entry_in);
    match entries.next() {
        Some(Entry::Onto { version, pipeline, ledger: onto })
            if version == LEDGER_VERSION
                && pipeline == ledger.pipeline
                && onto.as_ref() == hash => {}
        _ => return Ok(false),
    }
    let mut any = false;
    for entry in entries {
        entry.apply(ledger);
        any = true;
    }
    Ok(any)
}

fn entry_in(line: &str) -> Option<Entry> {
    let (hash, json) = line.strip_suffix('\n')?.split_once(' ')?;
    (hash == line_hash(json)).then(|| serde_json::from_str(json).ok())?
}

fn line_hash(json: &str) -> String {
    let mut hash = hash_of(json.as_bytes());
    hash.truncate(HASH_DIGITS);
    hash
}

pub(crate) fn journal_of(ledger: &Path) -> PathBuf {
    let mut name = ledger.as_os_str().to_owned();
    name.push(".journal");
    PathBuf::from(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn begun(stage: &str) -> Entry {
        Entry::Begun {
            key: format!("é/{stage}.txt"),
            stage: stage.to_owned(),
            outputs: vec![format!("é/{stage}.txt")],
            from: Vec::new(),
        }
    }

    fn replayed(path: &Path, hash: Option<&str>) -> Vec<String> {
        let mut ledger = Ledger::empty("p");
        replay(path, hash.map(str::to_owned).as_ref(), &mut ledger).unwrap();
        ledger.left.into_values().map(|left| left.stage).collect()
    }

    proptest! {
        #[test]
        fn of_a_journal_cut_anywhere_the_whole_lines_count(cut in 0_usize..400) {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("j");
            let mut journal = Journal::create(&path, "p", None).unwrap();
            let mut ends = vec![fs::metadata(&path).unwrap().len()];
            for stage in ["a", "b", "c"] {
                journal.append(&begun(stage)).unwrap();
                ends.push(fs::metadata(&path).unwrap().len());
            }
            let bytes = fs::read(&path).unwrap();
            let cut = cut.min(bytes.len());
            fs::write(&path, &bytes[..cut]).unwrap();
            let whole = ends.iter().filter(|&&end| end <= cut as u64).count();
            prop_assert_eq!(replayed(&path, None).len(), whole.saturating_sub(1));
        }
    }

    #[test]
    fn a_journal_of_another_ledger_counts_for_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("j");
        let mut journal = Journal::create(&path, "p", Some("00".to_owned())).unwrap();
        journal.append(&begun("a")).unwrap();
        assert_eq!(replayed(&path, Some("00")), ["a"]);
        assert_eq!(replayed(&path, None), [""; 0]);
        assert_eq!(replayed(&path, Some("11")), [""; 0]);
    }

    #[test]
    fn nothing_after_a_damaged_line_counts() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("j");
        let mut journal = Journal::create(&path, "p", None).unwrap();
        for stage in ["a", "b", "c"] {
            journal.append(&begun(stage)).unwrap();
        }
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, text.replace("\"b\"", "\"x\"")).unwrap();
        assert_eq!(replayed(&path, None), ["a"]);
    }
}
