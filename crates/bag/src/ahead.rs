//! A file read once from start to end on a thread of its own: hashed, and its chunks unpacked and summed while those before
//! them are read.

use crate::{
    chunk::{Head, MOST_ROOM},
    record::{HEAD, op},
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
        Some(Self {
            chunks: Some(chunks),
            used,
            next: None,
            thread: Some(thread),
        })
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
    let mut at = magic.len() as u64;
    loop {
        let mut head = [0; HEAD];
        source.read(&mut head)?;
        let [opcode, rest @ ..] = head;
        let record = u64::from_le_bytes(rest);
        let body = at + HEAD as u64;
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
        at = next;
    }
}
