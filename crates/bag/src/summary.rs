//! What a recording says of itself at its end: its channels and how many messages each has.

use crate::{
    codec::OwnedSchema,
    record::{self, Channel, HEAD, Record, op},
};
use std::{
    collections::BTreeMap,
    fs::File,
    io::{Read, Seek, SeekFrom},
    path::Path,
};

/// Longest summary that is read, in bytes.
const MOST_SUMMARY: u64 = 64 << 20;
/// Length of a footer record with the magic behind it.
const END: u64 = HEAD as u64 + 20 + mcap::MAGIC.len() as u64;

/// A channel with what its messages mean and how many there are.
pub type Announced = (Channel, Option<OwnedSchema>, u64);

/// The channels of a file by its own summary, in the order of their numbers; none where it has no whole one. It is a claim: what is in
/// the file is known when it has been read.
pub fn announced(path: &Path) -> Option<Vec<Announced>> {
    let mut file = File::open(path).ok()?;
    let length = file.metadata().ok()?.len();
    let mut end = [0; END as usize];
    let at = length.checked_sub(END)?;
    file.seek(SeekFrom::Start(at)).ok()?;
    file.read_exact(&mut end).ok()?;
    if end[0] != op::FOOTER || !end.ends_with(mcap::MAGIC) {
        return None;
    }
    let (start, crc) = record::footer(&end[HEAD..])?;
    let size = at
        .checked_sub(start)
        .filter(|n| start > 0 && *n <= MOST_SUMMARY)?;
    let mut bytes = vec![0; size as usize];
    file.seek(SeekFrom::Start(start)).ok()?;
    file.read_exact(&mut bytes).ok()?;
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&bytes);
    hasher.update(&end[..HEAD + 16]);
    if crc != 0 && hasher.finalize() != crc {
        return None;
    }
    let (mut schemas, mut channels, mut counts) = (BTreeMap::new(), BTreeMap::new(), None);
    let mut rest = &bytes[..];
    while let Some((head, behind)) = rest.split_first_chunk::<HEAD>() {
        let [opcode, length @ ..] = *head;
        let length = usize::try_from(u64::from_le_bytes(length)).ok()?;
        let (content, next) = behind.split_at_checked(length)?;
        rest = next;
        match record::parse(opcode, content)? {
            Record::Schema(schema) => drop(schemas.insert(schema.id, OwnedSchema::from(schema))),
            Record::Channel(channel) => drop(channels.insert(channel.id, channel)),
            _ if opcode == op::STATISTICS => counts = Some(record::channel_counts(content)?),
            _ => {}
        }
    }
    let counts = counts?;
    let announced = channels.into_values().map(|channel| {
        let schema = schemas.get(&channel.schema_id).cloned();
        let count = counts.get(&channel.id).copied().unwrap_or(0);
        (channel, schema, count)
    });
    Some(announced.collect())
}
