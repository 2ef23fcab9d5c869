//! Damaged copies of our own log: refused, and salvaged where that is asked for.

use super::{ROWS, bytes_of, recording, repacked};
use maveric_bag::BagError;
use maveric_domain::Recording;
use maveric_ingest::{IngestError, IngestSettings, Ingested, WarningKind, inspect, read_log};
use mcap::{Compression, WriteOptions};
use proptest::prelude::*;
use std::collections::BTreeSet;

const FOOTER: u8 = 2;
const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
const CHUNK: u8 = 6;
const DATA_END: u8 = 15;

pub(super) fn read(bytes: &[u8], recover: bool) -> Result<Ingested, IngestError> {
    let file = tempfile::Builder::new().suffix(".mcap").tempfile().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    let settings = IngestSettings {
        recover,
        ..IngestSettings::default()
    };
    read_log(file.path(), &settings).map(|mut found| found.remove(0))
}

/// Opcode, start and end of every record up to the footer.
fn records(bytes: &[u8]) -> Vec<(u8, usize, usize)> {
    let mut found = Vec::new();
    let mut at = 8;
    loop {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
        let end = at + 9 + usize::try_from(length).unwrap();
        found.push((bytes[at], at, end));
        if bytes[at] == FOOTER {
            return found;
        }
        at = end;
    }
}

fn chunks(bytes: &[u8]) -> Vec<(usize, usize)> {
    let all = records(bytes).into_iter();
    all.filter(|r| r.0 == CHUNK).map(|r| (r.1, r.2)).collect()
}

fn rows(found: &Result<Ingested, IngestError>) -> usize {
    found.as_ref().map_or(0, |f| f.recording.rows())
}

fn damages(found: &Ingested) -> usize {
    let of_damage = |w: &&maveric_ingest::Warning| w.kind == WarningKind::Damage;
    found.warnings.iter().filter(of_damage).count()
}

fn refused(bytes: &[u8]) {
    let error = read(bytes, false).unwrap_err();
    assert!(
        matches!(error, IngestError::Bag(BagError::Damaged { .. })),
        "{error}"
    );
    assert!(error.suggestion().unwrap().contains("--recover"));
}

/// Ego's positions and speeds, to the bit.
pub(super) fn samples(recording: &Recording) -> BTreeSet<[u64; 3]> {
    let ego = recording.ego();
    let of = |i: usize| [ego.x_m[i], ego.y_m[i], ego.speed_mps[i]].map(f64::to_bits);
    (0..recording.rows()).map(of).collect()
}

/// A short log of many small chunks; 100 rows.
fn small(compression: Option<Compression>) -> Vec<u8> {
    in_small_chunks(100, compression)
}

fn in_small_chunks(rows: usize, compression: Option<Compression>) -> Vec<u8> {
    let options = WriteOptions::new()
        .chunk_size(Some(16 << 10))
        .compression(compression);
    repacked(&super::first_rows(rows), options)
}

/// Rows of the chunk that holds the most of them.
fn most_of_a_chunk(log: &[u8]) -> usize {
    let whole = rows(&read(log, false));
    let without = |&(start, end): &(usize, usize)| {
        let mut bytes = log.to_vec();
        bytes[start + 9 + 44..end].fill(0xa5);
        whole - rows(&read(&bytes, true))
    };
    chunks(log).iter().map(without).max().unwrap()
}

/// What an undamaged log gives.
struct Whole {
    found: Ingested,
    samples: BTreeSet<[u64; 3]>,
    speeds: BTreeSet<u64>,
}

fn speeds(recording: &Recording) -> BTreeSet<u64> {
    let speeds = recording.ego().speed_mps.iter();
    speeds.map(|v| v.to_bits()).collect()
}

impl Whole {
    fn of(log: &[u8]) -> Self {
        let found = read(log, false).unwrap();
        Self {
            samples: samples(&found.recording),
            speeds: speeds(&found.recording),
            found,
        }
    }

