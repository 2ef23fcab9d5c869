//! Reading ledgers, of this version and of those before.

use std::collections::BTreeMap;
use std::path::Path;

use super::{FIRST_BY_OUTPUT, LEDGER_VERSION, Ledger, Left, Record};
use crate::content::hash_of;
use crate::{Manifest, PipelineError, Place, Row, journal};

/// A ledger with its journal, and what is needed to go on with them.
pub(crate) struct Loaded {
    pub(crate) ledger: Ledger,
    /// The hash of the ledger's bytes; `None` if there is no file.
    pub(super) hash: Option<String>,
    /// Whether this is more than the file says: by the journal, or by the root.
    pub(super) replayed: bool,
}

/// Reads the ledger of `pipeline` (of any, if `None`) and what a run noted that was killed.
pub(crate) fn load(path: &Path, pipeline: Option<&str>) -> Result<Loaded, PipelineError> {
    let (mut ledger, hash) = match std::fs::read(path) {
        Ok(bytes) => {
            let hash = hash_of(&bytes);
            (parse(path, bytes, pipeline)?, Some(hash))
        }
        Err(error) => match pipeline {
            Some(pipeline) if error.kind() == std::io::ErrorKind::NotFound => {
                (Ledger::empty(pipeline), None)
            }
            _ => return Err(PipelineError::io("read the ledger", path)(error)),
        },
    };
    let replayed = journal::replay(&journal::journal_of(path), hash.as_ref(), &mut ledger)?;
    Ok(Loaded {
        ledger,
        hash,
        replayed,
    })
}

/// As [`load`], of a pipeline that runs in `place`.
///
/// # Errors
/// Also [`PipelineError::OtherRoot`] if its runs were in another folder: what it says of a path there is not about the file here.
pub(crate) fn load_at(place: &Place, pipeline: &str) -> Result<Loaded, PipelineError> {
    let mut loaded = load(&place.ledger, Some(pipeline))?;
    let root = place.root_from_ledger();
    match loaded.ledger.root.replace(root.clone()) {
        Some(before) if before != root => Err(PipelineError::OtherRoot {
            ledger: place.ledger.clone(),
            before: place.folder_from_ledger(&before),
            root: place.root.clone(),
        }),
        before => {
            // Where the file does not say it, it is written anew.
            loaded.replayed |= before.is_none() && loaded.hash.is_some();
            Ok(loaded)
        }
    }
}

/// The part of a ledger that every version has had.
#[derive(serde::Deserialize)]
struct AnyVersion {
    version: u32,
}

fn parse(path: &Path, bytes: Vec<u8>, pipeline: Option<&str>) -> Result<Ledger, PipelineError> {
    let damaged = |message: String| PipelineError::LedgerDamaged {
        path: path.to_owned(),
        message,
    };
    let text = String::from_utf8(bytes).map_err(|_| damaged("it is not text".to_owned()))?;
    let damaged_at = |error: toml::de::Error| {
        let line = error.span().and_then(|span| text.get(..span.start));
        let line = line.map_or(1, |before| before.matches('\n').count() + 1);
        damaged(format!("line {line}: {}", error.message()))
    };
    let mut ledger = toml::from_str::<Ledger>(&text);
    if !matches!(&ledger, Ok(ledger) if ledger.version == LEDGER_VERSION) {
        let AnyVersion { version } = toml::from_str(&text).map_err(damaged_at)?;
        if version > LEDGER_VERSION {
            return Err(PipelineError::LedgerNewer {
                path: path.to_owned(),
                found: version,
                supported: LEDGER_VERSION,
            });
        }
        if version < FIRST_BY_OUTPUT {
            ledger = toml::from_str::<Old>(&text).map(Ledger::from);
        }
    }
    let ledger = ledger.map_err(damaged_at)?;
    if let Some(pipeline) = pipeline
        && ledger.pipeline != pipeline
    {
        return Err(damaged(format!(
            "it belongs to pipeline `{}`, not to `{pipeline}`",
            ledger.pipeline
        )));
    }
    let forged = |record: &&Record| record.digest != record.made_from.digest();
    match ledger.run.values().find(forged) {
        Some(record) => Err(damaged(format!(
            "the digest of stage `{}` is not that of its entries",
            record.stage
        ))),
        None => Ok(ledger),
    }
}

