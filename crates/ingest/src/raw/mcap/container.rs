//! The container: record after record, over damage where that is wanted.

use super::{
    chunk,
    record::{self, HEAD, Record, op},
};
use crate::error::IngestError;
use std::{
    fs::File,
    io::{BufReader, Read, Seek, SeekFrom},
    path::Path,
};

/// A part of a file that could not be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Damage {
    /// Where it was met.
    pub(crate) at_byte: u64,
    /// What is wrong there.
    pub(crate) what: String,
    /// Time of receipt of the last message before it and of the first one after it, in ns.
    pub(crate) between_ns: (Option<u64>, Option<u64>),
}

/// Takes what a file holds.
pub(crate) trait Visitor {
    /// The next record.
    fn record(&mut self, record: Record<'_>);
    /// A chunk begins: remember where you are.
    fn mark(&mut self);
    /// The chunk turned out to be damaged: forget its messages.
    fn roll_back(&mut self);
}

/// Walks a file from start to end and gives its records to `visitor`.
///
/// With `recover`, damage is stepped over and returned: messages of a chunk whose checksum fails are rolled
/// back, those of a chunk that the file's end cuts are kept, and behind a senseless length the next
/// records that fit together are looked for.
///
/// # Errors
/// [`IngestError::Damaged`] at the first damage without `recover`; [`IngestError::Io`].
pub(crate) fn walk(
    path: &Path,
    recover: bool,
    visitor: &mut impl Visitor,
) -> Result<Vec<Damage>, IngestError> {
    let file = File::open(path).map_err(|e| IngestError::io(path, e))?;
    let length = file.metadata().map_err(|e| IngestError::io(path, e))?.len();
    let mut walker = Walker {
        path,
        file: BufReader::with_capacity(1 << 18, file),
        length,
        recover,
        buffer: Vec::new(),
        damage: Vec::new(),
        last_ns: None,
    };
    walker.run(visitor)?;
    Ok(walker.damage)
}

struct Walker<'a> {
    path: &'a Path,
    file: BufReader<File>,
    length: u64,
    recover: bool,
    buffer: Vec<u8>,
    damage: Vec<Damage>,
    last_ns: Option<u64>,
}

