//! Any byte that changes is noticed, costs one chunk at most, and no message comes through changed.

use crate::made::{
    ALL, CHUNK, EACH, MESSAGE, PACKINGS, chunks, flipped, messages, packed, records, recovered,
    refusal, time,
};
use maveric_bag::Damage;
use mcap::Compression;
use std::collections::BTreeSet;

/// Says that what is left is all but the messages of at most one chunk, in order, and that every hole lies between two of them.
fn costs_a_chunk_at_most(bytes: &[u8], what: &str) -> Vec<Damage> {
    let (notes, walked) = recovered(bytes);
    let times: Vec<u64> = notes.messages.iter().map(|m| m.1).collect();
    let (left, lost): (Vec<usize>, Vec<usize>) = (0..ALL).partition(|&i| times.contains(&time(i)));
    assert!(notes.messages == messages(left), "{what}: {times:?} came, changed or out of order");
    assert!(
        lost.is_empty() || lost.len() == EACH && lost[0].is_multiple_of(EACH),
        "{what}: {lost:?} are lost"
    );
    assert!(!walked.damage.is_empty(), "{what}: not noticed");
    for damage in &walked.damage {
        let (before, after) = damage.between_ns;
        let next = before.map_or(0, |t| times.iter().position(|&o| o == t).unwrap() + 1);
        assert_eq!(after, times.get(next).copied(), "{what}: {damage:?}");
    }
    if let Some(&first) = lost.first() {
        let hole = |d: &Damage| d.between_ns.0 == first.checked_sub(1).map(time);
        assert!(walked.damage.iter().any(hole), "{what}: {:?}", walked.damage);
    }
    let first = &walked.damage[0];
    assert_eq!(refusal(bytes), Some((first.at_byte, first.what.clone())), "{what}");
    walked.damage
}

#[test]
fn a_flip_of_any_byte_is_noticed_and_costs_a_chunk_at_most() {
    for compression in PACKINGS {
        let log = packed(compression);
        let all = records(&log);
        // Heads of records, of chunks with their own account; how chunks are packed makes a difference to chunks alone.
        let heads = (all.iter())
            .filter(|r| r.0 == CHUNK || matches!(compression, Some(Compression::Zstd)))
            .flat_map(|&(opcode, start, end)| {
                let account = if opcode == CHUNK { 9 + 44 } else { 9 };
                start..(start + account).min(end)
            });
        let ends = (0..8).chain(log.len() - 8..log.len());
        let places: BTreeSet<usize> = (0..log.len()).step_by(13).chain(heads).chain(ends).collect();
        for at in places {
            let bits = 1 << (at % 8);
            if all.iter().any(|r| r.1 == at) && log[at] ^ bits == MESSAGE {
                // See `an_index_whose_opcode_becomes_a_message_s_gives_one_that_the_data_s_checksum_denies`.
                continue;
            }
            costs_a_chunk_at_most(&flipped(&log, at, bits), &format!("{compression:?} byte {at}"));
        }
    }
}

#[test]
fn zeroed_missing_and_foreign_pieces_cost_what_they_hold() {
    for compression in PACKINGS {
        let log = packed(compression);
        for (start, end) in chunks(&log) {
            let mut zeroed = log.clone();
            zeroed[start..end].fill(0);
            costs_a_chunk_at_most(&zeroed, &format!("chunk at {start} zeroed"));
            for (from, to) in [(start + 60, end - 10), (start + 9 + 44, end), (end - 1, end)] {
                let mut missing = log.clone();
                missing.drain(from..to);
                costs_a_chunk_at_most(&missing, &format!("bytes {from} to {to} missing"));
            }
            for n in [1, 9, 100] {
                let mut foreign = log.clone();
                foreign.splice(start..start, vec![0x77; n]);
                costs_a_chunk_at_most(&foreign, &format!("{n} foreign bytes before {start}"));
                let (notes, _) = recovered(&foreign);
                assert_eq!(notes.messages.len(), ALL, "{n} foreign bytes before {start}");
            }
        }
        let mut header = log.clone();
        header[..chunks(&log)[0].0].fill(0);
        costs_a_chunk_at_most(&header, "header zeroed");
        assert_eq!(recovered(&header).0.messages.len(), ALL);
    }
}

#[test]
fn a_huge_length_costs_nothing_where_the_chunk_itself_knows_better() {
    let log = packed(Some(Compression::Zstd));
    for (opcode, start, _) in records(&log) {
        for length in [4_600_000_000_000_000_000_u64, 1 << 24] {
            let mut bytes = log.clone();
            bytes[start + 1..start + 9].copy_from_slice(&length.to_le_bytes());
            costs_a_chunk_at_most(&bytes, &format!("{opcode:#04x} at {start} of {length}"));
            if opcode == CHUNK {
                assert_eq!(recovered(&bytes).0.messages.len(), ALL);
            }
        }
    }
    for (start, _) in chunks(&log) {
        // Unpacked and packed size: the checksum proves the messages all the same.
        for field in [9 + 16, 9 + 36] {
            let mut bytes = log.clone();
            bytes[start + field..start + field + 8].copy_from_slice(&(1_u64 << 62).to_le_bytes());
            costs_a_chunk_at_most(&bytes, &format!("size at {}", start + field));
            assert_eq!(recovered(&bytes).0.messages.len(), ALL);
        }
    }
}
