//! Streams over the files of a recording and over its damage.

use crate::made::{
    ALL, CHANNEL, EACH, MESSAGE, RECOVER, bare, chunks, flipped, last_record, message, of_kind,
    packed, recorded, refusal, time, with,
};
use maveric_bag::{Channel, Message, OwnedSchema, Streams, Take, Walk, read_streams};
use mcap::{WriteOptions, records::MessageHeader};
use std::{collections::BTreeMap, io::Cursor};

/// Times of the messages of a stream, and which of the recording's they are.
#[derive(Debug, Default)]
struct Times {
    taken: Vec<(u64, u32)>,
    mark: usize,
}

impl Take for Times {
    fn take(&mut self, message: Message<'_>, nth: u32) {
        self.taken.push((message.log_ns, nth));
    }

    fn mark(&mut self) {
        self.mark = self.taken.len();
    }

    fn roll_back(&mut self) {
        self.taken.truncate(self.mark);
    }
}

/// The streams of files of these bytes.
fn streams(files: &[Vec<u8>], how: Walk) -> Streams<Times> {
    let folder = tempfile::tempdir().unwrap();
    let paths: Vec<_> = (files.iter().enumerate())
        .map(|(i, bytes)| {
            let path = folder.path().join(format!("{i}.mcap"));
            std::fs::write(&path, bytes).unwrap();
            path
        })
        .collect();
    read_streams(&paths, how, |_: &Channel, _: Option<&OwnedSchema>| Times::default()).unwrap()
}

fn times(streams: &Streams<Times>, i: usize) -> Vec<u64> {
    streams.streams[i].taken.taken.iter().map(|t| t.0).collect()
}

/// Times of the messages of channel 1 or 2 that `there` keeps.
fn of_channel(channel: u16, there: impl Fn(usize) -> bool) -> Vec<u64> {
    let all = (0..ALL).filter(|&i| message(i).0 == channel && there(i));
    all.map(time).collect()
}

#[test]
fn a_recording_gives_its_streams_in_their_order_with_what_they_mean() {
    let found = streams(&[packed(None)], Walk::default());
    let topics: Vec<&str> = found.streams.iter().map(|s| &s.channel.topic[..]).collect();
    assert_eq!(topics, ["/a", "/b"]);
    assert_eq!(found.streams[1].schema.as_ref().unwrap().name, "lab.Xb");
    assert_eq!(times(&found, 0), of_channel(1, |_| true));
    assert_eq!(times(&found, 1), of_channel(2, |_| true));
    assert_eq!(found.streams[1].taken.taken[3].1, 8, "the eighth of the recording");
    assert_eq!((found.writer.as_deref(), found.first_ns), (Some("tests"), Some(time(0))));
    assert_eq!(found.metadata["drive"]["who"], "P07");
    assert_eq!((found.undeclared, found.too_long, found.walked.len()), (0, 0, 1));
}

/// A channel: its topic, name and text of its schema, its encoding, and the times of its messages.
type Declared<'a> = (&'a str, Option<(&'a str, &'a str)>, &'a str, &'a [u64]);

