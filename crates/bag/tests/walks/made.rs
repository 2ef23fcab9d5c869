//! Recordings of known records at known places, and who notes what is read of them.

use maveric_bag::{BagError, Channel, Metadata, Record, Visitor, Walk, Walked, walk_from};
use mcap::{Compression, WriteOptions, records::MessageHeader};
use std::{collections::BTreeMap, io::Cursor, path::Path};

pub(crate) use crate::records::{CHANNEL, CHUNK, FOOTER, SCHEMA, chunks, of_kind, records};

pub(crate) const MESSAGE: u8 = 5;
pub(crate) const MESSAGE_INDEX: u8 = 7;
pub(crate) const STATISTICS: u8 = 11;
pub(crate) const DATA_END: u8 = 15;

/// Chunks of a recording, and messages of each.
pub(crate) const CHUNKS: usize = 4;
pub(crate) const EACH: usize = 10;
pub(crate) const ALL: usize = CHUNKS * EACH;

/// A message as it was heard: its channel, its time, its bytes.
pub(crate) type Heard = (u16, u64, Vec<u8>);

pub(crate) const PACKINGS: [Option<Compression>; 3] =
    [Some(Compression::Zstd), Some(Compression::Lz4), None];

/// Message `i`: two channels in turn, one in ten microseconds.
pub(crate) fn message(i: usize) -> Heard {
    let text = format!("{{\"i\":{i},\"v\":[{},2.25,\"{}\"]}}", i * i, "xyz".repeat(i % 5));
    ((i % 2) as u16 + 1, time(i), text.into_bytes())
}

pub(crate) fn time(i: usize) -> u64 {
    10_000 * (i as u64 + 1)
}

pub(crate) fn messages(of: impl IntoIterator<Item = usize>) -> Vec<Heard> {
    of.into_iter().map(message).collect()
}

/// A recording of [`CHUNKS`] chunks, with named texts behind the first.
pub(crate) fn recorded(options: WriteOptions) -> Vec<u8> {
    recorded_of(options, message)
}

/// A recording of other messages.
pub(crate) fn recorded_of(options: WriteOptions, message: impl Fn(usize) -> Heard) -> Vec<u8> {
    let mut out = options.profile("lab").library("tests").create(Cursor::new(Vec::new())).unwrap();
    let none = BTreeMap::new();
    for topic in ["/a", "/b"] {
        let name = format!("lab.X{}", &topic[1..]);
        let schema = out.add_schema(&name, "jsonschema", b"{}").unwrap();
        out.add_channel(schema, topic, "json", &none).unwrap();
    }
    for i in 0..ALL {
        let (channel_id, log_time, data) = message(i);
        let head =
            MessageHeader { channel_id, sequence: i as u32, log_time, publish_time: log_time + 1 };
        out.write_to_known_channel(&head, &data).unwrap();
        if (i + 1).is_multiple_of(EACH) {
            out.flush().unwrap();
        }
        if i + 1 == EACH {
            let metadata = BTreeMap::from([("who".to_owned(), "P07".to_owned())]);
            let name = "drive".to_owned();
            out.write_metadata(&mcap::records::Metadata { name, metadata }).unwrap();
        }
    }
    out.finish().unwrap();
    out.into_inner().into_inner()
}

pub(crate) fn packed(compression: Option<Compression>) -> Vec<u8> {
    recorded(WriteOptions::new().compression(compression))
}

/// Without a checksum of anything and without accounts of what is in it.
pub(crate) fn bare(options: WriteOptions) -> Vec<u8> {
    let options = options
        .calculate_chunk_crcs(false)
        .calculate_data_section_crc(false)
        .calculate_summary_section_crc(false)
        .emit_message_indexes(false)
        .emit_statistics(false)
        .emit_summary_offsets(false)
        .repeat_channels(false)
        .repeat_schemas(false);
    recorded(options)
}

/// Where the last record of a chunk begins, of which the first begins at `first`.
pub(crate) fn last_record(log: &[u8], first: usize, end: usize) -> usize {
    let (mut at, mut last) = (first, first);
    while at < end {
        last = at;
        let length = log[at + 1..at + 9].try_into().unwrap();
        at += 9 + usize::try_from(u64::from_le_bytes(length)).unwrap();
    }
    last
}

/// A copy with some bytes put over those at `at`.
pub(crate) fn with(bytes: &[u8], at: usize, put: &[u8]) -> Vec<u8> {
    let mut copy = bytes.to_vec();
    copy[at..at + put.len()].copy_from_slice(put);
    copy
}

/// A copy in which one byte has changed.
pub(crate) fn flipped(bytes: &[u8], at: usize, bits: u8) -> Vec<u8> {
    with(bytes, at, &[bytes[at] ^ bits])
}

/// Notes what a walk gives.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Notes {
    pub(crate) messages: Vec<Heard>,
    pub(crate) passed_over: usize,
    pub(crate) headers: Vec<(String, String)>,
    pub(crate) schemas: Vec<(u16, String, String, Vec<u8>)>,
    pub(crate) channels: Vec<Channel>,
    pub(crate) metadata: Vec<Metadata>,
    mark: (usize, usize),
}

impl Visitor for Notes {
    fn record(&mut self, record: Record<'_>) {
        match record {
            Record::Header(profile, library) => self.headers.push((profile, library)),
            Record::Schema(s) => self.schemas.push((s.id, s.name, s.encoding, s.data.to_vec())),
            Record::Channel(channel) => self.channels.push(channel),
            Record::Message(m) => self.messages.push((m.channel, m.log_ns, m.data.to_vec())),
            Record::Metadata(metadata) => self.metadata.push(metadata),
            Record::Other => {}
        }
    }

    fn passed_over(&mut self) {
        self.passed_over += 1;
    }

    fn mark(&mut self) {
        self.mark = (self.messages.len(), self.passed_over);
    }

    fn roll_back(&mut self) {
        self.messages.truncate(self.mark.0);
        self.passed_over = self.mark.1;
    }
}

pub(crate) const RECOVER: Walk = Walk { recover: true, hash: false };

pub(crate) fn recovered(bytes: &[u8]) -> (Notes, Walked) {
    let mut notes = Notes::default();
    let walked = walk_from(Path::new("-"), Cursor::new(bytes), RECOVER, &mut notes).unwrap();
    (notes, walked)
}

/// Walks up to the first damage: where it is and what is said of it; none where all is whole.
pub(crate) fn refusal(bytes: &[u8]) -> Option<(u64, String)> {
    let mut notes = Notes::default();
    let how = Walk::default();
    match walk_from(Path::new("-"), Cursor::new(bytes), how, &mut notes) {
        Ok(walked) => {
            assert_eq!(walked, Walked::default());
            None
        }
        Err(BagError::Damaged { at_byte, what, .. }) => Some((at_byte, what)),
        Err(other) => panic!("{other}"),
    }
}
