//! A file read once from start to end on a thread of its own: hashed, and its chunks unpacked and summed while those before
//! them are read.

use crate::{
    chunk::{Head, MOST_ROOM},
    record::{HEAD, head_of, op},
};
use std::{
    fs::File,
    io::{self, BufReader, Read},
    path::Path,
    sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel},
    thread::JoinHandle,
};
use zstd::bulk::Decompressor;

/// Length of a file from which a thread of its own is worth while, in bytes.
const WORTH_WHILE: u64 = 128 << 10;
/// Chunks that wait unpacked: with the one that is being read and the one that is being unpacked, all the memory there is.
const WAITING: usize = 2;
/// Longest packed chunk that is read ahead, in bytes.
const MOST_PACKED: u64 = 16 << 20;

/// A chunk that was read before it was asked for.
#[derive(Debug, Default)]
pub(crate) struct Fetched {
    /// Where its content begins in the file.
    body: u64,
    /// Its content.
    pub(crate) packed: Vec<u8>,
    /// What it unpacks to, and the checksum of that, where it was found out.
    pub(crate) unpacked: Vec<u8>,
    pub(crate) checksum: Option<u32>,
}

/// The chunks of a file in their order, as far as they are as their headers say.
pub(crate) struct Ahead {
    chunks: Option<Receiver<Fetched>>,
    used: Sender<Fetched>,
    next: Option<Fetched>,
    thread: Option<JoinHandle<io::Result<Option<blake3::Hash>>>>,
}

impl Ahead {
    /// Starts to read a file of `length` bytes; none where that is not worth while or not possible.
    pub(crate) fn start(path: &Path, length: u64, hash: bool) -> Option<Self> {
        if length < WORTH_WHILE {
            return None;
        }
        let file = File::open(path).ok()?;
        let (send, chunks) = sync_channel(WAITING);
        let (used, again) = channel();
        let run = move || {
            let mut source = Source {
                file: BufReader::with_capacity(1 << 17, file),
                hasher: hash.then(blake3::Hasher::new),
            };
            // What is not as it should be, the reader finds out.
            let _ = unpack(&mut source, length, &send, &again);
            drop(send);
            source.finish()
        };
        let thread = std::thread::Builder::new().spawn(run).ok()?;
        Some(Self { chunks: Some(chunks), used, next: None, thread: Some(thread) })
    }

    /// The chunk whose content begins at `body` and is `length` bytes, if it was read ahead.
    pub(crate) fn take(&mut self, body: u64, length: u64) -> Option<Fetched> {
        let chunks = self.chunks.as_ref()?;
        loop {
            let next = match self.next.take() {
                Some(next) => next,
                None => chunks.recv().ok()?,
            };
            if next.body == body && next.packed.len() as u64 == length {
                return Some(next);
            }
            if next.body > body {
                self.next = Some(next);
                return None;
            }
            self.give_back(next);
        }
    }

    /// Gives memory back for another chunk.
    pub(crate) fn give_back(&self, chunk: Fetched) {
        // Once all is read nobody needs it.
        let _ = self.used.send(chunk);
    }

    /// The hash of the whole file, if it was asked for.
    ///
    /// # Errors
    /// If the file cannot be read to its end.
    pub(crate) fn finish(mut self) -> io::Result<Option<blake3::Hash>> {
        self.chunks = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(hash)) => hash,
            _ => Err(io::Error::other("the thread that reads ahead has ended")),
        }
    }
}

