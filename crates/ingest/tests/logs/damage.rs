//! Damaged copies of our own log: refused, and salvaged where that is asked for.

use super::{ROWS, bytes_of, recording, repacked};
use maveric_bag::BagError;
use maveric_ingest::{IngestError, IngestSettings, Ingested, WarningKind, inspect, read_log};
use mcap::WriteOptions;
use proptest::prelude::*;

#[path = "../../../bag/tests/walks/records.rs"]
mod places;
use places::{CHANNEL, SCHEMA, chunks, records};

pub(super) fn read(bytes: &[u8], recover: bool) -> Result<Ingested, IngestError> {
    let file = tempfile::Builder::new().suffix(".mcap").tempfile().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    let settings = IngestSettings { recover, ..IngestSettings::default() };
    read_log(file.path(), &settings).map(|mut found| found.remove(0))
}

fn rows(found: &Result<Ingested, IngestError>) -> usize {
    found.as_ref().map_or(0, |f| f.recording.rows())
}

fn damages(found: &Ingested) -> usize {
    let of_damage = |w: &&maveric_ingest::Warning| w.kind == WarningKind::Damage;
    found.warnings.iter().filter(of_damage).count()
}

/// A short log of many small chunks; 100 rows.
fn small() -> Vec<u8> {
    let options = WriteOptions::new().chunk_size(Some(16 << 10));
    repacked(&super::first_rows(100), options)
}

fn refused(bytes: &[u8]) {
    let error = read(bytes, false).unwrap_err();
    assert!(matches!(error, IngestError::Bag(BagError::Damaged { .. })), "{error}");
    assert!(error.suggestion().unwrap().contains("--recover"));
}

#[test]
fn a_file_cut_in_a_chunk_keeps_the_rows_before_the_cut() {
    let mut bytes = bytes_of(&recording(false));
    let (start, end) = *chunks(&bytes).last().unwrap();
    bytes.truncate(start + (end - start) * 3 / 4);
    refused(&bytes);
    let found = read(&bytes, true);
    let left = rows(&found);
    assert!(left > ROWS / 3 && left < ROWS, "{left}");
    assert_eq!(damages(&found.unwrap()), 1);
}

#[test]
fn a_wrong_checksum_costs_its_chunk_and_the_hole_has_its_times() {
    let log = small();
    let (start, _) = chunks(&log)[2];
    let mut bytes = log.clone();
    bytes[start + 9 + 24] ^= 1;
    let found = read(&bytes, true).unwrap();
    let hole = found.warnings.iter().find(|w| w.kind == WarningKind::Damage).unwrap();
    assert!(hole.what.contains("checksum"), "{}", hole.what);
    let (from, to) = hole.spans_s[0];
    assert!(from > 0.0 && to > from + 0.2 && to < 5.0, "{from} to {to}");
    // Never interpolated over.
    assert!(found.recording.rows() < 100);
    let time = found.recording.time_s();
    assert!(time.windows(2).any(|w| w[1] - w[0] > 0.2));
}

/// A log whose schemas or channels are not declared: their records have an opcode that nobody knows.
fn without(log: &[u8], opcode: u8) -> Vec<u8> {
    let mut bytes = log.to_vec();
    for (found, start, _) in records(log) {
        if found == opcode {
            bytes[start] = 0x7f;
        }
    }
    bytes
}

#[test]
fn without_schemas_or_channels_every_channel_is_refused_and_the_reason_said() {
    let options = WriteOptions::new()
        .use_chunks(false)
        .compression(None)
        .calculate_data_section_crc(false)
        .calculate_summary_section_crc(false)
        .repeat_schemas(false)
        .repeat_channels(false);
    let log = repacked(&super::first_rows(40), options);
    for (opcode, reason) in [(SCHEMA, "schema 1 is missing"), (CHANNEL, "it has no channels")] {
        let bytes = without(&log, opcode);
        let error = read(&bytes, true).unwrap_err();
        assert!(
            matches!(&error, IngestError::NoEgo { found, .. } if found.contains(reason)),
            "{error}"
        );
    }
}

#[test]
fn a_missing_schema_refuses_its_channel_alone() {
    let bytes = bytes_of(&recording(false));
    let log = super::rewritten(&bytes, WriteOptions::new(), |mut message| {
        if message.channel.topic.ends_with("objects") {
            let mut channel = (*message.channel).clone();
            channel.schema = None;
            message.channel = channel.into();
        }
        Some(message)
    });
    let found = read(&log, false).unwrap();
    assert!(found.recording.others().is_empty() && found.recording.rows() == ROWS);
    let why = found.warnings.iter().find(|w| w.kind == WarningKind::RefusedChannel).unwrap();
    assert!(why.what.contains("schema") && why.what.contains("missing"), "{}", why.what);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn no_damage_makes_a_panic_or_a_number_that_is_none(
        cut in 8_usize..2000,
        flips in proptest::collection::vec((0.0..1.0, any::<u8>()), 0..4),
    ) {
        let mut bytes = small();
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
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), &bytes).unwrap();
        prop_assert!(inspect(file.path()).is_ok());
    }
}
