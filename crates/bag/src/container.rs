//! The container: record after record, over damage where that is wanted.

mod chunks;
mod resynchronise;
mod visitor;

pub use visitor::{Damage, Visitor, Walk, Walked};

use crate::{
    ahead::Ahead,
    chunk::{self, Unpacker},
    error::BagError,
    record::{self, Channel, HEAD, Record, op},
};
use mcap::records::Record as Account;
use resynchronise::{is_chunk, senseless};
use std::{
    collections::BTreeMap,
    fs::File,
    io::{BufReader, Read, Seek, SeekFrom},
    path::Path,
};

/// Walks a file from start to end and gives its records to `visitor`.
///
/// With [`Walk::recover`], damage is stepped over and returned: messages of a chunk that cannot be trusted are rolled back, those
/// of a chunk that the file's end cuts are kept, and behind a senseless record the next ones that fit together are
/// looked for. Besides what cannot be read, damage is what the file's own accounts deny: the checksums of chunks, of
/// the data and of the summary, and the number of messages.
///
/// # Errors
/// [`BagError::Damaged`] at the first damage without `recover`; [`BagError::Io`].
pub fn walk(path: &Path, how: Walk, visitor: &mut impl Visitor) -> Result<Walked, BagError> {
    let wrong = |e| BagError::io(path, e);
    let mut file = File::open(path).map_err(wrong)?;
    let length = file.metadata().map_err(wrong)?.len();
    let mut ahead = Ahead::start(path, length, how.hash);
    let mut hash = None;
    if how.hash && ahead.is_none() {
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(&mut file).map_err(wrong)?;
        file.rewind().map_err(wrong)?;
        hash = Some(hasher.finalize());
    }
    let damage = walk_with(path, file, length, ahead.as_mut(), how, visitor)?;
    if let Some(ahead) = ahead {
        hash = ahead.finish().map_err(wrong)?;
    }
    let blake3 = hash.map(|hash| hash.to_hex().to_string());
    Ok(Walked { damage, blake3 })
}

/// Walks anything that can be read and sought in; `path` is what errors call it. It is not hashed.
///
/// # Errors
/// As [`walk`].
pub fn walk_from(
    path: &Path,
    mut source: impl Read + Seek,
    how: Walk,
    visitor: &mut impl Visitor,
) -> Result<Walked, BagError> {
    let length = source.seek(SeekFrom::End(0));
    let length = length.and_then(|length| source.rewind().map(|()| length));
    let length = length.map_err(|e| BagError::io(path, e))?;
    let damage = walk_with(path, source, length, None, how, visitor)?;
    Ok(Walked { damage, blake3: None })
}

fn walk_with(
    path: &Path,
    source: impl Read + Seek,
    length: u64,
    ahead: Option<&mut Ahead>,
    how: Walk,
    visitor: &mut impl Visitor,
) -> Result<Vec<Damage>, BagError> {
    let mut walker = Walker {
        path,
        file: BufReader::with_capacity(1 << 14, source),
        length,
        how,
        buffer: Vec::new(),
        unpacker: Unpacker::default(),
        ahead,
        damage: Vec::new(),
        last_ns: None,
        messages: 0,
        claimed_messages: None,
        crc: Some(crc32fast::Hasher::new()),
        data_ended: false,
        resume: 0,
        lost: 0,
        begin: 0,
        channels: BTreeMap::new(),
        undo: Vec::new(),
        declared_again: None,
    };
    walker.run(visitor)?;
    Ok(walker.damage)
}