impl Drop for Ahead {
    fn drop(&mut self) {
        // Without a receiver the thread ends at its next chunk.
        self.chunks = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A file that is hashed while it is read, if that is wanted.
struct Source {
    file: BufReader<File>,
    hasher: Option<blake3::Hasher>,
}

impl Source {
    fn read(&mut self, into: &mut [u8]) -> Option<()> {
        self.file.read_exact(into).ok()?;
        if let Some(hasher) = &mut self.hasher {
            hasher.update(into);
        }
        Some(())
    }

    fn pass_over(&mut self, length: u64) -> Option<()> {
        let Some(hasher) = &mut self.hasher else {
            return self.file.seek_relative(i64::try_from(length).ok()?).ok();
        };
        let mut part = Read::by_ref(&mut self.file).take(length);
        hasher.update_reader(&mut part).ok()?;
        (part.limit() == 0).then_some(())
    }

    fn finish(mut self) -> io::Result<Option<blake3::Hash>> {
        let Some(mut hasher) = self.hasher.take() else {
            return Ok(None);
        };
        hasher.update_reader(&mut self.file)?;
        Ok(Some(hasher.finalize()))
    }
}

/// Reads chunk after chunk, up to the first thing that is not as it should be.
fn unpack(
    source: &mut Source,
    length: u64,
    send: &SyncSender<Fetched>,
    again: &Receiver<Fetched>,
) -> Option<()> {
    let mut unpacker = Decompressor::new().ok()?;
    let mut magic = [0; mcap::MAGIC.len()];
    source.read(&mut magic)?;
    let mut offset = magic.len() as u64;
    loop {
        let mut head = [0; HEAD];
        source.read(&mut head)?;
        let (opcode, record) = head_of(head);
        let body = offset + HEAD as u64;
        let next = body.checked_add(record).filter(|next| *next <= length)?;
        if matches!(opcode, 0 | op::DATA_END | op::FOOTER) {
            return None;
        }
        if opcode == op::CHUNK && record <= MOST_PACKED {
            let mut chunk = again.try_recv().unwrap_or_default();
            (chunk.body, chunk.checksum) = (body, None);
            chunk.packed.resize(record as usize, 0);
            source.read(&mut chunk.packed)?;
            let of_chunk = Head::read(&chunk.packed)?;
            if let Some(data) = of_chunk.whole_zstd(&chunk.packed) {
                let size = of_chunk.uncompressed_size.min(MOST_ROOM) as usize;
                chunk.unpacked.resize(size, 0);
                let unpacked = unpacker.decompress_to_buffer(data, &mut chunk.unpacked[..]);
                if unpacked.ok()? == size {
                    chunk.checksum = Some(crc32fast::hash(&chunk.unpacked));
                }
            }
            send.send(chunk).ok()?;
        } else {
            source.pass_over(record)?;
        }
        offset = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mcap::{Compression, WriteOptions, records::MessageHeader};
    use std::{collections::BTreeMap, io::Cursor};

    /// A chunk: where its content begins, how long that is, and what it unpacks to.
    type Chunk = (u64, u64, Vec<u8>);

    /// Five chunks of 64 KiB that zstd packs to no less.
    fn log(compression: Option<Compression>) -> (Vec<u8>, Vec<Chunk>) {
        let options = WriteOptions::new().compression(compression);
        let mut out = options.create(Cursor::new(Vec::new())).unwrap();
        let channel_id = out.add_channel(0, "/a", "json", &BTreeMap::new()).unwrap();
        let mut state = 1_u64;
        for i in 0..5 {
            let noise = (0..8192).flat_map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state ^ (state >> 29)).to_le_bytes()
            });
            let head = MessageHeader { channel_id, sequence: i, log_time: 1, publish_time: 1 };
            let noise: Vec<u8> = noise.collect();
            out.write_to_known_channel(&head, &noise).unwrap();
            out.flush().unwrap();
        }
        out.finish().unwrap();
        let bytes = out.into_inner().into_inner();
        let (mut at, mut chunks) = (mcap::MAGIC.len(), Vec::new());
        while bytes[at] != op::FOOTER {
            let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
            let content = &bytes[at + HEAD..at + HEAD + length as usize];
            if bytes[at] == op::CHUNK {
                let account = Head::read(content).unwrap();
                let packed = account.whole_zstd(content);
                let size = account.uncompressed_size as usize;
                let unpacked = packed.map(|data| zstd::bulk::decompress(data, size).unwrap());
                chunks.push(((at + HEAD) as u64, length, unpacked.unwrap_or_default()));
            }
            at += HEAD + length as usize;
        }
        assert_eq!(chunks.len(), 5);
        (bytes, chunks)
    }

