//! What a recording says of itself at its end: its channels, how many messages each has, and what is attached.

use crate::{
    codec::OwnedSchema,
    error::BagError,
    record::{self, Channel, HEAD, Record, op},
};
use mcap::records::{AttachmentIndex, Record as Account};
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

/// The summary of a file, whole; none where it has no such one.
fn summary(file: &mut File) -> Option<Vec<u8>> {
    let length = file.metadata().ok()?.len();
    let mut end = [0; END as usize];
    let footer_start = length.checked_sub(END)?;
    file.seek(SeekFrom::Start(footer_start)).ok()?;
    file.read_exact(&mut end).ok()?;
    if end[0] != op::FOOTER || !end.ends_with(mcap::MAGIC) {
        return None;
    }
    let Some(Account::Footer(footer)) = record::account(op::FOOTER, &end[HEAD..HEAD + 20]) else {
        return None;
    };
    let (start, crc) = (footer.summary_start, footer.summary_crc);
    let size = footer_start.checked_sub(start).filter(|n| start > 0 && *n <= MOST_SUMMARY)?;
    let mut bytes = vec![0; size as usize];
    file.seek(SeekFrom::Start(start)).ok()?;
    file.read_exact(&mut bytes).ok()?;
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&bytes);
    hasher.update(&end[..HEAD + 16]);
    (crc == 0 || hasher.finalize() == crc).then_some(bytes)
}

/// The records of a summary, by opcode and content; none in the place of one that is cut off.
fn records(bytes: &[u8]) -> impl Iterator<Item = Option<(u8, &[u8])>> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let (head, behind) = rest.split_first_chunk::<HEAD>()?;
        let (opcode, length) = record::head_of(*head);
        let content = usize::try_from(length).ok();
        let content = content.and_then(|length| behind.split_at_checked(length));
        rest = content.map_or(&[], |(_, next)| next);
        Some(content.map(|(content, _)| (opcode, content)))
    })
}

/// The channels of a file by its own summary, in the order of their numbers; none where it has no whole one. It is a claim: what is in
/// the file is known when it has been read.
pub fn announced(path: &Path) -> Option<Vec<Announced>> {
    let bytes = summary(&mut File::open(path).ok()?)?;
    let (mut schemas, mut channels, mut counts) = (BTreeMap::new(), BTreeMap::new(), None);
    for record in records(&bytes) {
        let (opcode, content) = record?;
        match record::parse(opcode, content)? {
            Record::Schema(schema) => drop(schemas.insert(schema.id, OwnedSchema::from(schema))),
            Record::Channel(channel) => drop(channels.insert(channel.id, channel)),
            _ if opcode == op::STATISTICS => counts = record::account(opcode, content),
            _ => {}
        }
    }
    let Some(Account::Statistics(counts)) = counts else {
        return None;
    };
    let announced = channels.into_values().map(|channel| {
        let schema = schemas.get(&channel.schema_id).cloned();
        let count = counts.channel_message_counts.get(&channel.id);
        let count = count.copied().unwrap_or(0);
        (channel, schema, count)
    });
    Some(announced.collect())
}

/// When the first message of a file was received, in ns since 1970, by its own summary; none where it has no whole one, or its clock stood
/// before the year 2000: it says how long ago something was switched on, not what day it is.
pub fn begins_ns(path: &Path) -> Option<u64> {
    const YEAR_2000_NS: u64 = 946_684_800_000_000_000;
    let bytes = summary(&mut File::open(path).ok()?)?;
    let counts = records(&bytes).flatten().find_map(|(opcode, content)| {
        match record::account(opcode, content) {
            Some(Account::Statistics(counts)) if counts.message_count > 0 => Some(counts),
            _ => None,
        }
    });
    Some(counts?.message_start_time).filter(|ns| *ns >= YEAR_2000_NS)
}

