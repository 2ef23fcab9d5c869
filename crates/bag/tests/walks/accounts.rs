//! Damage by hand: which messages are left, where the damage is, what is said of it, and the times of the hole.

use crate::made::{
    ALL, CHANNEL, CHUNK, CHUNKS, DATA_END, EACH, FOOTER, Heard, MESSAGE, MESSAGE_INDEX, PACKINGS,
    SCHEMA, STATISTICS, bare, chunks, flipped, last_record, messages, of_kind, packed, recorded,
    records, recovered, refusal, time, with,
};
use mcap::{Compression, WriteOptions};

/// One damage as it should be told: place, sentence, messages before and after.
type Told<'a> = (usize, &'a str, (Option<usize>, Option<usize>));

/// Says what is left of a damaged recording and everything that is told of it, and that a walk without recovery ends at the first.
fn is_told(bytes: &[u8], left: &[Heard], told: &[Told<'_>]) {
    let (notes, walked) = recovered(bytes);
    let found: Vec<_> = (walked.damage.iter())
        .map(|d| (d.at_byte as usize, d.what.as_str(), d.between_ns))
        .collect();
    let expected: Vec<_> = (told.iter())
        .map(|(at, what, (from, to))| (*at, *what, (from.map(time), to.map(time))))
        .collect();
    assert_eq!(found, expected);
    assert_eq!(notes.messages, left);
    let first = told.first().map(|t| (t.0 as u64, t.1.to_owned()));
    assert_eq!(refusal(bytes), first);
}

fn all() -> Vec<Heard> {
    messages(0..ALL)
}

/// All but the messages of chunk `k`.
fn without(k: usize) -> Vec<Heard> {
    messages((0..ALL).filter(|i| i / EACH != k))
}

/// The messages on both sides of chunk `k`.
fn around(k: usize) -> (Option<usize>, Option<usize>) {
    let after = (k + 1) * EACH;
    ((k * EACH).checked_sub(1), (after < ALL).then_some(after))
}

const END: (Option<usize>, Option<usize>) = (Some(ALL - 1), None);

#[test]
fn a_whole_recording_gives_every_record_and_no_damage() {
    is_told(&bare(WriteOptions::new()), &all(), &[]);
    for (compression, chunked) in PACKINGS.map(|p| (p, true)).into_iter().chain([(None, false)]) {
        let bytes = recorded(WriteOptions::new().compression(compression).use_chunks(chunked));
        is_told(&bytes, &all(), &[]);
        let (notes, _) = recovered(&bytes);
        assert_eq!(notes.headers, [("lab".to_owned(), "tests".to_owned())]);
        assert_eq!(notes.passed_over, 0);
        // Once where they are declared, once in the summary.
        assert_eq!((notes.schemas.len(), notes.channels.len()), (4, 4));
        let json = |id, name: &str| (id, name.to_owned(), "jsonschema".to_owned(), b"{}".to_vec());
        assert_eq!(notes.schemas[..2], [json(1, "lab.Xa"), json(2, "lab.Xb")]);
        let channel = &notes.channels[1];
        assert_eq!((channel.id, channel.schema_id), (2, 2));
        assert_eq!((&channel.topic[..], &channel.encoding[..]), ("/b", "json"));
        assert_eq!(notes.metadata.len(), 1);
        assert_eq!(notes.metadata[0].name, "drive");
        assert_eq!(notes.metadata[0].values["who"], "P07");
    }
}

#[test]
fn a_chunk_of_wrong_checksum_or_bytes_is_left_out() {
    for compression in PACKINGS {
        let log = packed(compression);
        for (k, (start, end)) in chunks(&log).into_iter().enumerate() {
            let checksum = flipped(&log, start + 9 + 24, 1);
            let what = "a chunk is left out: its checksum does not match";
            is_told(&checksum, &without(k), &[(start, what, around(k))]);
            // The bytes of a message that is not packed: its checksum tells.
            if compression.is_none() {
                let bytes = flipped(&log, end - 1, 0x40);
                is_told(&bytes, &without(k), &[(start, what, around(k))]);
            }
        }
    }
    let log = packed(Some(Compression::Zstd));
    let (start, end) = chunks(&log)[1];
    let mut bytes = log.clone();
    bytes[start + 9 + 44..end].fill(0xa5);
    let (notes, walked) = recovered(&bytes);
    assert_eq!(notes.messages, without(1));
    let what = &walked.damage[0].what;
    assert!(what.starts_with("a chunk is left out: it cannot be unpacked ("), "{what}");
}

#[test]
fn a_wrong_size_or_name_costs_nothing_where_a_checksum_or_all_sizes_prove_the_messages() {
    let wrong = "a size or name in its header is wrong; its messages are kept";
    let kept = |k: usize| (Some(k * EACH + EACH - 1), around(k).1);
    for compression in PACKINGS {
        let log = packed(compression);
        let (start, _) = chunks(&log)[2];
        // What it unpacks to.
        is_told(&flipped(&log, start + 9 + 16, 4), &all(), &[(start, wrong, kept(2))]);
    }
    // What it is packed into: the length of the record is believed, behind which records go on.
    let log = packed(Some(Compression::Zstd));
    let (start, _) = chunks(&log)[2];
    let lengths = "the lengths in a chunk's header contradict each other";
    for at in [start + 1, start + 9 + 36] {
        let told: &[Told<'_>] = &[(start, lengths, around(1)), (start, wrong, kept(2))];
        let told = [(start, lengths, (Some(19), Some(20))), told[1]];
        let told = if at == start + 1 { &told[..1] } else { &told[..] };
        is_told(&flipped(&log, at, 1), &all(), told);
    }
    // A name that is none: the first bytes tell the packing.
    is_told(&flipped(&log, start + 9 + 32, 1), &all(), &[(start, wrong, kept(2))]);
    let lz4 = packed(Some(Compression::Lz4));
    let (at, _) = chunks(&lz4)[2];
    is_told(&flipped(&lz4, at + 9 + 32, 1), &all(), &[(at, wrong, kept(2))]);
    // Without a checksum the sizes have to fit.
    let log = bare(WriteOptions::new());
    let (start, _) = chunks(&log)[2];
    let what = "a chunk is left out: it does not unpack to the size that it claims";
    is_told(&flipped(&log, start + 9 + 16, 4), &without(2), &[(start, what, around(2))]);
}

#[test]
fn the_length_that_is_followed_by_records_is_believed() {
    let log = packed(Some(Compression::Zstd));
    let (start, end) = chunks(&log)[1];
    let length = end - start - 9;
    for claimed in [1_u64 << 62, 1 << 24] {
        let what = format!("a chunk claims {claimed} bytes, {} left", log.len() - start - 9);
        let damaged = with(&log, start + 1, &claimed.to_le_bytes());
        is_told(&damaged, &all(), &[(start, &what, (Some(9), Some(10)))]);
    }
    // Too short: the account within is right.
    let damaged = with(&log, start + 1, &(length as u64 - 7).to_le_bytes());
    let what = "the lengths in a chunk's header contradict each other";
    is_told(&damaged, &all(), &[(start, what, (Some(9), Some(10)))]);
    // A piece of it is gone: it cannot be unpacked, and the next record is looked for.
    let mut damaged = log.clone();
    damaged.drain(start + 9 + 60..start + 9 + 90);
    let (notes, walked) = recovered(&damaged);
    assert_eq!(notes.messages, without(1));
    let what = &walked.damage[0].what;
    assert!(what.starts_with("a chunk is left out: it cannot be unpacked"), "{what}");
    assert_eq!(walked.damage[0].between_ns, (Some(time(9)), Some(time(20))));
}

#[test]
fn an_index_whose_opcode_becomes_a_message_s_gives_one_that_the_data_s_checksum_denies() {
    // Known: to the container it is a message like any other, and its bytes fit no definition.
    let log = packed(None);
    let (start, end) = of_kind(&log, MESSAGE_INDEX)[0];
    let (data_end, _) = of_kind(&log, DATA_END)[0];
    let (notes, walked) = recovered(&flipped(&log, start, MESSAGE ^ MESSAGE_INDEX));
    assert_eq!(notes.messages.len(), ALL + 1);
    assert_eq!(notes.messages[EACH].2, log[start + 9 + 22..end]);
    assert_eq!(walked.damage.len(), 1);
    assert_eq!(walked.damage[0].at_byte, data_end as u64);
}

#[test]
fn a_chunk_whose_opcode_has_changed_is_one_by_its_account() {
    for compression in PACKINGS {
        let log = packed(compression);
        let (start, _) = chunks(&log)[1];
        for bit in [0x01, 0x10, 0x80] {
            let what = format!("record {:#04x} is a chunk by its content", CHUNK ^ bit);
            let told: &[Told<'_>] = &[(start, &what, (Some(9), Some(10)))];
            is_told(&flipped(&log, start, bit), &all(), told);
        }
    }
}

#[test]
fn what_the_end_of_a_recording_says_of_the_whole_is_checked() {
    let log = packed(Some(Compression::Zstd));
    let (end, _) = of_kind(&log, DATA_END)[0];
    let (footer, last) = of_kind(&log, FOOTER)[0];
    let data = "the checksum of the data does not match: something outside the chunks has changed";
    is_told(
        &flipped(&log, end + 9, 1),
        &all(),
        &[(end, data, END), (footer, "the checksum of the summary does not match", END)][..1],
    );
    let summary = "the checksum of the summary does not match";
    is_told(&flipped(&log, last - 1, 1), &all(), &[(footer, summary, END)]);
    let magic = "the file does not end as an MCAP file does";
    is_told(&flipped(&log, last + 3, 1), &all(), &[(last, magic, END)]);
    is_told(&log[..last + 3], &all(), &[(last, magic, END)]);
    is_told(&log[..last], &all(), &[(last, magic, END)]);
    let behind = "the footer points behind the end of the file";
    let far = with(&log, footer + 9, &(footer as u64 + 1).to_le_bytes());
    is_told(&far, &all(), &[(footer, behind, END)]);
    // The record that ends the data, gone.
    let mut without_end = log.clone();
    without_end.drain(end..end + 13);
    let by = |at: usize| at - 13;
    let start = u64::from_le_bytes(log[footer + 9..footer + 17].try_into().unwrap());
    let moved = with(&without_end, by(footer) + 9, &(start - 13).to_le_bytes());
    let (_, walked) = recovered(&moved);
    let said: Vec<&str> = walked.damage.iter().map(|d| &d.what[..]).collect();
    assert_eq!(said, [summary, "the record that ends the data is missing"]);
}

#[test]
fn messages_are_counted_and_compared_with_the_recording_s_own_count() {
    let options = || WriteOptions::new().calculate_summary_section_crc(false);
    let log = recorded(options());
    is_told(&log, &all(), &[]);
    let (statistics, _) = of_kind(&log, STATISTICS)[0];
    let (footer, _) = of_kind(&log, FOOTER)[0];
    let count = log[statistics + 9..statistics + 17].try_into().unwrap();
    assert_eq!(u64::from_le_bytes(count), ALL as u64);
    let lie = with(&log, statistics + 9, &41_u64.to_le_bytes());
    let what = "40 messages were read, 41 were written by its statistics";
    is_told(&lie, &all(), &[(footer, what, END)]);
    // What was left out is not counted, and with other damage the difference is no news.
    let (start, _) = chunks(&lie)[3];
    let what = "a chunk is left out: its checksum does not match";
    is_told(
        &flipped(&lie, start + 9 + 24, 1),
        &without(CHUNKS - 1),
        &[(start, what, (Some(29), None))],
    );
}

#[test]
fn a_record_that_contradicts_itself_is_passed_over_and_no_other() {
    let options = || {
        WriteOptions::new()
            .use_chunks(false)
            .compression(None)
            .calculate_data_section_crc(false)
            .calculate_summary_section_crc(false)
    };
    let log = recorded(options());
    let at = of_kind(&log, MESSAGE);
    assert_eq!(at.len(), ALL);
    let (start, end) = at[17];
    let left = messages((0..ALL).filter(|&i| i != 17));
    let hole = (Some(16), Some(18));
    // No record starts there.
    let zeroed = with(&log, start, &vec![0; end - start]);
    is_told(&zeroed, &left, &[(start, "no record starts here", hole)]);
    let far = 1_u64 << 62;
    let rest = log.len() - start - 9;
    let claims = format!("record 0x05 claims {far} bytes, {rest} left");
    is_told(&with(&log, start + 1, &far.to_le_bytes()), &left, &[(start, &claims, hole)]);
    // A length within the file that reaches past its end.
    let long = log.len() as u64 - 1;
    let cut = format!("record 0x05 is cut off: {long} bytes claimed, {rest} left");
    is_told(&with(&log, start + 1, &long.to_le_bytes()), &left, &[(start, &cut, hole)]);
    let short = "record 0x05 contradicts itself";
    is_told(&with(&log, start + 1, &3_u64.to_le_bytes()), &left, &[(start, short, hole)]);
    // Foreign bytes between two records cost none.
    let mut foreign = log.clone();
    foreign.splice(start..start, [0x77; 100]);
    let claims =
        format!("record 0x77 claims {} bytes, {} left", 0x7777_7777_7777_7777_u64, rest + 100);
    is_told(&foreign, &all(), &[(start, &claims, (Some(16), Some(17)))]);
    // What a declaration says of its own length.
    for (opcode, n) in [(SCHEMA, 2), (CHANNEL, 4)] {
        let (start, _) = of_kind(&log, opcode)[0];
        let what = format!("record {opcode:#04x} cannot be read");
        let huge = with(&log, start + 9 + n, &[0xff; 4]);
        is_told(&huge, &all(), &[(start, &what, (None, Some(0)))]);
    }
}

#[test]
fn records_in_a_chunk_that_cannot_be_read_are_counted_and_the_others_kept() {
    let log = bare(WriteOptions::new().compression(None));
    let (start, end) = chunks(&log)[0];
    let inner = start + 9 + 40;
    assert_eq!(log[inner], SCHEMA);
    let two = with(&log, inner + 9 + 2, &[0xff; 4]);
    let what = "1 records in a chunk cannot be read";
    is_told(&two, &all(), &[(start, what, (Some(9), Some(10)))]);
    // The last one is longer than what is left of the chunk.
    let last = last_record(&log, inner, end);
    let what = "a chunk is left out: its records do not fit together";
    is_told(&flipped(&log, last + 2, 1), &without(0), &[(start, what, (None, Some(10)))]);
}

#[test]
fn a_chunk_whose_compression_is_no_text_is_left_out() {
    // Found by fuzzing: as text the name is longer than its bytes.
    let mut bytes = packed(None);
    let (start, end) = chunks(&bytes)[0];
    let body = start + 9;
    let mut chunk = bytes[body..body + 28].to_vec();
    chunk.extend(4_u32.to_le_bytes());
    chunk.extend([0xff; 4]);
    chunk.extend(0_u64.to_le_bytes());
    bytes.splice(body..end, chunk.iter().copied());
    bytes[start + 1..body].copy_from_slice(&(chunk.len() as u64).to_le_bytes());
    let name = "\\u{fffd}".repeat(4);
    let what = format!(
        "a chunk is left out: its compression `{name}` is unknown, expected zstd, lz4 or none"
    );
    let (notes, walked) = recovered(&bytes);
    assert_eq!(notes.messages, without(0));
    assert_eq!((walked.damage[0].at_byte, &walked.damage[0].what), (start as u64, &what));
}

#[test]
fn a_recording_that_starts_or_ends_as_none_does_says_so() {
    let log = packed(Some(Compression::Zstd));
    let magic = "its first eight bytes are not those of an MCAP file";
    is_told(&flipped(&log, 3, 1), &all(), &[(0, magic, (None, Some(0)))]);
    let cut = "the file ends without a footer: its recording was cut off";
    let (end, _) = of_kind(&log, DATA_END)[0];
    is_told(&log[..end], &all(), &[(end, cut, END)]);
    is_told(&log[..end + 8], &all(), &[(end, cut, END)]);
    is_told(&log[..8], &[], &[(8, cut, (None, None))]);
    is_told(&log[..5], &[], &[(0, magic, (None, None)), (8, cut, (None, None))]);
    is_told(&[], &[], &[(0, magic, (None, None)), (8, cut, (None, None))]);
}

#[test]
fn bytes_behind_the_end_are_damage() {
    let log = packed(Some(Compression::Zstd));
    let mut more = log.clone();
    more.extend([0xa5; 4096]);
    let what = "4096 bytes follow the end of the recording";
    is_told(&more, &all(), &[(log.len(), what, END)]);
}

#[test]
fn recording_behind_another_is_read_with_recovery() {
    for compression in PACKINGS {
        let log = packed(compression);
        let twice = [&log[..], &log].concat();
        let what = "another recording begins behind the end of this one: files were joined";
        let both = [all(), all()].concat();
        is_told(&twice, &both, &[(log.len(), what, (Some(ALL - 1), Some(0)))]);
    }
    // Channels of the second are its own.
    let log = packed(None);
    let mut other = bare(WriteOptions::new().compression(None));
    let topics: Vec<usize> = (0..other.len()).filter(|&i| other[i..].starts_with(b"/a")).collect();
    for at in topics {
        other[at + 1] = b'c';
    }
    let (notes, walked) = recovered(&[&log[..], &other].concat());
    assert_eq!(walked.damage.len(), 1, "{:?}", walked.damage);
    assert_eq!(notes.messages.len(), 2 * ALL);
    // Damage of the second is told at its place.
    let (start, _) = chunks(&log)[1];
    let cut = [&log[..], &flipped(&log, start + 9 + 24, 1)].concat();
    let (notes, walked) = recovered(&cut);
    assert_eq!(notes.messages, [all(), without(1)].concat());
    assert_eq!(walked.damage[1].at_byte as usize, log.len() + start);
    assert_eq!(walked.damage.len(), 2, "{:?}", walked.damage);
}

#[test]
fn private_record_of_any_length_is_passed_over() {
    for log in [bare(WriteOptions::new()), bare(WriteOptions::new().use_chunks(false))] {
        let at = records(&log)[1].1;
        for opcode in [0x80, 0x9b, 0xff] {
            for length in 0..10_usize {
                let record =
                    [&[opcode][..], &(length as u64).to_le_bytes(), &vec![7; length]].concat();
                let mut bytes = log.clone();
                bytes.splice(at..at, record);
                is_told(&bytes, &all(), &[]);
            }
        }
    }
}
