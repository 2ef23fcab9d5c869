//! The bytes of a message (CDR, and ROS 1's): alignment, byte order, sizes, and a writer for our own.

use super::definition::Primitive;
use crate::wanted::MOST_ROWS;

/// A message that its definition does not fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(crate) enum CdrError {
    /// Fewer bytes than the definition asks for.
    #[error("its bytes end early")]
    End,
    /// A parameter list, or an encapsulation that is unknown.
    #[error("its encapsulation {0:02x} {1:02x} is neither plain nor delimited CDR")]
    Encapsulation(u8, u8),
    /// More rows than one message may give.
    #[error("it has {0} rows, expected at most {MOST_ROWS}")]
    TooMany(u64),
}

/// How the bytes of a message are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) big_endian: bool,
    /// Largest alignment: 8 (XCDR1), 4 (XCDR2) or 1 (ROS 1).
    pub(crate) most_align: usize,
    /// Whether every structure starts with its size (delimited XCDR2).
    pub(crate) delimited_structures: bool,
    /// Whether collections of anything but numbers start with their size (XCDR2).
    pub(crate) delimited_collections: bool,
    /// Bytes of a character of a wide string.
    pub(crate) wide: u8,
}

impl Layout {
    /// ROS 1: little-endian, nothing is aligned.
    pub(crate) const ROS1: Self = Self {
        big_endian: false,
        most_align: 1,
        delimited_structures: false,
        delimited_collections: false,
        wide: 4,
    };

    /// The layout that four bytes of encapsulation declare.
    ///
    /// # Errors
    /// [`CdrError::Encapsulation`] for parameter lists and what is unknown.
    pub(crate) fn declared(head: [u8; 4]) -> Result<Self, CdrError> {
        let (xcdr2, delimited) = match head[..2] {
            [0, 0 | 1] => (false, false),
            [0, 6 | 7] => (true, false),
            [0, 8 | 9] => (true, true),
            _ => return Err(CdrError::Encapsulation(head[0], head[1])),
        };
        Ok(Self {
            big_endian: head[1].is_multiple_of(2),
            most_align: if xcdr2 { 4 } else { 8 },
            delimited_structures: delimited,
            delimited_collections: xcdr2,
            wide: 4,
        })
    }
}

/// Reads along a message; positions and alignment count from behind the encapsulation.
#[derive(Debug)]
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    pub(crate) layout: Layout,
}

impl<'a> Reader<'a> {
    /// Takes the bytes behind the encapsulation.
    pub(crate) fn new(bytes: &'a [u8], layout: Layout) -> Self {
        Self { bytes, at: 0, layout }
    }

    /// Bytes not read yet.
    #[inline]
    pub(crate) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Bytes read.
    #[inline]
    pub(crate) fn at(&self) -> usize {
        self.at
    }

    /// Goes on at `at`, which lies within the message.
    pub(crate) fn go_to(&mut self, at: usize) -> Result<(), CdrError> {
        if at > self.bytes.len() {
            return Err(CdrError::End);
        }
        self.at = at;
        Ok(())
    }

    /// The next `length` bytes.
    #[inline]
    pub(crate) fn block(&mut self, length: u64) -> Result<&'a [u8], CdrError> {
        if length > self.remaining() as u64 {
            return Err(CdrError::End);
        }
        let start = self.at;
        self.at += length as usize;
        Ok(&self.bytes[start..self.at])
    }

    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], CdrError> {
        self.align(N);
        let rest = self.bytes.get(self.at..).ok_or(CdrError::End)?;
        let mut value = *rest.first_chunk::<N>().ok_or(CdrError::End)?;
        self.at += N;
        if self.layout.big_endian {
            value.reverse();
        }
        Ok(value)
    }

    #[inline]
    fn align(&mut self, size: usize) {
        // Powers of two: a division at every number would cost more than the rest.
        let below = size.min(self.layout.most_align) - 1;
        self.at = ((self.at + below) & !below).min(self.bytes.len());
    }

    /// Reads a length or count.
    #[inline]
    pub(crate) fn count(&mut self) -> Result<u64, CdrError> {
        Ok(u64::from(u32::from_le_bytes(self.take()?)))
    }

    /// Reads a size that stands before a structure or collection and gives where that ends.
    pub(crate) fn delimiter(&mut self) -> Result<usize, CdrError> {
        let size = self.count()?;
        if size > self.remaining() as u64 {
            return Err(CdrError::End);
        }
        Ok(self.at + size as usize)
    }

    /// The bytes of `count` numbers of `size` bytes each, aligned; none of them needs no padding either.
    #[inline]
    pub(crate) fn numbers(&mut self, size: u8, count: u64) -> Result<&'a [u8], CdrError> {
        if count == 0 {
            return Ok(&[]);
        }
        self.align(usize::from(size));
        self.block(count.checked_mul(u64::from(size)).ok_or(CdrError::End)?)
    }
}

/// The number at the start of `bytes`; none where they end early.
#[inline]
pub(crate) fn number(bytes: &[u8], primitive: Primitive, big_endian: bool) -> Option<f64> {
    // What almost every number is, before the general case.
    match (primitive, bytes.first_chunk()) {
        (Primitive::F64, Some(eight)) if !big_endian => Some(f64::from_le_bytes(*eight)),
        _ => any_number(bytes, primitive, big_endian),
    }
}

