//! What a drive was made from.

use crate::{error::IngestError, settings::IngestSettings, source::Source};
use std::path::Path;

/// What a drive was made from: kept in the metadata of its file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Provenance {
    /// Key and value, in a stated order: `source` (file names), `source_blake3` (of their contents, one a file), `mapping`
    /// and `mapping_blake3` where there was one, `resampled_hz`, `max_gap_s`, `recover` and `program`.
    pub entries: Vec<(String, String)>,
}

impl Provenance {
    /// The provenance of a drive read from `sources` by `settings`; `mapping` is the file that they have theirs from.
    ///
    /// Names stand without their folders and times are left out: the same inputs give the same bytes anywhere.
    ///
    /// # Errors
    /// [`IngestError::NotFound`] and the like where the mapping cannot be read.
    pub fn of(
        sources: &[Source],
        mapping: Option<&Path>,
        settings: &IngestSettings,
    ) -> Result<Self, IngestError> {
        let joined = |text: fn(&Source) -> &str| {
            let texts: Vec<&str> = sources.iter().map(text).collect();
            texts.join(" ")
        };
        let mut entries = vec![
            ("source".to_owned(), joined(|s| &s.name)),
            ("source_blake3".to_owned(), joined(|s| &s.blake3)),
        ];
        if let Some(mapping) = mapping {
            let (_, mapping) = Source::read(mapping)?;
            entries.push(("mapping".to_owned(), mapping.name));
            entries.push(("mapping_blake3".to_owned(), mapping.blake3));
        }
        entries.push(("resampled_hz".to_owned(), settings.rate_hz()?.to_string()));
        entries.push(("max_gap_s".to_owned(), settings.max_gap_s()?.to_string()));
        entries.push(("recover".to_owned(), settings.recover.to_string()));
        let program = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
        entries.push(("program".to_owned(), program.to_owned()));
        Ok(Self { entries })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_file_has_the_same_provenance_in_another_folder() {
        let settings = IngestSettings::default();
        let of = |text: &str| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.csv");
            std::fs::write(&path, text).unwrap();
            let (bytes, source) = Source::read(&path).unwrap();
            assert_eq!(bytes, text.as_bytes());
            Provenance::of(&[source], None, &settings).unwrap()
        };
        assert_eq!(of("t\n1\n"), of("t\n1\n"));
        assert_ne!(of("t\n1\n"), of("t\n2\n"));
        let keys: Vec<String> = of("t\n").entries.into_iter().map(|e| e.0).collect();
        assert_eq!(keys[..3], ["source", "source_blake3", "resampled_hz"]);
    }
}
