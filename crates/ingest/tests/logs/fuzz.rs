//! Tables and mappings that were damaged at random: refused or read, never a panic, never a value that is not finite.
//!
//! `PROPTEST_CASES` sets how many; `cargo test` runs a few.

use super::mapped::drive_of;
use maveric_ingest::{IngestSettings, Mapping, inspect_with, read_log, suggest_mapping};
use proptest::prelude::*;
use std::path::Path;

#[path = "../generated/tables.rs"]
mod tables;
use tables::{MAPPINGS, WORDS, table};

/// One damage: what, where (of the whole), how far, and a word.
type Damage = (u8, f64, usize, usize);

fn damaged(text: &str, damages: &[Damage]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for &(what, at, length, word) in damages {
        let at = ((bytes.len() as f64 * at) as usize).min(bytes.len());
        let end = (at + length).min(bytes.len());
        match what {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let copy = bytes[at..end].to_vec();
                bytes.splice(end..end, copy);
            }
            3 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << (word % 8);
                }
            }
            4 => bytes.splice(at..end, WORDS[word % WORDS.len()].bytes()).for_each(drop),
            // A whole cell becomes the word.
            _ => {
                let stop = |b: &u8| *b == b',' || *b == b'\n';
                let start = bytes[..at].iter().rposition(stop).map_or(0, |i| i + 1);
                let end = bytes[at..].iter().position(stop).map_or(bytes.len(), |i| at + i);
                bytes.splice(start..end, WORDS[word % WORDS.len()].bytes());
            }
        }
    }
    bytes
}

fn damages(most: usize) -> impl Strategy<Value = Vec<Damage>> {
    prop::collection::vec((0..6_u8, 0.0..1.0, 0..60_usize, 0..WORDS.len()), 0..most)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(
        std::env::var("PROPTEST_CASES").ok().and_then(|c| c.parse().ok()).unwrap_or(60)
    ) })]

    #[test]
    fn damaged_tables_and_mappings_are_refused_or_read(
        which in 0..MAPPINGS.len(),
        to_table in damages(6),
        to_mapping in damages(3),
    ) {
        let (mapping, name) = MAPPINGS[which];
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings").join(mapping);
        let toml = std::fs::read_to_string(shipped).unwrap();
        let toml = String::from_utf8_lossy(&damaged(&toml, &to_mapping)).into_owned();
        let mapping = Mapping::from_toml(&toml, Path::new("m.toml")).ok();
        // A rate is a wish, not damage: it may cost what it costs.
        let settings = IngestSettings { mapping, rate_hz: Some(20.0), ..IngestSettings::default() };

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, damaged(&table(which, 40), &to_table)).unwrap();
        for beside in ["01_recordingMeta.csv", "00_recordingMeta.csv"] {
            let meta = "frameRate,speedLimit,upperLaneMarkings,lowerLaneMarkings\n25,30,8;12,20;24;28\n";
            std::fs::write(folder.path().join(beside), damaged(meta, &to_mapping)).unwrap();
        }
        for found in read_log(&path, &settings).unwrap_or_default() {
            // A drive takes finite numbers only.
            let drive = drive_of(&found);
            prop_assert!(drive.rows().lead_dx_m.iter().all(|d| d.is_finite()));
        }
        let _ = inspect_with(&path, &settings);
        if let Ok(toml) = suggest_mapping(&path) {
            let mapping = Mapping::from_toml(&toml, Path::new("proposed")).unwrap();
            let proposed = IngestSettings { mapping: Some(mapping), ..IngestSettings::default() };
            let read = read_log(&path, &proposed);
            prop_assert!(read.is_ok_and(|drives| !drives.is_empty()), "{toml}");
        }
    }
}