fn any_number(bytes: &[u8], primitive: Primitive, big_endian: bool) -> Option<f64> {
    fn little_endian<const N: usize>(bytes: &[u8], big_endian: bool) -> Option<[u8; N]> {
        let mut value = *bytes.first_chunk::<N>()?;
        if big_endian {
            value.reverse();
        }
        Some(value)
    }
    let big = big_endian;
    Some(match primitive {
        Primitive::U8 => f64::from(u8::from_le_bytes(little_endian(bytes, big)?)),
        Primitive::I8 => f64::from(i8::from_le_bytes(little_endian(bytes, big)?)),
        Primitive::U16 => f64::from(u16::from_le_bytes(little_endian(bytes, big)?)),
        Primitive::I16 => f64::from(i16::from_le_bytes(little_endian(bytes, big)?)),
        Primitive::U32 => f64::from(u32::from_le_bytes(little_endian(bytes, big)?)),
        Primitive::I32 => f64::from(i32::from_le_bytes(little_endian(bytes, big)?)),
        Primitive::U64 => u64::from_le_bytes(little_endian(bytes, big)?) as f64,
        Primitive::I64 => i64::from_le_bytes(little_endian(bytes, big)?) as f64,
        Primitive::F32 => f64::from(f32::from_le_bytes(little_endian(bytes, big)?)),
        Primitive::F64 => f64::from_le_bytes(little_endian(bytes, big)?),
    })
}

/// Writes a message as plain little-endian XCDR1.
#[derive(Debug)]
pub struct Writer {
    bytes: Vec<u8>,
}

impl Default for Writer {
    fn default() -> Self {
        Self::new()
    }
}

impl Writer {
    const HEAD: usize = 4;

    /// An empty message.
    pub fn new() -> Self {
        Self { bytes: vec![0, 1, 0, 0] }
    }

    /// The message; the writer starts anew with the same memory.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Starts a new message in the same memory.
    pub fn restart(&mut self) {
        self.bytes.truncate(Self::HEAD);
    }

    /// To a power of two.
    #[inline]
    fn align(&mut self, size: usize) {
        let behind_head = self.bytes.len() - Self::HEAD;
        let padding = behind_head.wrapping_neg() & (size - 1);
        self.bytes.extend_from_slice(&[0; 8][..padding]);
    }

    /// A byte, a boolean or a character.
    #[inline]
    pub fn u8(&mut self, value: u8) {
        self.bytes.push(value);
    }

    /// Four bytes: a count, seconds, nanoseconds.
    #[inline]
    pub fn u32(&mut self, value: u32) {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
    }

    /// A number.
    pub fn f64(&mut self, value: f64) {
        self.f64s(&[value]);
    }

    /// Numbers one after another, without their count.
    #[inline]
    pub fn f64s(&mut self, values: &[f64]) {
        self.align(8);
        let start = self.bytes.len();
        self.bytes.resize(start + 8 * values.len(), 0);
        let (places, _) = self.bytes[start..].as_chunks_mut::<8>();
        for (place, value) in places.iter_mut().zip(values) {
            *place = value.to_le_bytes();
        }
    }

    /// A text, with its count and its zero.
    #[inline]
    pub fn string(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.bytes.extend(text.as_bytes());
        self.bytes.push(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reader(message: &[u8]) -> Reader<'_> {
        let layout = Layout::declared(*message.first_chunk().unwrap()).unwrap();
        Reader::new(&message[4..], layout)
    }

    fn value(reader: &mut Reader<'_>, primitive: Primitive) -> Option<f64> {
        let bytes = reader.numbers(primitive.size(), 1).ok()?;
        number(bytes, primitive, reader.layout.big_endian)
    }

    #[test]
    fn eight_byte_numbers_align_to_eight_and_in_xcdr2_to_four() {
        let mut writer = Writer::new();
        writer.u8(7);
        writer.f64(1.5);
        assert_eq!(writer.bytes().len(), 4 + 16);
        let mut xcdr1 = reader(writer.bytes());
        assert_eq!(value(&mut xcdr1, Primitive::U8), Some(7.0));
        assert_eq!(value(&mut xcdr1, Primitive::F64), Some(1.5));

        let mut bytes = vec![0, 7, 0, 0, 7, 0, 0, 0];
        bytes.extend(1.5_f64.to_le_bytes());
        let mut xcdr2 = reader(&bytes);
        assert_eq!(value(&mut xcdr2, Primitive::U8), Some(7.0));
        assert_eq!(value(&mut xcdr2, Primitive::F64), Some(1.5));
    }

    #[test]
    fn big_endian_is_read_and_parameter_lists_are_refused() {
        let mut big = reader(&[0, 0, 0, 0, 0, 0, 1, 2]);
        assert_eq!(value(&mut big, Primitive::U32), Some(258.0));
        for head in [[0, 2, 0, 0], [0, 3, 0, 0], [0, 10, 0, 0], [1, 1, 0, 0]] {
            let expected = CdrError::Encapsulation(head[0], head[1]);
            assert_eq!(Layout::declared(head), Err(expected));
        }
    }

    #[test]
    fn a_claimed_length_past_the_end_is_an_error() {
        let mut short = reader(&[0, 1, 0, 0, 255, 255, 255, 255]);
        let claimed = short.count().unwrap();
        assert_eq!(short.numbers(8, claimed), Err(CdrError::End));
        assert_eq!(short.numbers(8, u64::MAX), Err(CdrError::End));
        assert_eq!(reader(&[0, 9, 0, 0, 9, 0, 0, 0]).delimiter(), Err(CdrError::End));
    }
}