    fn on_disk(bytes: &[u8]) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        file
    }

    #[test]
    fn every_chunk_of_a_long_file_is_there_unpacked_with_its_checksum() {
        for (compression, is_zstd) in [(Some(Compression::Zstd), true), (None, false)] {
            let (bytes, chunks) = log(compression);
            let file = on_disk(&bytes);
            for hash in [false, true] {
                let mut ahead = Ahead::start(file.path(), bytes.len() as u64, hash).unwrap();
                for (body, length, unpacked) in &chunks {
                    let fetched = ahead.take(*body, *length).unwrap();
                    let packed = *body as usize..(*body + *length) as usize;
                    assert!(fetched.packed == bytes[packed]);
                    let checksum = is_zstd.then(|| crc32fast::hash(unpacked));
                    assert_eq!(fetched.checksum, checksum);
                    assert!(!is_zstd || fetched.unpacked == *unpacked);
                    ahead.give_back(fetched);
                }
                let expected = hash.then(|| blake3::hash(&bytes));
                assert_eq!(ahead.finish().unwrap(), expected);
            }
        }
    }

    #[test]
    fn a_chunk_is_given_to_who_asks_for_its_place_and_length_and_to_nobody_else() {
        let (bytes, chunks) = log(Some(Compression::Zstd));
        let file = on_disk(&bytes);
        let mut ahead = Ahead::start(file.path(), bytes.len() as u64, false).unwrap();
        let of = |i: usize| (chunks[i].0, chunks[i].1);
        // Before the first and between two: what comes next is kept.
        assert!(ahead.take(8, of(0).1).is_none());
        assert!(ahead.take(of(0).0, of(0).1).is_some());
        assert!(ahead.take(of(1).0 - 1, of(1).1).is_none());
        // A length of its own: passed over, as is what nobody asked for.
        assert!(ahead.take(of(1).0, of(1).1 + 1).is_none());
        assert!(ahead.take(of(3).0, of(3).1).is_some());
        assert!(ahead.take(of(2).0, of(2).1).is_none());
        assert!(ahead.take(of(4).0, of(4).1).is_some());
        assert!(ahead.take(of(4).0 + 1, 1).is_none());
    }

    #[test]
    fn a_short_file_and_one_that_is_not_there_are_not_read_ahead() {
        let file = on_disk(b"short");
        assert!(Ahead::start(file.path(), WORTH_WHILE - 1, true).is_none());
        assert!(Ahead::start(file.path(), WORTH_WHILE, true).is_some());
        let none = file.path().join("none");
        assert!(Ahead::start(&none, WORTH_WHILE, true).is_none());
    }

    #[test]
    fn what_is_not_as_it_should_be_ends_the_chunks_and_not_the_hash() {
        let (mut bytes, chunks) = log(Some(Compression::Zstd));
        let head = chunks[2].0 as usize - HEAD;
        bytes[head + 1..head + 9].fill(0xff);
        let file = on_disk(&bytes);
        let mut ahead = Ahead::start(file.path(), bytes.len() as u64, true).unwrap();
        for (body, length, _) in &chunks[..2] {
            assert!(ahead.take(*body, *length).is_some());
        }
        assert!(ahead.take(chunks[2].0, chunks[2].1).is_none());
        assert!(ahead.take(chunks[3].0, chunks[3].1).is_none());
        assert_eq!(ahead.finish().unwrap(), Some(blake3::hash(&bytes)));
        // A checksum is of what was unpacked, so a chunk that does not unpack has none.
        let (mut bytes, chunks) = log(Some(Compression::Zstd));
        let (body, length) = (chunks[1].0 as usize, chunks[1].1);
        bytes[body + 44..body + 60].fill(0);
        let file = on_disk(&bytes);
        let mut ahead = Ahead::start(file.path(), bytes.len() as u64, false).unwrap();
        assert!(ahead.take(chunks[0].0, chunks[0].1).is_some());
        assert!(ahead.take(body as u64, length).is_none_or(|f| f.checksum.is_none()));
    }
}