    /// Says that a damaged copy is refused, and that under `recover` it keeps all but what one chunk held.
    fn salvages(&self, damaged: &[u8], most_lost: usize, what: &str) {
        let refusal = read(damaged, false);
        let error = refusal
            .err()
            .unwrap_or_else(|| panic!("{what}: not noticed"));
        assert!(
            matches!(error, IngestError::Bag(BagError::Damaged { .. })),
            "{what}: {error}"
        );
        let found = read(damaged, true).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert!(damages(&found) > 0, "{what}: no hole named");
        let rows = found.recording.rows();
        assert!(
            rows + most_lost >= self.found.recording.rows(),
            "{what}: {rows} rows left"
        );
        if found.meta == self.found.meta {
            let same = samples(&found.recording).is_subset(&self.samples);
            assert!(same, "{what}: values changed");
        } else {
            // Without its metadata a log has the frame of an unknown road, but the speeds are the same.
            let same = speeds(&found.recording).is_subset(&self.speeds);
            assert!(same, "{what}: speeds changed");
        }
    }
}

#[test]
fn every_flip_in_a_header_is_noticed_and_costs_a_chunk_at_most() {
    for compression in [Some(Compression::Zstd), Some(Compression::Lz4), None] {
        let log = in_small_chunks(60, compression);
        let most = most_of_a_chunk(&log);
        assert!(chunks(&log).len() > 2);
        assert!(most > 0 && most < 40, "{most}");
        let mut places: BTreeSet<usize> = (0..8).collect();
        for (opcode, start, end) in records(&log) {
            // Heads of records; of chunks also their own account, which ends with the packed size.
            let account = if opcode == CHUNK { 9 + 44 } else { 9 };
            // How chunks are packed makes a difference to chunks alone.
            if opcode == CHUNK || matches!(compression, Some(Compression::Zstd)) {
                places.extend(start..(start + account).min(end));
            }
        }
        places.extend(log.len() - 8..log.len());
        let whole = Whole::of(&log);
        for place in places {
            let mut bytes = log.clone();
            bytes[place] ^= 1 << (place % 8);
            whole.salvages(&bytes, most, &format!("{compression:?} byte {place}"));
        }
    }
}

#[test]
fn flips_anywhere_are_noticed_and_no_changed_value_comes_through() {
    let log = small(Some(Compression::Zstd));
    let most = most_of_a_chunk(&log);
    let whole = Whole::of(&log);
    for place in (8..log.len()).step_by(211) {
        let mut bytes = log.clone();
        bytes[place] ^= 0x10;
        whole.salvages(&bytes, most, &format!("byte {place}"));
    }
}

