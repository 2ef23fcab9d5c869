//! Damaged copies of our own log: refused, and salvaged where that is asked for.

use super::{ROWS, bytes_of, recording};
use maveric_ingest::{IngestError, IngestSettings, Ingested, WarningKind, inspect, read_log};
use proptest::prelude::*;

const CHUNK: u8 = 6;
const FOOTER: u8 = 2;

fn read(bytes: &[u8], recover: bool) -> Result<Ingested, IngestError> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    let settings = IngestSettings {
        recover,
        ..IngestSettings::default()
    };
    assert!(inspect(file.path()).is_ok() || bytes.is_empty());
    read_log(file.path(), &settings).map(|mut found| found.remove(0))
}

/// Start and end of every record of a kind.
fn records(bytes: &[u8], opcode: u8) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut at = 8;
    while at + 9 <= bytes.len() {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
        let end = at + 9 + usize::try_from(length).unwrap();
        if bytes[at] == opcode {
            found.push((at, end));
        }
        if bytes[at] == FOOTER {
            break;
        }
        at = end;
    }
    found
}

fn rows(found: &Result<Ingested, IngestError>) -> usize {
    found.as_ref().unwrap().recording.rows()
}

fn damages(found: &Result<Ingested, IngestError>) -> usize {
    let warnings = &found.as_ref().unwrap().warnings;
    warnings
        .iter()
        .filter(|w| w.kind == WarningKind::Damage)
        .count()
}

fn refused(bytes: &[u8]) {
    let error = read(bytes, false).unwrap_err();
    assert!(matches!(error, IngestError::Damaged { .. }), "{error}");
    assert!(error.suggestion().unwrap().contains("--recover"));
}

#[test]
fn a_file_without_its_end_keeps_every_row() {
    let mut bytes = bytes_of(&recording(false));
    let (_, end) = *records(&bytes, CHUNK).last().unwrap();
    bytes.truncate(end);
    refused(&bytes);
    let found = read(&bytes, true);
    assert_eq!((rows(&found), damages(&found)), (ROWS, 1));
    assert_eq!(found.unwrap().meta, super::meta());
}

#[test]
fn a_file_cut_in_a_chunk_keeps_the_rows_before_the_cut() {
    let mut bytes = bytes_of(&recording(false));
    let chunks = records(&bytes, CHUNK);
    let (start, end) = *chunks.last().unwrap();
    bytes.truncate(start + (end - start) * 3 / 4);
    refused(&bytes);
    let found = read(&bytes, true);
    assert!(
        rows(&found) > ROWS / 3 && rows(&found) < ROWS,
        "{}",
        rows(&found)
    );
    assert_eq!(damages(&found), 1);
}

#[test]
fn flipped_bytes_cost_their_chunk_alone_and_leave_a_hole() {
    let whole = bytes_of(&recording(false));
    let chunks = records(&whole, CHUNK);
    assert!(chunks.len() >= 2, "{} chunks", chunks.len());
    let (start, end) = chunks[0];
    let mut bytes = whole.clone();
    for b in &mut bytes[usize::midpoint(start, end)..][..16] {
        *b ^= 0x5a;
    }
    refused(&bytes);
    // The first chunk also declares the channels: the summary repeats them.
    let found = read(&bytes, true);
    assert!(
        rows(&found) > 100 && rows(&found) < ROWS,
        "{}",
        rows(&found)
    );
    assert_eq!(damages(&found), 1);
}

#[test]
fn a_senseless_length_costs_nothing_but_a_warning() {
    let mut bytes = bytes_of(&recording(false));
    let (start, _) = records(&bytes, CHUNK)[0];
    bytes[start + 1..start + 9].copy_from_slice(&4_600_000_000_000_000_000_u64.to_le_bytes());
    refused(&bytes);
    let found = read(&bytes, true);
    assert_eq!((rows(&found), damages(&found)), (ROWS, 1));
}

#[test]
fn a_chunk_of_zeros_is_a_hole() {
    let mut bytes = bytes_of(&recording(false));
    let chunks = records(&bytes, CHUNK);
    let (start, end) = chunks[chunks.len() - 1];
    bytes[start..end].fill(0);
    refused(&bytes);
    let found = read(&bytes, true);
    assert!(rows(&found) < ROWS && damages(&found) >= 1);
}

#[test]
fn files_that_are_no_logs_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let settings = IngestSettings::default();
    let of = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        read_log(&path, &settings).unwrap_err()
    };
    assert!(matches!(of("a.mcap", b""), IngestError::Empty { .. }));
    assert!(matches!(
        of("b.mcap", b"PAR1\0\x01\xff"),
        IngestError::NotALog { .. }
    ));
    assert!(matches!(
        of("c.csv", b"t,x\n1,2\n"),
        IngestError::NoMapping { .. }
    ));
    assert!(matches!(
        of("d.mcap", b"\x89MC"),
        IngestError::Damaged { .. }
    ));
    let missing = read_log(&folder.path().join("none.mcap"), &settings).unwrap_err();
    assert!(matches!(missing, IngestError::NotFound { .. }));
    let is_folder = read_log(folder.path(), &settings).unwrap_err();
    assert!(matches!(is_folder, IngestError::IsDirectory { .. }));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn no_damage_makes_a_panic_or_a_number_that_is_none(
        cut in 8_usize..2000,
        flips in proptest::collection::vec((0.0..1.0, any::<u8>()), 0..4),
    ) {
        let mut bytes = bytes_of(&recording(false));
        for (place, value) in flips {
            let at = 8 + (place * (bytes.len() - 9) as f64) as usize;
            bytes[at] = value;
        }
        if cut % 2 == 0 {
            bytes.truncate(bytes.len() - cut);
        }
        if let Ok(found) = read(&bytes, true) {
            prop_assert!(found.recording.ego().x_m.iter().all(|x| x.is_finite()));
        }
        let _ = read(&bytes, false);
    }
}
