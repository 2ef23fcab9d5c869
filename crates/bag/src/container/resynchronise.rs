//! What a record is when its head cannot be believed, and where the next ones are that fit together.

use super::Walker;
use crate::{
    chunk,
    error::BagError,
    record::{HEAD, op},
};
use std::io::{Read, Seek};

impl<R: Read + Seek> Walker<'_, R> {
    /// The next place from `offset` on, other than `not`, where records fit together; none up to the end of the file.
    pub(super) fn resynchronise(
        &mut self,
        mut offset: u64,
        not: u64,
    ) -> Result<Option<u64>, BagError> {
        const WINDOW: u64 = 1 << 18;
        while offset + (HEAD as u64) <= self.length {
            let n = WINDOW.min(self.length - offset);
            self.load(offset, n)?;
            let window = std::mem::take(&mut self.buffer);
            let mut next = None;
            for (i, head) in window.windows(HEAD).enumerate() {
                // The cheap test first: a known opcode and a length below 1 TiB.
                let likely = (1..=op::LAST_KNOWN).contains(&head[0]) && head[6..] == [0; 3];
                let place = offset + i as u64;
                let of_chunk = matches!(head[0], op::SCHEMA | op::CHANNEL | op::MESSAGE);
                let of_lost = of_chunk && place < self.lost;
                if likely && place != not && !of_lost && self.records_fit(place)? {
                    next = Some(place);
                    break;
                }
            }
            self.buffer = window;
            if next.is_some() || offset + n == self.length {
                return Ok(next);
            }
            offset += n - (HEAD as u64 - 1);
        }
        Ok(None)
    }

    /// Whether three records in a row, or all up to the file's end, have known opcodes and lengths that fit.
    pub(super) fn records_fit(&mut self, mut offset: u64) -> Result<bool, BagError> {
        for hop in 0..3 {
            let left = self.length.saturating_sub(offset);
            let Some((opcode, length)) = self.head(offset)? else {
                return Ok(hop > 0 && left == 0);
            };
            let least = match opcode {
                op::FOOTER => 20,
                op::CHUNK => 40,
                op::MESSAGE => 22,
                op::HEADER | op::SCHEMA | op::CHANNEL | op::METADATA => 8,
                1..=op::LAST_KNOWN => 4,
                op::FIRST_PRIVATE.. => 0,
                _ => return Ok(false),
            };
            let fits = length >= least && length <= left - HEAD as u64;
            if !fits {
                // A chunk that the end of the file cuts may be the last of its kind.
                return Ok(hop > 1 && opcode == op::CHUNK);
            }
            if opcode == op::FOOTER {
                return Ok(length == 20);
            }
            offset += HEAD as u64 + length;
        }
        Ok(true)
    }
}

/// Whether a record is a chunk: by its opcode, or by its content where one byte has changed the opcode.
pub(super) fn is_chunk(opcode: u8, length: u64, left: u64, start: &[u8]) -> bool {
    opcode == op::CHUNK
        || chunk::Head::read(start).is_some_and(|head| {
            let inner = head.content_length().unwrap_or(u64::MAX);
            head.is_telling() && inner == length && inner <= left
        })
}

/// Says what is wrong with a record that cannot be one.
pub(super) fn senseless(opcode: u8, length: u64, left: u64, file: u64) -> String {
    if opcode == 0 {
        "no record starts here".to_owned()
    } else if length <= left {
        format!("record {opcode:#04x} contradicts itself")
    } else if length < file {
        format!("record {opcode:#04x} is cut off: {length} bytes claimed, {left} left")
    } else {
        format!("record {opcode:#04x} claims {length} bytes, {left} left")
    }
}
