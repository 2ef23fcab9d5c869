//! The chunks of a file: where each ends when its lengths disagree, and whether what it holds can be trusted.

use super::{Visitor, Walker};
use crate::{
    chunk::{self, Verdict},
    error::BagError,
    record::{self, HEAD, op},
};
use std::io::{Read, Seek};

impl<R: Read + Seek> Walker<'_, R> {
    /// Reads the chunk at `offset` and gives where to go on; none at the end of the file.
    pub(super) fn chunk_at(
        &mut self,
        offset: u64,
        opcode: u8,
        length: u64,
        start: &[u8],
        visitor: &mut impl Visitor,
    ) -> Result<Option<u64>, BagError> {
        let body = offset + HEAD as u64;
        let left = self.length - body;
        let head = chunk::Head::read(start);
        let inner = head.as_ref().and_then(chunk::Head::content_length);
        let outer = Some(length);
        let certain = body + head.as_ref().map_or(0, chunk::Head::length);
        self.resume = certain;
        if opcode != op::CHUNK {
            self.damaged(offset, &format!("record {opcode:#04x} is a chunk by its content"))?;
        }
        if outer == inner && length <= left {
            let whole = self.chunk(offset, length, false, visitor)?;
            let next = body + length;
            if whole {
                self.resume = next;
            } else {
                self.lost = next;
            }
            return Ok(Some(next));
        }
        // The two lengths disagree, or reach past the end: believe the one behind which records go on.
        let mut end = None;
        for n in [inner, outer].into_iter().flatten() {
            if end.is_none() && n <= left && self.records_fit(body + n)? {
                end = Some(body + n);
            }
        }
        let cut = inner == outer && end.is_none();
        let what = if cut && length < self.length {
            format!("a chunk is cut off: {length} bytes claimed, {left} left")
        } else if length > left {
            format!("a chunk claims {length} bytes, {left} left")
        } else {
            "the lengths in a chunk's header contradict each other".to_owned()
        };
        self.damaged(offset, &what)?;
        if end.is_none() {
            self.lost = body.saturating_add(inner.map_or(length, |inner| inner.min(length)));
            end = self.resynchronise(certain, certain)?;
        }
        let until = end.unwrap_or(self.length);
        self.chunk(offset, until - body, end.is_none(), visitor)?;
        if end.is_none()
            && let Some(damage) = self.damage.last_mut()
        {
            // What it lacks stands behind the messages that are left of it.
            damage.between_ns = (self.last_ns, None);
        }
        self.resume = end.unwrap_or(self.length);
        Ok(end)
    }

    /// Reads a chunk; gives whether it was whole.
    fn chunk(
        &mut self,
        offset: u64,
        length: u64,
        cut: bool,
        visitor: &mut impl Visitor,
    ) -> Result<bool, BagError> {
        if length > chunk::MOST_CHUNK {
            self.damaged(offset, &format!("a chunk of {length} bytes is too large"))?;
            return Ok(false);
        }
        self.hash(offset, offset + HEAD as u64)?;
        let ahead = self.ahead.as_mut();
        let mut fetched = ahead.and_then(|a| a.take(offset + HEAD as u64, length));
        match &mut fetched {
            Some(fetched) => std::mem::swap(&mut self.buffer, &mut fetched.packed),
            None => self.load(offset + HEAD as u64, length)?,
        }
        self.hash_buffer();
        let buffer = std::mem::take(&mut self.buffer);
        let mut unpacker = std::mem::take(&mut self.unpacker);
        let unpacked = fetched.as_ref();
        let unpacked = unpacked.and_then(|f| Some((&f.unpacked[..], f.checksum?)));
        let before = (self.last_ns, self.messages, self.damage.len());
        visitor.mark();
        let mut unreadable = 0;
        let verdict = unpacker.records(&buffer, unpacked, |opcode, content| {
            match content.map(|content| record::parse(opcode, content)) {
                Some(Some(record)) => self.give(record, visitor),
                Some(None) => unreadable += 1,
                None if opcode == op::MESSAGE => self.pass_over(visitor),
                None => {}
            }
        });
        self.buffer = buffer;
        if let (Some(ahead), Some(mut fetched)) = (&self.ahead, fetched) {
            std::mem::swap(&mut self.buffer, &mut fetched.packed);
            ahead.give_back(fetched);
        }
        self.unpacker = unpacker;
        let verdict = match verdict {
            Verdict::Whole if unreadable > 0 => {
                Verdict::Proven(format!("{unreadable} records in a chunk cannot be read"))
            }
            verdict => verdict,
        };
        match verdict {
            Verdict::Whole => self.check_channels(offset).map(|()| true),
            // What stands before the cut is whole; the cut itself has been reported.
            Verdict::Lost(_) | Verdict::Proven(_) if cut => {
                self.check_channels(offset).map(|()| false)
            }
            Verdict::Proven(why) => {
                self.damaged(offset, &why)?;
                self.check_channels(offset)?;
                Ok(true)
            }
            Verdict::Lost(why) => {
                visitor.roll_back();
                self.forget_channels();
                self.open_again(before.0);
                (self.last_ns, self.messages) = (before.0, before.1);
                self.damaged(offset, &format!("a chunk is left out: {why}"))?;
                Ok(false)
            }
        }
    }

    /// Forgets that messages which were rolled back ended a hole.
    fn open_again(&mut self, last_ns: Option<u64>) {
        for damage in self.damage.iter_mut().rev() {
            if damage.between_ns.0 != last_ns {
                break;
            }
            damage.between_ns.1 = None;
        }
    }
}
