//! Recordings that are read ahead on a thread of their own, hashed, stopped; and messages that are too long to be read.

use crate::made::{
    ALL, Heard, Notes, PACKINGS, RECOVER, chunks, flipped, message, recorded, recorded_of,
    recovered, time, with,
};
use maveric_bag::{MOST_RECORD, Walk, Walked, walk};
use mcap::{Compression, WriteOptions};
use std::path::{Path, PathBuf};

/// A message that hardly packs: eight KiB of a generator's bytes.
fn noise(i: usize) -> Heard {
    let (channel, ns, _) = message(i);
    let mut state = i as u64 + 1;
    let bytes = (0..1024).flat_map(|_| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state ^ (state >> 29)).to_le_bytes()
    });
    (channel, ns, bytes.collect())
}

fn long(compression: Option<Compression>) -> Vec<u8> {
    let log = recorded_of(WriteOptions::new().compression(compression), noise);
    assert!(log.len() > 256 << 10, "long enough to be read ahead");
    log
}

fn on_disk(folder: &Path, bytes: &[u8]) -> PathBuf {
    let path = folder.join("a.mcap");
    std::fs::write(&path, bytes).unwrap();
    path
}

fn by_path(path: &Path, how: Walk) -> Result<(Notes, Walked), String> {
    let mut notes = Notes::default();
    let walked = walk(path, how, &mut notes).map_err(|e| e.to_string())?;
    Ok((notes, walked))
}

#[test]
fn a_file_is_read_alike_whether_or_not_its_chunks_are_unpacked_ahead() {
    let folder = tempfile::tempdir().unwrap();
    for compression in PACKINGS {
        let log = long(compression);
        let all = chunks(&log);
        let (start, end) = all[2];
        let mut missing = log.clone();
        missing.drain(start + 60..end - 10);
        let mut foreign = log.clone();
        foreign.splice(start..start, [0x77; 100]);
        let cases = [
            log.clone(),
            flipped(&log, start, 0x10),
            flipped(&log, start + 1, 1),
            with(&log, start + 1, &[0xff; 8]),
            flipped(&log, start + 9 + 16, 1),
            flipped(&log, start + 9 + 24, 1),
            flipped(&log, start + 9 + 32, 1),
            flipped(&log, start + 9 + 36, 1),
            with(&log, usize::midpoint(start, end), &[0; 16]),
            with(&log, start, &[0; 40]),
            missing,
            foreign,
            log[..start + 30].to_vec(),
            log[..end - 1].to_vec(),
            log[..end].to_vec(),
        ];
        for (i, bytes) in cases.iter().enumerate() {
            let path = on_disk(folder.path(), bytes);
            for hash in [false, true] {
                let how = Walk { hash, ..RECOVER };
                let (notes, walked) = by_path(&path, how).unwrap();
                let (expected, from_memory) = recovered(bytes);
                assert!(notes == expected, "{compression:?} case {i}");
                assert_eq!(walked.damage, from_memory.damage, "{compression:?} case {i}");
                let of_all = hash.then(|| blake3::hash(bytes).to_hex().to_string());
                assert_eq!(walked.blake3, of_all, "{compression:?} case {i}");
                if i == 0 {
                    assert_eq!(notes.messages, (0..ALL).map(noise).collect::<Vec<_>>());
                    assert!(walked.damage.is_empty());
                }
            }
            let refused = by_path(&path, Walk::default());
            assert_eq!(refused.is_err(), i > 0, "{compression:?} case {i}");
        }
    }
}

#[test]
fn a_short_file_is_hashed_too_and_one_that_is_not_there_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = recorded(WriteOptions::new());
    let path = on_disk(folder.path(), &bytes);
    let how = Walk { hash: true, ..RECOVER };
    let (notes, walked) = by_path(&path, how).unwrap();
    assert_eq!(notes, recovered(&bytes).0);
    assert_eq!(walked.blake3.unwrap(), blake3::hash(&bytes).to_hex().to_string());
    let none = by_path(&folder.path().join("none.mcap"), how).unwrap_err();
    assert!(none.contains("could not read") && none.contains("none.mcap"), "{none}");
}

/// The 13th message is longer than any that is read, by a byte or by much, the 14th just as long as one may be.
fn with_too_long(i: usize) -> Heard {
    let (channel, ns, data) = message(i);
    // The head of a message takes 22 bytes of its record.
    let data = match i {
        13 => vec![b' '; MOST_RECORD - 22 + 1],
        14 => vec![b' '; MOST_RECORD - 22],
        _ => data,
    };
    (channel, ns, data)
}

#[test]
fn a_message_that_is_too_long_is_passed_over_and_counted() {
    for (compression, chunked) in [(Some(Compression::Zstd), true), (None, false)] {
        let options = WriteOptions::new().compression(compression).use_chunks(chunked);
        let options = options.chunk_size(None);
        let bytes = recorded_of(options, with_too_long);
        let (notes, walked) = recovered(&bytes);
        assert_eq!(walked.damage, []);
        assert_eq!(notes.passed_over, 1);
        let times: Vec<u64> = notes.messages.iter().map(|m| m.1).collect();
        let expected: Vec<u64> = (0..ALL).filter(|i| *i != 13).map(time).collect();
        assert_eq!(times, expected);
        assert_eq!(notes.messages[13].2.len(), MOST_RECORD - 22);
        // It is rolled back with its chunk.
        if chunked {
            let (start, _) = chunks(&bytes)[1];
            let (notes, _) = recovered(&flipped(&bytes, start + 9 + 24, 1));
            assert_eq!((notes.passed_over, notes.messages.len()), (0, ALL - 10));
        }
    }
}
