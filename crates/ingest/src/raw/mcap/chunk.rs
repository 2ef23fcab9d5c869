//! Chunks: the records within, as far as they can be read.

use super::record::{Fields, HEAD, op};
use mcap::{
    McapError,
    sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

/// Longest record that is read; a longer one can be no message that we want.
pub(crate) const MOST_RECORD: usize = 32 << 20;
/// Longest chunk that is read, compressed.
pub(crate) const MOST_CHUNK: u64 = 512 << 20;

/// A chunk's own account of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Head {
    uncompressed_size: u64,
    crc: u32,
    compression: String,
    compressed_size: u64,
}

/// Gives every record of a chunk to `each`, in order.
///
/// `content` is what there is of the chunk: all of it, or what stands before the end of a cut file.
/// Uncompressed chunks are walked here first, because the container crate trusts their lengths.
///
/// # Errors
/// A sentence that says why the chunk cannot be read to its end; records before that were given.
pub(crate) fn records(content: &[u8], mut each: impl FnMut(u8, &[u8])) -> Result<(), String> {
    let mut fields = Fields(content);
    let head = head(&mut fields).ok_or("its chunk header cannot be read")?;
    let claimed = usize::try_from(head.compressed_size).unwrap_or(usize::MAX);
    let data = &fields.0[..claimed.min(fields.0.len())];
    let cut = data.len() < claimed;
    if head.compression.is_empty() && (cut || !frames_fit(data)) {
        let mut rest = data;
        while let Some((opcode, record, after)) = split_record(rest) {
            each(opcode, record);
            rest = after;
        }
        return Err(if cut {
            "its end is missing"
        } else {
            "its records do not fit together"
        }
        .to_owned());
    }
    decompressed(&head, data, &mut each).map_err(|e| match e {
        _ if cut => "its end is missing".to_owned(),
        McapError::BadChunkCrc { .. } => "its checksum does not match".to_owned(),
        e => format!("it cannot be unpacked ({e})"),
    })
}

fn head(fields: &mut Fields<'_>) -> Option<Head> {
    fields.u64()?;
    fields.u64()?;
    Some(Head {
        uncompressed_size: fields.u64()?,
        crc: fields.u32()?,
        compression: fields.text()?,
        compressed_size: fields.u64()?,
    })
}

/// The first record of `bytes`: opcode, content, what follows.
fn split_record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (&opcode, rest) = bytes.split_first()?;
    let length = Fields(rest).u64()?;
    let length = usize::try_from(length).ok()?;
    let (content, after) = rest[HEAD - 1..].split_at_checked(length)?;
    Some((opcode, content, after))
}

fn frames_fit(mut bytes: &[u8]) -> bool {
    while let Some((_, _, after)) = split_record(bytes) {
        bytes = after;
    }
    bytes.is_empty()
}

/// Reads a chunk through the container crate, which unpacks it and checks its checksum.
fn decompressed(
    head: &Head,
    data: &[u8],
    each: &mut impl FnMut(u8, &[u8]),
) -> Result<(), McapError> {
    let compression = head.compression.as_bytes();
    let length = 8 + 8 + 8 + 4 + 4 + compression.len() + 8 + data.len();
    let mut start = vec![op::CHUNK];
    start.extend((length as u64).to_le_bytes());
    start.extend([0; 16]);
    start.extend(head.uncompressed_size.to_le_bytes());
    start.extend(head.crc.to_le_bytes());
    start.extend((compression.len() as u32).to_le_bytes());
    start.extend(compression);
    start.extend((data.len() as u64).to_le_bytes());

    // A record within cannot be longer than all of them together claim to be.
    let most = usize::try_from(head.uncompressed_size).unwrap_or(MOST_RECORD);
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(most.clamp(1 << 16, MOST_RECORD));
    let mut reader = LinearReader::new_with_options(options);
    let mut input = [start.as_slice(), data].into_iter();
    let mut current: &[u8] = input.next().unwrap_or_default();
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::Record { data, opcode } => each(opcode, data),
            LinearReadEvent::ReadRequest(wanted) => {
                if current.is_empty() {
                    current = input.next().unwrap_or_default();
                }
                let n = wanted.clamp(1, 1 << 20).min(current.len());
                reader.insert(n).copy_from_slice(&current[..n]);
                reader.notify_read(n);
                current = &current[n..];
            }
        }
    }
    Ok(())
}
