//! Chunks unpacked ahead, on a thread of their own, while those before them are being read.

use crate::{
    chunk::{Head, MOST_ROOM},
    record::{HEAD, op},
};
use std::{
    fs::File,
    io::{BufReader, Read},
    path::Path,
    sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel},
    thread::JoinHandle,
};
use zstd::bulk::Decompressor;

/// Length of a file from which a thread of its own is worth while, in bytes.
const WORTH_WHILE: u64 = 128 << 10;
/// Chunks that wait unpacked: with the one that is being read and the one that is being unpacked, all the memory there is.
const WAITING: usize = 2;
/// Longest packed chunk that is unpacked ahead, in bytes.
const MOST_PACKED: u64 = 16 << 20;

/// A chunk that was unpacked before it was asked for.
struct Unpacked {
    /// Where its content begins in the file.
    body: u64,
    /// Length of its content.
    length: u64,
    bytes: Vec<u8>,
}

/// The chunks of a file in their order, as far as they are as their headers say.
pub(crate) struct Ahead {
    chunks: Option<Receiver<Unpacked>>,
    used: Sender<Vec<u8>>,
    next: Option<Unpacked>,
    thread: Option<JoinHandle<()>>,
}

impl Ahead {
    /// Starts to unpack a file of `length` bytes; none where that is not worth while or not possible.
    pub(crate) fn start(path: &Path, length: u64) -> Option<Self> {
        if length < WORTH_WHILE {
            return None;
        }
        let file = File::open(path).ok()?;
        let (send, chunks) = sync_channel(WAITING);
        let (used, again) = channel();
        let run = move || {
            unpack(file, length, &send, &again);
        };
        let thread = std::thread::Builder::new().spawn(run).ok()?;
        Some(Self {
            chunks: Some(chunks),
            used,
            next: None,
            thread: Some(thread),
        })
    }

    /// What the chunk whose content begins at `body` unpacks to, if it was unpacked ahead.
    pub(crate) fn take(&mut self, body: u64, length: u64) -> Option<Vec<u8>> {
        let chunks = self.chunks.as_ref()?;
        loop {
            let next = match self.next.take() {
                Some(next) => next,
                None => chunks.recv().ok()?,
            };
            if next.body == body && next.length == length {
                return Some(next.bytes);
            }
            if next.body > body {
                self.next = Some(next);
                return None;
            }
            self.give_back(next.bytes);
        }
    }

    /// Gives memory back for another chunk.
    pub(crate) fn give_back(&self, bytes: Vec<u8>) {
        // Once all is unpacked nobody needs it.
        let _ = self.used.send(bytes);
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

/// Unpacks chunk after chunk, up to the first thing that is not as it should be: what that is, the reader finds out.
fn unpack(
    file: File,
    length: u64,
    send: &SyncSender<Unpacked>,
    again: &Receiver<Vec<u8>>,
) -> Option<()> {
    let mut file = BufReader::with_capacity(1 << 16, file);
    let mut unpacker = Decompressor::new().ok()?;
    let mut packed = Vec::new();
    let mut magic = [0; mcap::MAGIC.len()];
    file.read_exact(&mut magic).ok()?;
    let mut at = magic.len() as u64;
    loop {
        let mut head = [0; HEAD];
        file.read_exact(&mut head).ok()?;
        let [opcode, rest @ ..] = head;
        let record = u64::from_le_bytes(rest);
        let body = at + HEAD as u64;
        let next = body.checked_add(record).filter(|next| *next <= length)?;
        if matches!(opcode, 0 | op::DATA_END | op::FOOTER) {
            return None;
        }
        if opcode == op::CHUNK && record <= MOST_PACKED {
            packed.resize(record as usize, 0);
            file.read_exact(&mut packed).ok()?;
            let of_chunk = Head::read(&packed)?;
            if let Some(data) = of_chunk.whole_zstd(&packed) {
                let mut bytes = again.try_recv().unwrap_or_default();
                let size = of_chunk.uncompressed_size.min(MOST_ROOM) as usize;
                bytes.resize(size, 0);
                let unpacked = unpacker.decompress_to_buffer(data, &mut bytes[..]).ok()?;
                if unpacked != size {
                    return None;
                }
                let chunk = Unpacked {
                    body,
                    length: record,
                    bytes,
                };
                send.send(chunk).ok()?;
            }
        } else {
            file.seek_relative(i64::try_from(record).ok()?).ok()?;
        }
        at = next;
    }
}
