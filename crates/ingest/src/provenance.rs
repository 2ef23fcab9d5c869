//! What a drive was made from.

use crate::{error::IngestError, settings::IngestSettings};
use maveric_bag::parts_of;
use std::{
    fs::File,
    path::{Path, PathBuf},
};

/// What a drive was made from: kept in the metadata of its file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Provenance {
    /// Key and value, in a stated order: `source` (file names), `source_blake3` (of their contents, one a file), `mapping`
    /// and `mapping_blake3` where there was one, `resampled_hz`, `max_gap_s`, `recover` and `program`.
    pub entries: Vec<(String, String)>,
}

impl Provenance {
    /// The provenance of drives read from `log` by `settings`; `mapping` is the file that they have theirs from.
    ///
    /// Names stand without their folders and times are left out: the same inputs give the same bytes anywhere.
    ///
    /// # Errors
    /// [`IngestError::NotFound`] and the like where a file cannot be read.
    pub fn of(
        log: &Path,
        mapping: Option<&Path>,
        settings: &IngestSettings,
    ) -> Result<Self, IngestError> {
        let name = |p: &Path| {
            let name = p.file_name().unwrap_or_default();
            name.to_string_lossy().into_owned()
        };
        let signals = settings
            .mapping
            .as_ref()
            .and_then(|m| m.table.as_ref()?.signals.as_ref());
        let sources: Vec<PathBuf> = match signals {
            Some(signals) if log.is_dir() => {
                signals.files().into_iter().map(|f| log.join(f)).collect()
            }
            _ => parts_of(log)?.files,
        };
        let hashes: Vec<String> = sources.iter().map(|p| hash(p)).collect::<Result<_, _>>()?;
        let names: Vec<String> = sources.iter().map(|p| name(p)).collect();
        let mut entries = vec![
            ("source".to_owned(), names.join(" ")),
            ("source_blake3".to_owned(), hashes.join(" ")),
        ];
        if let Some(mapping) = mapping {
            entries.push(("mapping".to_owned(), name(mapping)));
            entries.push(("mapping_blake3".to_owned(), hash(mapping)?));
        }
        entries.push(("resampled_hz".to_owned(), settings.rate_hz()?.to_string()));
        entries.push(("max_gap_s".to_owned(), settings.max_gap_s.to_string()));
        entries.push(("recover".to_owned(), settings.recover.to_string()));
        let program = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
        entries.push(("program".to_owned(), program.to_owned()));
        Ok(Self { entries })
    }
}

fn hash(path: &Path) -> Result<String, IngestError> {
    let wrong = |e| IngestError::io(path, e);
    let mut hasher = blake3::Hasher::new();
    hasher
        .update_reader(File::open(path).map_err(wrong)?)
        .map_err(wrong)?;
    Ok(hasher.finalize().to_hex().to_string())
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
            Provenance::of(&path, None, &settings).unwrap()
        };
        assert_eq!(of("t\n1\n"), of("t\n1\n"));
        assert_ne!(of("t\n1\n"), of("t\n2\n"));
        let keys: Vec<String> = of("t\n").entries.into_iter().map(|e| e.0).collect();
        assert_eq!(keys[..3], ["source", "source_blake3", "resampled_hz"]);
    }

    #[test]
    fn every_file_of_a_split_recording_is_a_source() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("run");
        std::fs::create_dir(&folder).unwrap();
        for name in ["run_0.mcap", "run_1.mcap"] {
            std::fs::write(folder.join(name), name).unwrap();
        }
        let found = Provenance::of(&folder, None, &IngestSettings::default()).unwrap();
        let hash = |name: &str| blake3::hash(name.as_bytes()).to_hex().to_string();
        let hashes = format!("{} {}", hash("run_0.mcap"), hash("run_1.mcap"));
        assert_eq!(found.entries[0].1, "run_0.mcap run_1.mcap");
        assert_eq!(found.entries[1].1, hashes);
    }
}
