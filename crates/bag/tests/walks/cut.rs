//! Recordings that end early.

use crate::made::{
    ALL, CHUNK, EACH, MESSAGE, PACKINGS, chunks, messages, packed, recorded, records, recovered,
    refusal, time,
};
use mcap::WriteOptions;

#[test]
fn a_recording_cut_anywhere_keeps_all_that_stands_before_and_says_where() {
    for compression in PACKINGS {
        let log = packed(compression);
        let all = records(&log);
        let whole = |cut: usize| all.iter().filter(|r| r.0 == CHUNK && r.2 <= cut).count();
        for cut in (8..log.len()).step_by(7) {
            let (notes, walked) = recovered(&log[..cut]);
            let kept = notes.messages.len();
            assert!(kept >= whole(cut) * EACH, "{kept} messages of a file cut at {cut}");
            assert_eq!(notes.messages, messages(0..kept), "cut at {cut}");
            assert_eq!(walked.damage.len(), 1, "cut at {cut}: {:?}", walked.damage);
            let damage = &walked.damage[0];
            let last = kept.checked_sub(1).map(time);
            assert_eq!(damage.between_ns, (last, None), "cut at {cut}");
            let at = all.iter().rfind(|r| r.1 <= cut).unwrap();
            let behind = log.len() - 8;
            let at = if cut >= behind { behind } else { at.1 };
            assert_eq!(damage.at_byte, at as u64, "cut at {cut}");
            assert_eq!(refusal(&log[..cut]), Some((damage.at_byte, damage.what.clone())));
        }
    }
}

#[test]
fn messages_before_a_cut_within_a_chunk_are_kept_one_by_one() {
    let log = packed(None);
    let (start, end) = chunks(&log)[2];
    let mut ends = Vec::new();
    let mut at = start + 9 + 40;
    while at < end {
        let length = log[at + 1..at + 9].try_into().unwrap();
        at += 9 + usize::try_from(u64::from_le_bytes(length)).unwrap();
        ends.push(at);
    }
    assert_eq!(ends.len(), EACH);
    for cut in start + 60..end {
        let (notes, walked) = recovered(&log[..cut]);
        let there = 2 * EACH + ends.iter().filter(|e| **e <= cut).count();
        assert_eq!(notes.messages.len(), there, "cut at {cut}");
        let (claimed, left) = (end - start - 9, cut - start - 9);
        let what = format!("a chunk is cut off: {claimed} bytes claimed, {left} left");
        let what = if claimed < cut {
            what
        } else {
            format!("a chunk claims {claimed} bytes, {left} left")
        };
        assert_eq!(walked.damage[0].what, what);
    }
}

#[test]
fn a_recording_without_chunks_keeps_every_message_before_the_cut() {
    let log = recorded(WriteOptions::new().use_chunks(false).compression(None));
    let all = records(&log);
    for cut in (8..log.len()).step_by(3) {
        let there = all.iter().filter(|r| r.0 == MESSAGE && r.2 <= cut).count();
        let (notes, walked) = recovered(&log[..cut]);
        assert_eq!(notes.messages, messages(0..there), "cut at {cut}");
        assert_eq!(walked.damage.len(), 1);
    }
    assert_eq!(recovered(&log).0.messages.len(), ALL);
}