/// What is attached to a file under `name`, by its summary; none where there is no such attachment, or no whole summary.
///
/// # Errors
/// [`BagError::Io`]; [`BagError::Damaged`] if the attachment is not where the summary says, or not what its checksum says.
pub fn attachment(path: &Path, name: &str) -> Result<Option<Vec<u8>>, BagError> {
    let io = |e| BagError::io(path, e);
    let mut file = File::open(path).map_err(io)?;
    let length = file.metadata().map_err(io)?.len();
    let bytes = summary(&mut file).unwrap_or_default();
    let index = records(&bytes).flatten().find_map(|(opcode, content)| {
        match record::account(opcode, content) {
            Some(Account::AttachmentIndex(index)) if index.name == name => Some(index),
            _ => None,
        }
    });
    let Some(index) = index else {
        return Ok(None);
    };
    let damaged = || BagError::Damaged {
        path: path.to_owned(),
        at_byte: index.offset,
        what: format!("`{name}` is not what the summary says"),
    };
    let end = index.offset.checked_add(index.length);
    if end.is_none_or(|end| end > length) {
        return Err(damaged());
    }
    file.seek(SeekFrom::Start(index.offset)).map_err(io)?;
    let mut record = vec![0; index.length as usize];
    file.read_exact(&mut record).map_err(io)?;
    let alone = AttachmentIndex { offset: 0, ..index.clone() };
    let attachment = mcap::read::attachment(&record, &alone).map_err(|_| damaged())?;
    Ok(Some(attachment.data.into_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Writer;
    use std::io::Cursor;

    fn with_attachment(text: &[u8]) -> Vec<u8> {
        let mut writer = Writer::new(Cursor::new(Vec::new()), "tests").unwrap();
        let schema = ("text", "ros2msg", "string data");
        let channel = writer.channel("/a", "cdr", schema).unwrap();
        writer.message(channel, 0, 1, b"one").unwrap();
        writer.attach("notes.txt", "text/plain", text).unwrap();
        writer.finish().unwrap().into_inner()
    }

    #[test]
    fn what_is_attached_comes_back_and_a_changed_byte_of_it_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.mcap");
        let mut bytes = with_attachment(b"seen on the way");
        std::fs::write(&path, &bytes).unwrap();
        let found = attachment(&path, "notes.txt").unwrap();
        assert_eq!(found.as_deref(), Some(&b"seen on the way"[..]));
        assert_eq!(attachment(&path, "other.txt").unwrap(), None);
        assert_eq!(announced(&path).unwrap().len(), 1);
        let at = bytes.windows(4).position(|w| w == b"seen").unwrap();
        bytes[at] ^= 1;
        std::fs::write(&path, &bytes).unwrap();
        let error = attachment(&path, "notes.txt").unwrap_err().to_string();
        assert!(error.contains("`notes.txt` is not what"), "{error}");
        bytes.truncate(bytes.len() - 1);
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(attachment(&path, "notes.txt").unwrap(), None);
    }

    #[test]
    fn channels_are_announced_with_their_counts_by_a_whole_summary_alone() {
        let mut writer = Writer::new(Cursor::new(Vec::new()), "tests").unwrap();
        let mut channel = |topic: &str, name: &str| {
            writer.channel(topic, "cdr", (name, "ros2msg", "string data")).unwrap()
        };
        let (a, _, c) = (channel("/a", "lab/A"), channel("/b", "lab/B"), channel("/c", "lab/A"));
        for (channel, n) in [(a, 3), (c, 5)] {
            (0..n).for_each(|i| writer.message(channel, i, 1, b"x").unwrap());
        }
        let bytes = writer.finish().unwrap().into_inner();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.mcap");
        let of = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            announced(&path)
        };
        let found = of(&bytes).unwrap();
        let told: Vec<_> = (found.iter())
            .map(|(c, s, n)| (&c.topic[..], s.as_ref().map(|s| &s.name[..]), *n))
            .collect();
        let (lab_a, lab_b) = (Some("lab/A"), Some("lab/B"));
        assert_eq!(told, [("/a", lab_a, 3), ("/b", lab_b, 0), ("/c", lab_a, 5)]);
        // Any byte of the summary, the footer or the magic.
        let footer = bytes.len() - END as usize;
        let start = u64::from_le_bytes(bytes[footer + 9..footer + 17].try_into().unwrap()) as usize;
        for at in start..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            assert!(of(&changed).is_none(), "byte {at}");
        }
        assert!(of(&bytes[..bytes.len() - 1]).is_none());
        assert!(of(&bytes[..20]).is_none() && of(&[]).is_none());
        assert!(announced(&folder.path().join("none.mcap")).is_none());
        // Without a checksum it is read, as far as its records go.
        let mut unchecked = bytes.clone();
        unchecked[footer + 25..footer + 29].fill(0);
        assert_eq!(of(&unchecked).unwrap().len(), 3);
        unchecked[start + 8] = 1;
        assert!(of(&unchecked).is_none(), "a record longer than the summary");
        // A footer without a summary, and one that points behind itself.
        for start in [0, footer as u64 + 1] {
            let mut without = bytes.clone();
            without[footer + 9..footer + 17].copy_from_slice(&start.to_le_bytes());
            without[footer + 25..footer + 29].fill(0);
            assert!(of(&without).is_none());
        }
    }

    #[test]
    fn an_attachment_that_is_not_where_the_summary_says_is_damage() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.mcap");
        let bytes = with_attachment(b"seen on the way");
        let footer = bytes.len() - END as usize;
        let start = u64::from_le_bytes(bytes[footer + 9..footer + 17].try_into().unwrap()) as usize;
        // The index of an attachment: opcode 10, then its offset and its length.
        let mut at = start;
        while bytes[at] != 10 {
            at += HEAD + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        }
        let (offset, length) = (at + HEAD, at + HEAD + 8);
        let number = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
        let rest = bytes.len() as u64 - number(offset);
        for (place, value) in [(length, rest), (length, rest + 1), (length, u64::MAX), (offset, 8)]
        {
            let mut changed = bytes.clone();
            changed[place..place + 8].copy_from_slice(&value.to_le_bytes());
            changed[footer + 25..footer + 29].fill(0);
            std::fs::write(&path, &changed).unwrap();
            let error = attachment(&path, "notes.txt").unwrap_err();
            assert!(matches!(error, BagError::Damaged { .. }), "{error}");
        }
        let error = attachment(&folder.path().join("none.mcap"), "notes.txt").unwrap_err();
        assert!(matches!(error, BagError::Io { .. }));
    }
}