/// A file of these channels.
fn file(channels: &[Declared<'_>]) -> Vec<u8> {
    let mut out = WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
    let none = BTreeMap::new();
    for (n, (topic, schema, encoding, times)) in channels.iter().enumerate() {
        let schema = schema
            .map_or(0, |(name, text)| out.add_schema(name, "ros2msg", text.as_bytes()).unwrap());
        let id = n as u16 + 7;
        out.add_channel_with_id(id, schema, topic, encoding, &none).unwrap();
        for &log_time in *times {
            let head = MessageHeader { channel_id: id, sequence: 0, log_time, publish_time: 0 };
            out.write_to_known_channel(&head, b"x").unwrap();
        }
    }
    let name = "part".to_owned();
    let metadata = BTreeMap::from([("topic".to_owned(), channels[0].0.to_owned())]);
    out.write_metadata(&mcap::records::Metadata { name, metadata }).unwrap();
    out.finish().unwrap();
    out.into_inner().into_inner()
}

#[test]
fn channels_of_equal_topic_encoding_and_type_are_one_stream_over_files_and_within_one() {
    let x = Some(("lab/msg/X", "float64 x"));
    let first = file(&[("/a", x, "cdr", &[50, 60])]);
    for (second, same) in [
        (("/a", x, "cdr"), true),
        // The name is written in two ways.
        (("/a", Some(("lab/X", "float64 x")), "cdr"), true),
        (("/a", Some(("lab/msg/X", "float64 y")), "cdr"), false),
        (("/a", Some(("lab/msg/Y", "float64 x")), "cdr"), false),
        (("/b", x, "cdr"), false),
        (("/a", x, "ros1"), false),
        (("/a", None, "cdr"), false),
    ] {
        let (topic, schema, encoding) = second;
        let second = file(&[(topic, schema, encoding, &[40, 70])]);
        let found = streams(&[first.clone(), second], Walk::default());
        assert_eq!(found.streams.len(), if same { 1 } else { 2 }, "{topic} {schema:?} {encoding}");
        let all: Vec<u64> = (0..found.streams.len()).flat_map(|i| times(&found, i)).collect();
        assert_eq!(all, [50, 60, 40, 70]);
        assert_eq!((found.first_ns, found.walked.len()), (Some(40), 2));
        assert_eq!(found.metadata["part"]["topic"], "/a", "the first of its name");
    }
    let none = file(&[("/a", None, "cdr", &[1])]);
    assert_eq!(streams(&[none.clone(), none], Walk::default()).streams.len(), 1);
    // Two channels of one topic in one file, and of its next part.
    let twice = file(&[("/a", x, "cdr", &[1]), ("/a", x, "cdr", &[2])]);
    let found = streams(&[twice.clone(), twice], Walk::default());
    assert_eq!(found.streams.len(), 1);
    assert_eq!(times(&found, 0), [1, 2, 1, 2]);
}

#[test]
fn what_a_lost_chunk_gave_to_streams_is_taken_back() {
    let log = packed(None);
    for k in 1..4 {
        let (start, _) = chunks(&log)[k];
        let found = streams(&[flipped(&log, start + 9 + 24, 1)], RECOVER);
        for channel in [1, 2] {
            let left = of_channel(channel, |i| i / EACH != k);
            assert_eq!(times(&found, usize::from(channel) - 1), left);
        }
        assert_eq!(found.walked[0].damage.len(), 1);
    }
}

#[test]
fn what_only_a_lost_chunk_declares_is_believed_and_what_the_summary_repeats_more_so() {
    let options = || WriteOptions::new().compression(None);
    for log in [recorded(options()), bare(options())] {
        let (start, end) = chunks(&log)[0];
        // The last byte is one of a message: of a recording without checksums its length, so that nothing fits.
        let last = last_record(&log, start + 9 + 40, end);
        let found = streams(&[flipped(&log, last + 2, 1)], RECOVER);
        let topics: Vec<&str> = found.streams.iter().map(|s| &s.channel.topic[..]).collect();
        assert_eq!(topics, ["/a", "/b"]);
        for channel in [1, 2] {
            let left = of_channel(channel, |i| i >= EACH);
            assert_eq!(times(&found, usize::from(channel) - 1), left);
        }
        assert_eq!((found.undeclared, found.first_ns), (0, Some(time(EACH))));
    }
    // The topic is damaged where the first chunk declares it, and whole in the summary.
    let log = recorded(options());
    let (start, _) = chunks(&log)[0];
    let topic = start + log[start..].windows(2).position(|w| w == b"/a").unwrap();
    let found = streams(&[with(&log, topic, b"/z")], RECOVER);
    let topics: Vec<&str> = found.streams.iter().map(|s| &s.channel.topic[..]).collect();
    assert_eq!(topics, ["/a", "/b"]);
}

#[test]
fn messages_of_a_channel_that_nothing_declares_are_counted() {
    let plain = WriteOptions::new().use_chunks(false).compression(None);
    let log = bare(plain);
    let declared: Vec<usize> =
        (crate::made::of_kind(&log, crate::made::CHANNEL).iter()).map(|r| r.0).collect();
    assert_eq!(declared.len(), 2);
    // An opcode that nobody knows yet.
    let unknown = with(&log, declared[1], &[0x7f]);
    let found = streams(&[unknown], RECOVER);
    assert_eq!((found.streams.len(), found.undeclared), (1, ALL / 2));
    assert_eq!(times(&found, 0), of_channel(1, |_| true));
}

#[test]
fn channel_declared_again_for_another_topic_is_damage() {
    let plain = || bare(WriteOptions::new().use_chunks(false).compression(None));
    let log = plain();
    let (start, end) = of_kind(&log, CHANNEL)[0];
    let declaration = log[start..end].to_vec();
    let topic = declaration.windows(2).position(|w| w == b"/a").unwrap();
    let other = with(&declaration, topic, b"/c");
    let (at, _) = of_kind(&log, MESSAGE)[20];
    let inserted = |record: &[u8]| {
        let mut bytes = log.clone();
        bytes.splice(at..at, record.iter().copied());
        bytes
    };
    // The same again is no news.
    assert_eq!(refusal(&inserted(&declaration)), None);
    let bytes = inserted(&other);
    let what = "channel 1 is declared again: for topic `/c`, before for `/a`";
    assert_eq!(refusal(&bytes), Some((at as u64, what.to_owned())));
    let found = streams(&[bytes], RECOVER);
    let topics: Vec<&str> = found.streams.iter().map(|s| &s.channel.topic[..]).collect();
    assert_eq!(topics, ["/a", "/b", "/c"]);
    assert_eq!(times(&found, 0), of_channel(1, |i| i < 20));
    assert_eq!(times(&found, 1), of_channel(2, |_| true));
    assert_eq!(times(&found, 2), of_channel(1, |i| i >= 20));
    assert_eq!(found.walked[0].damage.len(), 1);
    // In a chunk it is found too.
    let log = recorded(WriteOptions::new().compression(None).calculate_chunk_crcs(false));
    let (start, end) = chunks(&log)[0];
    let topic = (start..end).find(|&i| log[i..].starts_with(b"/b")).unwrap();
    let number = topic - 4 - 4;
    let bytes = with(&log, number, &[1, 0]);
    let (at, what) = refusal(&bytes).unwrap();
    assert_eq!(at, start as u64);
    assert!(what.starts_with("channel 1 is declared again"), "{what}");
}

#[test]
fn joined_recordings_keep_their_own_channels() {
    let first = file(&[("/a", None, "json", &[1, 2]), ("/b", None, "json", &[3])]);
    let second = file(&[("/b", None, "json", &[4, 5]), ("/c", None, "json", &[6])]);
    let found = streams(&[[first, second].concat()], RECOVER);
    let topics: Vec<&str> = found.streams.iter().map(|s| &s.channel.topic[..]).collect();
    assert_eq!(topics, ["/a", "/b", "/c"]);
    assert_eq!(times(&found, 0), [1, 2]);
    assert_eq!(times(&found, 1), [3, 4, 5]);
    assert_eq!(times(&found, 2), [6]);
    assert_eq!(found.walked[0].damage.len(), 1);
}
