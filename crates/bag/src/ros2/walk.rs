//! Walks along a message by the steps of a plan.

use super::{
    cdr::{CdrError, Reader, number},
    step::{Block, Step},
};
use crate::wanted::{MOST_ROWS, name_number};

/// Walks `steps`: wanted numbers go into `row`, which is given to `each` for every element that is a row.
///
/// # Errors
/// [`CdrError`] where the bytes do not fit.
pub(super) fn walk(
    steps: &[Step],
    reader: &mut Reader<'_>,
    row: &mut [f64],
    each: &mut dyn FnMut(&[f64]),
) -> Result<(), CdrError> {
    for step in steps {
        match step {
            Step::Block(block) => take_block(block, reader, row)?,
            Step::TakeSome { primitive, fixed, wanted } => {
                let count = fixed.map_or_else(|| reader.count(), Ok)?;
                let size = primitive.size();
                let bytes = reader.numbers(size, count)?;
                for &(index, slot) in wanted.iter().filter(|w| w.0 < count) {
                    let start = index as usize * usize::from(size);
                    row[slot] = number(&bytes[start..], *primitive, reader.layout.big_endian)
                        .ok_or(CdrError::End)?;
                }
            }
            Step::SkipString => {
                let length = reader.count()?;
                reader.numbers(1, length)?;
            }
            Step::TakeName { slot } => {
                let length = reader.count()?;
                let value = name_number(reader.block(length)?);
                *row.get_mut(*slot).ok_or(CdrError::End)? = value;
            }
            Step::SkipWide => {
                let count = reader.count()?;
                let bytes = count * u64::from(reader.layout.wide);
                reader.numbers(1, bytes)?;
            }
            Step::SkipSequence { size } => {
                let count = reader.count()?;
                reader.numbers(*size, count)?;
            }
            Step::Repeat { fixed, body, first } => {
                within_collection(reader, |reader| {
                    let count = fixed.map_or_else(|| reader.count(), Ok)?;
                    for i in 0..count {
                        let before = reader.at();
                        match first {
                            Some(first) if i == 0 => walk(first, reader, row, &mut |_| {})?,
                            _ => walk(body, reader, row, &mut |_| {})?,
                        }
                        if reader.at() == before {
                            // Elements of no bytes: any number of them takes no more.
                            break;
                        }
                    }
                    Ok(())
                })?;
            }
            Step::Rows { body, slots } => {
                within_collection(reader, |reader| {
                    let count = reader.count()?;
                    if count > MOST_ROWS as u64 {
                        return Err(CdrError::TooMany(count));
                    }
                    for _ in 0..count {
                        for &slot in slots {
                            row[slot] = f64::NAN;
                        }
                        let before = reader.at();
                        // Nothing within a row gives rows of its own to this caller.
                        walk(body, reader, row, &mut |_| {})?;
                        if reader.at() == before {
                            break;
                        }
                        each(row);
                    }
                    Ok(())
                })?;
            }
            Step::Structure(body) => {
                let end = reader.delimiter()?;
                walk(body, reader, row, each)?;
                if reader.at() > end {
                    return Err(CdrError::End);
                }
                // Fields that were added since stand at the end.
                reader.go_to(end)?;
            }
        }
    }
    Ok(())
}

fn take_block(block: &Block, reader: &mut Reader<'_>, row: &mut [f64]) -> Result<(), CdrError> {
    let places = block.places(reader.at(), reader.layout.most_align).ok_or(CdrError::End)?;
    let bytes = reader.block(places.length)?;
    let big_endian = reader.layout.big_endian;
    for &(offset, primitive, slot) in &places.takes {
        let value = bytes.get(offset as usize..).ok_or(CdrError::End)?;
        let value = number(value, primitive, big_endian).ok_or(CdrError::End)?;
        *row.get_mut(slot as usize).ok_or(CdrError::End)? = value;
    }
    Ok(())
}

/// Reads a collection of anything but numbers, which may start with its size and then must have it.
#[inline]
fn within_collection<'a>(
    reader: &mut Reader<'a>,
    read: impl FnOnce(&mut Reader<'a>) -> Result<(), CdrError>,
) -> Result<(), CdrError> {
    if !reader.layout.delimited_collections {
        return read(reader);
    }
    let end = reader.delimiter()?;
    read(reader)?;
    if reader.at() == end { Ok(()) } else { Err(CdrError::End) }
}