#[test]
fn a_file_cut_at_any_record_keeps_what_stands_before() {
    let log = small(Some(Compression::Zstd));
    let mut before = 0;
    for (opcode, start, end) in records(&log) {
        for cut in [start, start + 5, usize::midpoint(start, end)] {
            let bytes = &log[..cut.max(9)];
            refused(bytes);
            let left = rows(&read(bytes, true));
            assert!(
                left >= before,
                "cut at {cut} in {opcode:#04x}: {left} rows after {before}"
            );
            before = left;
        }
    }
    assert_eq!(before, 100);
    // Inside the last magic.
    refused(&log[..log.len() - 3]);
    assert_eq!(rows(&read(&log[..log.len() - 3], true)), 100);
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
fn zeroed_missing_and_repeated_pieces_cost_what_they_hold() {
    let log = small(Some(Compression::Zstd));
    let most = most_of_a_chunk(&log);
    let whole = Whole::of(&log);
    for (start, end) in chunks(&log) {
        let mut zeroed = log.clone();
        zeroed[start..end].fill(0);
        whole.salvages(&zeroed, most, &format!("chunk at {start} zeroed"));
        let mut missing = log.clone();
        missing.drain(start + 60..end - 10);
        whole.salvages(
            &missing,
            most,
            &format!("middle of chunk at {start} missing"),
        );
        let mut foreign = log.clone();
        foreign.splice(start..start, [0x77; 100]);
        whole.salvages(&foreign, 0, &format!("foreign bytes before {start}"));
    }
    let mut first_sector = log.clone();
    first_sector[..64].fill(0);
    assert_eq!(rows(&read(&first_sector, true)), 100);
}

#[test]
fn huge_lengths_cost_nothing_but_a_warning() {
    let log = small(Some(Compression::Zstd));
    let most = most_of_a_chunk(&log);
    let whole = Whole::of(&log);
    for (opcode, start, _) in records(&log) {
        for length in [4_600_000_000_000_000_000_u64, 1 << 24] {
            let mut bytes = log.clone();
            bytes[start + 1..start + 9].copy_from_slice(&length.to_le_bytes());
            let lost = if opcode == CHUNK { 0 } else { most };
            whole.salvages(
                &bytes,
                lost,
                &format!("{opcode:#04x} at {start} of {length} bytes"),
            );
        }
    }
    for (start, _) in chunks(&log) {
        // Unpacked and packed size of the chunk's own account: the checksum proves the messages all the same.
        for field in [9 + 16, 9 + 36] {
            let mut bytes = log.clone();
            bytes[start + field..start + field + 8].copy_from_slice(&(1_u64 << 62).to_le_bytes());
            whole.salvages(&bytes, 0, &format!("size at {}", start + field));
        }
    }
}

#[test]
fn a_wrong_checksum_costs_its_chunk_and_the_hole_has_its_times() {
    let log = small(Some(Compression::Zstd));
    let (start, _) = chunks(&log)[2];
    let mut bytes = log.clone();
    bytes[start + 9 + 24] ^= 1;
    let found = read(&bytes, true).unwrap();
    let hole = found
        .warnings
        .iter()
        .find(|w| w.kind == WarningKind::Damage)
        .unwrap();
    assert!(hole.what.contains("checksum"), "{}", hole.what);
    let (from, to) = hole.spans_s[0];
    assert!(from > 0.0 && to > from + 0.2 && to < 5.0, "{from} to {to}");
    // Never interpolated over.
    assert!(found.recording.rows() < 100);
    let time = found.recording.time_s();
    assert!(time.windows(2).any(|w| w[1] - w[0] > 0.2));
}

#[test]
fn a_log_without_chunks_cut_at_any_message_keeps_what_stands_before() {
    let options = WriteOptions::new().use_chunks(false).compression(None);
    let log = repacked(&super::first_rows(40), options);
    let mut before = 0;
    for (opcode, start, _) in records(&log) {
        let bytes = &log[..start.max(9)];
        refused(bytes);
        let left = rows(&read(bytes, true));
        assert!(left >= before, "cut before {opcode:#04x} at {start}");
        // Row by row; one alone is no drive.
        if opcode == MESSAGE {
            assert!(left <= before.max(1) + 1, "{left} rows after {before}");
        }
        before = left;
    }
    assert_eq!(before, 40);
}

#[test]
fn every_wrong_checksum_is_noticed_and_costs_no_more_than_its_chunk() {
    let log = small(Some(Compression::Zstd));
    let most = most_of_a_chunk(&log);
    let whole = Whole::of(&log);
    for (opcode, start, end) in records(&log) {
        let place = match opcode {
            CHUNK => start + 9 + 24,
            DATA_END => start + 9,
            FOOTER => end - 4,
            _ => continue,
        };
        let mut bytes = log.clone();
        bytes[place] ^= 0x40;
        let lost = if opcode == CHUNK { most } else { 0 };
        whole.salvages(
            &bytes,
            lost,
            &format!("checksum of {opcode:#04x} at {start}"),
        );
    }
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
    for (opcode, reason) in [
        (SCHEMA, "schema 1 is missing"),
        (CHANNEL, "it has no channels"),
    ] {
        let bytes = without(&log, opcode);
        let error = read(&bytes, true).unwrap_err();
        assert!(
            matches!(&error, IngestError::NoEgo { found, .. } if found.contains(reason)),
            "{error}"
        );
    }
}

/// Long enough for its chunks to be unpacked ahead.
#[test]
fn a_long_log_is_read_alike_whether_or_not_its_chunks_are_unpacked_ahead() {
    let of = |compression| {
        let options = WriteOptions::new().chunk_size(Some(64 << 10));
        repacked(&recording(false), options.compression(compression))
    };
    let (packed, plain) = (of(Some(Compression::Zstd)), of(None));
    assert!(packed.len() > 128 << 10, "{}", packed.len());
    let whole = read(&packed, false).unwrap();
    assert_eq!(
        whole,
        Ingested {
            warnings: whole.warnings.clone(),
            sources: whole.sources.clone(),
            ..read(&plain, false).unwrap()
        }
    );
    let all = chunks(&packed);
    let (start, end) = all[all.len() / 2];
    for (at, bytes) in [
        (start + 9 + 24, &[0x55_u8; 4][..]),
        (start + 1, &[0xff; 8]),
        (usize::midpoint(start, end), &[0; 16]),
        (start, &[0; 40]),
    ] {
        let mut damaged = packed.clone();
        damaged[at..at + bytes.len()].copy_from_slice(bytes);
        refused(&damaged);
        let found = read(&damaged, true).unwrap();
        assert!(damages(&found) > 0);
        let left = found.recording.rows();
        assert!(left + 400 > ROWS && left <= ROWS, "{left} rows");
        assert!(samples(&found.recording).is_subset(&samples(&whole.recording)));
    }
}

#[test]
fn a_chunk_whose_compression_is_no_text_is_left_out() {
    // Found by fuzzing: as text the name is longer than its bytes.
    let mut bytes = small(None);
    let (start, end) = chunks(&bytes)[0];
    let body = start + 9;
    let mut chunk = bytes[body..body + 28].to_vec();
    chunk.extend(4_u32.to_le_bytes());
    chunk.extend([0xff; 4]);
    chunk.extend(0_u64.to_le_bytes());
    bytes.splice(body..end, chunk.iter().copied());
    bytes[start + 1..body].copy_from_slice(&(chunk.len() as u64).to_le_bytes());
    refused(&bytes);
    assert!(rows(&read(&bytes, true)) > 0);
}

#[test]
fn a_lost_first_chunk_leaves_channels_that_the_summary_declares() {
    let log = small(Some(Compression::Zstd));
    let (start, end) = chunks(&log)[0];
    let mut bytes = log.clone();
    bytes[usize::midpoint(start, end)..][..16].fill(0x5a);
    Whole::of(&log).salvages(&bytes, most_of_a_chunk(&log), "first chunk");
    assert_eq!(read(&bytes, true).unwrap().meta, super::meta());
}

#[test]
fn without_checksums_and_summary_the_records_themselves_are_read() {
    let options = WriteOptions::new()
        .chunk_size(Some(16 << 10))
        .calculate_chunk_crcs(false)
        .calculate_data_section_crc(false)
        .calculate_summary_section_crc(false)
        .emit_message_indexes(false)
        .emit_statistics(false)
        .emit_summary_offsets(false)
        .repeat_channels(false)
        .repeat_schemas(false);
    let log = repacked(&super::first_rows(100), options.clone());
    assert_eq!(rows(&read(&log, false)), 100);
    let (start, _) = chunks(&log)[1];
    let mut bytes = log.clone();
    bytes[start + 2] = 9;
    assert_eq!(rows(&read(&bytes, true)), 100);
    // Nothing repeats what a damaged first chunk declares: then that is believed.
    let log = repacked(&super::first_rows(100), options.compression(None));
    let (start, end) = chunks(&log)[0];
    let (mut at, mut last) = (start + 9 + 40, 0);
    while at < end {
        last = at;
        at += 9 + usize::try_from(u64::from_le_bytes(log[at + 1..at + 9].try_into().unwrap()))
            .unwrap();
    }
    let mut bytes = log.clone();
    bytes[last + 3] = 9;
    refused(&bytes);
    let left = rows(&read(&bytes, true));
    assert!((60..100).contains(&left), "{left}");
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
    let why = found
        .warnings
        .iter()
        .find(|w| w.kind == WarningKind::RefusedChannel)
        .unwrap();
    assert!(
        why.what.contains("schema") && why.what.contains("missing"),
        "{}",
        why.what
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn no_damage_makes_a_panic_or_a_number_that_is_none(
        cut in 8_usize..2000,
        flips in proptest::collection::vec((0.0..1.0, any::<u8>()), 0..4),
    ) {
        let mut bytes = small(Some(Compression::Zstd));
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