/// A ledger up to format 2, which was kept by stage.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Old {
    #[expect(dead_code, reason = "checked before")]
    version: u32,
    pipeline: String,
    #[serde(default)]
    unfinished: BTreeMap<String, Vec<String>>,
    #[serde(default)]
    stage: BTreeMap<String, OldRecord>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct OldRecord {
    digest: String,
    seconds: f64,
    peak_memory: Option<u64>,
    row: Option<Row>,
    #[serde(default)]
    set: BTreeMap<String, String>,
    made_from: Manifest,
    #[serde(default)]
    outputs: BTreeMap<String, String>,
}

impl From<Old> for Ledger {
    fn from(old: Old) -> Self {
        let mut ledger = Self::empty(&old.pipeline);
        for (stage, open) in old.unfinished {
            let key = crate::stage::key(&stage, &open);
            let left = Left {
                stage,
                open,
                files: BTreeMap::new(),
            };
            ledger.left.insert(key, left);
        }
        for (stage, record) in old.stage {
            let key = crate::stage::key(&stage, record.outputs.keys());
            let record = Record {
                stage,
                variant: None,
                digest: record.digest,
                seconds: record.seconds,
                peak_memory: record.peak_memory,
                row: record.row,
                set: record.set,
                made_from: record.made_from,
                outputs: record.outputs,
                files: BTreeMap::new(),
            };
            ledger.run.insert(key, record);
        }
        ledger
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Ledger, PipelineError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.lock");
        std::fs::write(&path, text).unwrap();
        Ledger::read(&path, "p")
    }

    #[test]
    fn a_damaged_ledger_is_an_error_that_says_what_to_do() {
        let good = "version = 3\npipeline = 'p'\n";
        for text in [
            "",
            "version = 3\npipe",
            "version = 3\npipeline = 'other'\n",
            "version = 2\npipeline = 'p'\nextra = 1\n",
            &format!("{good}extra = 1\n"),
            &format!(
                "{good}[run.a]\nstage = 'a'\ndigest = 'no'\nseconds = 1.0\n[run.a.made_from]\n"
            ),
        ] {
            let error = read(text).unwrap_err();
            assert!(
                matches!(error, PipelineError::LedgerDamaged { .. }),
                "{error}"
            );
            assert!(error.suggestion().unwrap().contains("delete it"));
        }
        for version in FIRST_BY_OUTPUT..=LEDGER_VERSION {
            let text = good.replace('3', &version.to_string());
            assert!(read(&text).is_ok(), "{text}");
        }
    }

    #[test]
    fn a_newer_ledger_is_refused_whatever_else_it_says() {
        let error = read("version = 5\nnovelty = true\n").unwrap_err();
        assert!(
            matches!(error, PipelineError::LedgerNewer { found: 5, .. }),
            "{error}"
        );
    }

    #[test]
    fn a_ledger_that_was_kept_by_stage_is_read() {
        let digest = Manifest::default().digest();
        let text = format!(
            "version = 2\npipeline = 'p'\n[unfinished]\nb = ['z', 'y']\n[stage.a]\n\
             digest = '{digest}'\nseconds = 1.0\n[stage.a.made_from]\n[stage.a.outputs]\n\
             'o/d' = '00 in 2 files'\n'o/f' = '11'\n[stage.c]\ndigest = '{digest}'\n\
             seconds = 1.0\n[stage.c.made_from]\n"
        );
        let ledger = read(&text).unwrap();
        assert_eq!(ledger.run.keys().collect::<Vec<_>>(), ["//c", "o/d"]);
        assert_eq!(ledger.run["o/d"].stage, "a");
        assert_eq!(ledger.left["y"].open, ["z", "y"]);
    }
}