struct Walker<'a, R> {
    path: &'a Path,
    file: BufReader<R>,
    length: u64,
    how: Walk,
    buffer: Vec<u8>,
    unpacker: Unpacker,
    ahead: Option<&'a mut Ahead>,
    damage: Vec<Damage>,
    last_ns: Option<u64>,
    messages: u64,
    claimed_messages: Option<u64>,
    /// Checksum of everything so far; none once something was stepped over, or behind the data.
    crc: Option<crc32fast::Hasher>,
    data_ended: bool,
    /// Behind what is certain: where to look for records when the next one makes no sense.
    resume: u64,
    /// Where the last chunk that cannot be trusted should end: what chunks hold is none of the file's own before that.
    lost: u64,
    /// Where the recording begins: behind another one if files were joined.
    begin: u64,
    /// As they were declared last, by number.
    channels: BTreeMap<u16, Channel>,
    /// What the records that are being read have put in the place of other declarations.
    undo: Vec<(u16, Option<Channel>)>,
    /// What is wrong with the first channel of these records that is declared as another one than before.
    declared_again: Option<String>,
}

impl<R: Read + Seek> Walker<'_, R> {
    fn run(&mut self, visitor: &mut impl Visitor) -> Result<(), BagError> {
        let mut offset = mcap::MAGIC.len() as u64;
        self.start_magic()?;
        self.resume = offset;
        loop {
            let Some((opcode, length)) = self.head(offset)? else {
                return self
                    .damaged(offset, "the file ends without a footer: its recording was cut off");
            };
            let body = offset + HEAD as u64;
            let left = self.length - body;
            let start = self.peek(body)?;
            if is_chunk(opcode, length, left, &start) {
                match self.chunk_at(offset, opcode, length, &start, visitor)? {
                    Some(next) => offset = next,
                    None => return Ok(()),
                }
                continue;
            }
            let whole =
                opcode != 0 && length <= left && record::is_plausible(opcode, &start, length);
            if !whole {
                let what = senseless(opcode, length, left, self.length);
                self.damaged(offset, &what)?;
                match self.resynchronise(self.resume.max(mcap::MAGIC.len() as u64), offset)? {
                    Some(next) => offset = next,
                    None => return Ok(()),
                }
                self.resume = offset;
                continue;
            }
            self.resume = offset + 1;
            if opcode == op::FOOTER {
                self.footer(offset, length)?;
                match self.behind(body + length, visitor)? {
                    Some(next) => offset = next,
                    None => return Ok(()),
                }
                self.resume = offset;
                continue;
            }
            self.plain(offset, opcode, length, visitor)?;
            offset = body + length;
        }
    }

    fn start_magic(&mut self) -> Result<(), BagError> {
        let n = self.length.min(mcap::MAGIC.len() as u64);
        self.load(0, n)?;
        if self.buffer == mcap::MAGIC {
            self.hash_buffer();
            return Ok(());
        }
        self.damaged(0, "its first eight bytes are not those of an MCAP file")
    }

    /// Reads a record that is no chunk.
    fn plain(
        &mut self,
        offset: u64,
        opcode: u8,
        length: u64,
        visitor: &mut impl Visitor,
    ) -> Result<(), BagError> {
        let body = offset + HEAD as u64;
        let wanted = matches!(
            opcode,
            op::HEADER
                | op::SCHEMA
                | op::CHANNEL
                | op::MESSAGE
                | op::METADATA
                | op::STATISTICS
                | op::DATA_END
        );
        if opcode == op::DATA_END {
            self.load(body, length.min(4))?;
            let claimed = match record::account(opcode, &self.buffer) {
                Some(Account::DataEnd(end)) => end.data_section_crc,
                _ => 0,
            };
            self.data_ended = true;
            let computed = self.crc.take().map(crc32fast::Hasher::finalize);
            if claimed != 0 && computed.is_some_and(|computed| computed != claimed) {
                return self.damaged(offset, "the checksum of the data does not match: something outside the chunks has changed");
            }
            return Ok(());
        }
        self.hash(offset, body)?;
        if !wanted || length > chunk::MOST_RECORD as u64 {
            if opcode == op::MESSAGE {
                self.pass_over(visitor);
            }
            return self.hash(body, body + length);
        }
        self.load(body, length)?;
        self.hash_buffer();
        let buffer = std::mem::take(&mut self.buffer);
        if opcode == op::STATISTICS {
            self.claimed_messages = match record::account(opcode, &buffer) {
                Some(Account::Statistics(statistics)) => Some(statistics.message_count),
                _ => None,
            };
        } else {
            match record::parse(opcode, &buffer) {
                Some(record) => {
                    self.give(record, visitor);
                    self.check_channels(offset)?;
                }
                None => self.damaged(offset, &format!("record {opcode:#04x} cannot be read"))?,
            }
        }
        self.buffer = buffer;
        Ok(())
    }

    /// Checks what the end of the file says of the whole.
    fn footer(&mut self, offset: u64, length: u64) -> Result<(), BagError> {
        let body = offset + HEAD as u64;
        self.load(body, length.min(20))?;
        let (summary_start, crc) = match record::account(op::FOOTER, &self.buffer) {
            Some(Account::Footer(footer)) => (footer.summary_start, footer.summary_crc),
            _ => (0, 0),
        };
        let summary_start = if summary_start == 0 { 0 } else { self.begin + summary_start };
        if summary_start > offset {
            return self.damaged(offset, "the footer points behind the end of the file");
        }
        if crc != 0 && summary_start != 0 {
            self.crc = Some(crc32fast::Hasher::new());
            self.hash(summary_start, body + 16)?;
            let computed = self.crc.take().map(crc32fast::Hasher::finalize);
            if computed != Some(crc) {
                self.damaged(offset, "the checksum of the summary does not match")?;
            }
        }
        let end = body + length;
        let magic = mcap::MAGIC.len() as u64;
        let n = magic.min(self.length - end);
        self.load(end, n)?;
        if self.buffer != mcap::MAGIC {
            self.damaged(end, "the file does not end as an MCAP file does")?;
        }
        if crc != 0 && !self.data_ended {
            // Who writes checksums writes where the data ends.
            self.damaged(offset, "the record that ends the data is missing")?;
        }
        let (read, claimed) = (self.messages, self.claimed_messages);
        match claimed {
            // With damage the difference is no news.
            Some(claimed) if self.damage.is_empty() && claimed != read => self.damaged(
                offset,
                &format!("{read} messages were read, {claimed} were written by its statistics"),
            ),
            _ => Ok(()),
        }
    }

    /// Reports what is behind the magic that ends a recording; gives where the records of another one begin.
    fn behind(&mut self, end: u64, visitor: &mut impl Visitor) -> Result<Option<u64>, BagError> {
        let magic = mcap::MAGIC.len() as u64;
        let begin = end + magic;
        let left = self.length.saturating_sub(begin);
        if left == 0 {
            return Ok(None);
        }
        self.load(begin, magic.min(left))?;
        if self.buffer != mcap::MAGIC {
            self.damaged(begin, &format!("{left} bytes follow the end of the recording"))?;
            return Ok(None);
        }
        self.damaged(
            begin,
            "another recording begins behind the end of this one: files were joined",
        )?;
        (self.begin, self.data_ended, self.claimed_messages) = (begin, false, None);
        (self.messages, self.lost) = (0, 0);
        self.channels.clear();
        self.crc = Some(crc32fast::Hasher::new());
        self.load(begin, magic)?;
        self.hash_buffer();
        visitor.begin();
        Ok(Some(begin + magic))
    }

    /// Opcode and length at `offset`; none where the file ends.
    fn head(&mut self, offset: u64) -> Result<Option<(u8, u64)>, BagError> {
        if self.length.saturating_sub(offset) < HEAD as u64 {
            return Ok(None);
        }
        self.seek(offset)?;
        let mut head = [0; HEAD];
        let read = self.file.read_exact(&mut head);
        read.map_err(|e| self.io(e))?;
        Ok(Some(record::head_of(head)))
    }

    /// The first bytes of a record's content, as many as there are of those that tell what it is.
    fn peek(&mut self, body: u64) -> Result<Vec<u8>, BagError> {
        let n = (chunk::Head::MOST as u64).min(self.length.saturating_sub(body));
        self.load(body, n)?;
        Ok(self.buffer.clone())
    }

    fn seek(&mut self, offset: u64) -> Result<(), BagError> {
        let sought = self.file.stream_position().and_then(|now| {
            // A relative seek keeps what is buffered.
            match i64::try_from(i128::from(offset) - i128::from(now)) {
                Ok(step) => self.file.seek_relative(step),
                Err(_) => self.file.seek(SeekFrom::Start(offset)).map(drop),
            }
        });
        sought.map_err(|e| self.io(e))
    }

    fn io(&self, source: std::io::Error) -> BagError {
        BagError::io(self.path, source)
    }

    /// Reads `length` bytes, of which the caller knows that the file has them.
    fn load(&mut self, offset: u64, length: u64) -> Result<(), BagError> {
        self.seek(offset)?;
        self.buffer.resize(length as usize, 0);
        let read = self.file.read_exact(&mut self.buffer);
        read.map_err(|e| self.io(e))
    }

    fn hash_buffer(&mut self) {
        if let Some(crc) = &mut self.crc {
            crc.update(&self.buffer);
        }
    }

    /// Adds the bytes from `from` to `to` to the checksum, if one is still kept.
    fn hash(&mut self, mut from: u64, to: u64) -> Result<(), BagError> {
        while from < to && self.crc.is_some() {
            let n = (to - from).min(1 << 16);
            self.load(from, n)?;
            self.hash_buffer();
            from += n;
        }
        Ok(())
    }

    /// Counts a message that is too long to be read: the file's own count has it too.
    fn pass_over(&mut self, visitor: &mut impl Visitor) {
        self.messages += 1;
        visitor.passed_over();
    }

    fn give(&mut self, record: Record<'_>, visitor: &mut impl Visitor) {
        if let Record::Message(message) = &record {
            self.messages += 1;
            self.last_ns = Some(message.log_ns);
            for damage in self.damage.iter_mut().rev() {
                if damage.between_ns.1.is_some() {
                    break;
                }
                damage.between_ns.1 = self.last_ns;
            }
        }
        if let Record::Channel(channel) = &record {
            self.declare(channel);
        }
        visitor.record(record);
    }

    /// Notes a channel, and whether its number is that of another one.
    fn declare(&mut self, channel: &Channel) {
        let known = self.channels.get(&channel.id);
        if known == Some(channel) {
            return;
        }
        if let Some(known) = known {
            let what = if known.topic == channel.topic {
                format!(
                    "channel {} of `{}` is declared again with another type",
                    known.id, known.topic
                )
            } else {
                format!(
                    "channel {} is declared again: for topic `{}`, before for `{}`",
                    known.id, channel.topic, known.topic
                )
            };
            self.declared_again.get_or_insert(what);
        }
        self.undo.push((channel.id, self.channels.insert(channel.id, channel.clone())));
    }

    /// Believes the declarations of the records that were read.
    ///
    /// # Errors
    /// [`BagError::Damaged`] if one of them contradicts an earlier one.
    fn check_channels(&mut self, offset: u64) -> Result<(), BagError> {
        self.undo.clear();
        match self.declared_again.take() {
            Some(what) => self.damaged(offset, &what),
            None => Ok(()),
        }
    }

    /// Forgets the declarations of the records that were read.
    fn forget_channels(&mut self) {
        self.declared_again = None;
        for (id, before) in std::mem::take(&mut self.undo).into_iter().rev() {
            match before {
                Some(channel) => self.channels.insert(id, channel),
                None => self.channels.remove(&id),
            };
        }
    }

    fn damaged(&mut self, at_byte: u64, what: &str) -> Result<(), BagError> {
        if !self.how.recover {
            return Err(BagError::Damaged {
                path: self.path.to_owned(),
                at_byte,
                what: what.to_owned(),
            });
        }
        self.crc = None;
        self.damage.push(Damage {
            at_byte,
            what: what.to_owned(),
            between_ns: (self.last_ns, None),
        });
        Ok(())
    }
}