impl Walker<'_> {
    fn run(&mut self, visitor: &mut impl Visitor) -> Result<(), IngestError> {
        let mut at = mcap::MAGIC.len() as u64;
        loop {
            let Some((opcode, length)) = self.head(at)? else {
                return self.hurt(
                    at,
                    "the file ends without a footer: its recording was cut off",
                );
            };
            let body = at + HEAD as u64;
            let senseless = opcode == 0 || length > self.length - body;
            if senseless {
                let what = if opcode == 0 {
                    "no record starts here".to_owned()
                } else if length > self.length - body && length < self.length {
                    format!(
                        "record {opcode:#04x} is cut off: {length} bytes claimed, {} left",
                        self.length - body
                    )
                } else {
                    format!(
                        "record {opcode:#04x} claims {length} bytes, {} left",
                        self.length - body
                    )
                };
                self.hurt(at, &what)?;
                let next = self.resynchronise(at + 1)?;
                if opcode == op::CHUNK {
                    let end = next.unwrap_or(self.length);
                    self.chunk(at, end - body, next.is_none(), visitor)?;
                }
                match next {
                    Some(next) => at = next,
                    None => return Ok(()),
                }
                continue;
            }
            match opcode {
                op::FOOTER => return Ok(()),
                op::CHUNK => self.chunk(at, length, false, visitor)?,
                op::HEADER | op::SCHEMA | op::CHANNEL | op::MESSAGE | op::METADATA
                    if length <= chunk::MOST_RECORD as u64 =>
                {
                    self.load(body, length)?;
                    let buffer = std::mem::take(&mut self.buffer);
                    match record::parse(opcode, &buffer) {
                        Some(record) => self.give(record, visitor),
                        None => self.hurt(at, &format!("record {opcode:#04x} cannot be read"))?,
                    }
                    self.buffer = buffer;
                }
                _ => {}
            }
            at = body + length;
        }
    }

    /// Opcode and length at `at`; none where the file ends.
    fn head(&mut self, at: u64) -> Result<Option<(u8, u64)>, IngestError> {
        if self.length.saturating_sub(at) < HEAD as u64 {
            return Ok(None);
        }
        self.seek(at)?;
        let mut head = [0; HEAD];
        let read = self.file.read_exact(&mut head);
        read.map_err(|e| IngestError::io(self.path, e))?;
        let [opcode, length @ ..] = head;
        Ok(Some((opcode, u64::from_le_bytes(length))))
    }

    fn seek(&mut self, at: u64) -> Result<(), IngestError> {
        let wrong = |e| IngestError::io(self.path, e);
        let now = self.file.stream_position().map_err(wrong)?;
        // A relative seek keeps what is buffered.
        match i64::try_from(i128::from(at) - i128::from(now)) {
            Ok(offset) => self.file.seek_relative(offset).map_err(wrong),
            Err(_) => self.file.seek(SeekFrom::Start(at)).map(drop).map_err(wrong),
        }
    }

    /// Reads `length` bytes, of which the caller knows that the file has them.
    fn load(&mut self, at: u64, length: u64) -> Result<(), IngestError> {
        self.seek(at)?;
        self.buffer.resize(length as usize, 0);
        let read = self.file.read_exact(&mut self.buffer);
        read.map_err(|e| IngestError::io(self.path, e))
    }

    fn chunk(
        &mut self,
        at: u64,
        length: u64,
        cut: bool,
        visitor: &mut impl Visitor,
    ) -> Result<(), IngestError> {
        if length > chunk::MOST_CHUNK {
            return self.hurt(at, &format!("a chunk of {length} bytes is too large"));
        }
        self.load(at + HEAD as u64, length)?;
        let buffer = std::mem::take(&mut self.buffer);
        let before = self.last_ns;
        visitor.mark();
        let mut unreadable = 0;
        let read = chunk::records(&buffer, |opcode, content| {
            match record::parse(opcode, content) {
                Some(record) => self.give(record, visitor),
                None => unreadable += 1,
            }
        });
        self.buffer = buffer;
        let read = match read {
            Ok(()) if unreadable > 0 => Err(format!("{unreadable} records cannot be read")),
            read => read,
        };
        let Err(why) = read else { return Ok(()) };
        if cut {
            // What stands before the cut is whole; the cut itself has been reported.
            return Ok(());
        }
        visitor.roll_back();
        self.last_ns = before;
        self.hurt(at, &format!("a chunk is left out: {why}"))
    }

    fn give(&mut self, record: Record<'_>, visitor: &mut impl Visitor) {
        if let Record::Message(message) = &record {
            self.last_ns = Some(message.log_ns);
            for damage in self.damage.iter_mut().rev() {
                if damage.between_ns.1.is_some() {
                    break;
                }
                damage.between_ns.1 = self.last_ns;
            }
        }
        visitor.record(record);
    }

    fn hurt(&mut self, at_byte: u64, what: &str) -> Result<(), IngestError> {
        if !self.recover {
            return Err(IngestError::Damaged {
                path: self.path.to_owned(),
                at_byte,
                what: what.to_owned(),
            });
        }
        self.damage.push(Damage {
            at_byte,
            what: what.to_owned(),
            between_ns: (self.last_ns, None),
        });
        Ok(())
    }

    /// The next place from `at` on where records fit together; none up to the end of the file.
    fn resynchronise(&mut self, mut at: u64) -> Result<Option<u64>, IngestError> {
        const WINDOW: u64 = 1 << 18;
        while at + (HEAD as u64) <= self.length {
            let n = WINDOW.min(self.length - at);
            self.load(at, n)?;
            let window = std::mem::take(&mut self.buffer);
            let mut found = None;
            for (i, head) in window.windows(HEAD).enumerate() {
                // The cheap test first: a known opcode and a length below 1 TiB.
                let likely = (1..=op::LAST_KNOWN).contains(&head[0]) && head[6..] == [0; 3];
                if likely && self.records_fit(at + i as u64)? {
                    found = Some(at + i as u64);
                    break;
                }
            }
            self.buffer = window;
            if found.is_some() || at + n == self.length {
                return Ok(found);
            }
            at += n - (HEAD as u64 - 1);
        }
        Ok(None)
    }

    /// Whether three records in a row, or all up to the file's end, have known opcodes and lengths that fit.
    fn records_fit(&mut self, mut at: u64) -> Result<bool, IngestError> {
        for hop in 0..3 {
            let Some((opcode, length)) = self.head(at)? else {
                return Ok(hop > 0);
            };
            let least = match opcode {
                op::FOOTER => 20,
                op::CHUNK => 40,
                op::MESSAGE => 22,
                op::HEADER | op::SCHEMA | op::CHANNEL | op::METADATA => 8,
                1..=op::LAST_KNOWN => 4,
                _ => return Ok(false),
            };
            let fits = length >= least && length <= self.length - at - HEAD as u64;
            if !fits {
                return Ok(false);
            }
            if opcode == op::FOOTER {
                return Ok(true);
            }
            at += HEAD as u64 + length;
        }
        Ok(true)
    }
}
