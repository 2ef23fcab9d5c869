//! Reading ledgers.

use std::path::Path;

use super::{LEDGER_VERSION, Ledger, Record};
use crate::content::hash_of;
use crate::{PipelineError, Place, journal};

/// A ledger with its journal, and what is needed to go on with them.
pub(crate) struct Loaded {
    pub(crate) ledger: Ledger,
    /// The hash of the ledger's bytes; `None` if there is no file.
    pub(super) hash: Option<String>,
    /// Whether this is more than the file says: by the journal.
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
    Ok(Loaded { ledger, hash, replayed })
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
        _ => Ok(loaded),
    }
}

/// The part of a ledger that every format has.
#[derive(serde::Deserialize)]
struct AnyVersion {
    version: u32,
}

fn parse(path: &Path, bytes: Vec<u8>, pipeline: Option<&str>) -> Result<Ledger, PipelineError> {
    let damaged = |message: String| PipelineError::LedgerDamaged { path: path.to_owned(), message };
    let text = String::from_utf8(bytes).map_err(|_| damaged("it is not text".to_owned()))?;
    let damaged_at = |error: toml::de::Error| {
        let line = error.span().and_then(|span| text.get(..span.start));
        let line = line.map_or(1, |before| before.matches('\n').count() + 1);
        damaged(format!("line {line}: {}", error.message()))
    };
    let ledger = toml::from_str::<Ledger>(&text);
    if !matches!(&ledger, Ok(ledger) if ledger.version == LEDGER_VERSION) {
        let AnyVersion { version } = toml::from_str(&text).map_err(damaged_at)?;
        if version != LEDGER_VERSION {
            return Err(PipelineError::LedgerFormat {
                path: path.to_owned(),
                found: version,
                supported: LEDGER_VERSION,
            });
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
        let good = "version = 4\npipeline = 'p'\n";
        for text in [
            "",
            "version = 4\npipe",
            "version = 4\npipeline = 'other'\n",
            "version = 4\npipeline = 'p'\nextra = 1\n",
            &format!("{good}extra = 1\n"),
            &format!(
                "{good}[run.a]\nstage = 'a'\ndigest = 'no'\nseconds = 1.0\n[run.a.made_from]\n"
            ),
        ] {
            let error = read(text).unwrap_err();
            assert!(matches!(error, PipelineError::LedgerDamaged { .. }), "{error}");
            assert!(error.suggestion().unwrap().contains("delete it"));
        }
        assert!(read(good).is_ok());
    }

    #[test]
    fn a_ledger_of_another_format_is_refused_whatever_else_it_says() {
        for (version, help) in [(5, "use the newer program, or delete "), (3, "delete ")] {
            let text = format!("version = {version}\nnovelty = true\n");
            let error = read(&text).unwrap_err();
            let said = format!("p.lock has format {version}; this program knows format 4");
            assert!(error.to_string().contains(&said), "{error}");
            assert!(error.suggestion().unwrap().starts_with(help), "{error:?}");
        }
    }
}
