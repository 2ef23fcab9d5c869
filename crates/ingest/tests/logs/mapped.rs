//! Tables that are read through a mapping.

use maveric_domain::Drive;
use maveric_ingest::{IngestError, IngestSettings, Ingested, Mapping, read_log};
use std::path::Path;

/// Of a mapping of a table in the units of a recording.
pub(super) const UNITS: &str = "[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n";

/// A mapping that travels with the program.
pub(super) fn shipped(name: &str) -> Mapping {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings");
    Mapping::read(&folder.join(name)).unwrap()
}

/// The mapping that a text is.
pub(super) fn of_toml(text: &str) -> Result<Mapping, IngestError> {
    Mapping::from_toml(text, Path::new("m.toml"))
}

/// This mapping, all else as by default.
pub(super) fn settings(mapping: Mapping) -> IngestSettings {
    IngestSettings { mapping: Some(mapping), ..IngestSettings::default() }
}

/// A table in a file of that name, read by a mapping.
pub(super) fn read_named(
    file: &str,
    text: &str,
    mapping: Mapping,
) -> Result<Vec<Ingested>, IngestError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file);
    std::fs::write(&path, text).unwrap();
    read_log(&path, &settings(mapping))
}

/// The drive of a log.
pub(super) fn drive_of(log: &Ingested) -> Drive {
    Drive::from_recording(log.meta.clone(), &log.recording).unwrap()
}

/// A table, read by the text of a mapping.
pub(super) fn mapped(mapping: &str, text: &str) -> Result<Vec<Ingested>, IngestError> {
    read_named("t.csv", text, of_toml(mapping)?)
}
