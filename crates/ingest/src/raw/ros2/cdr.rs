//! The bytes of a message (CDR): alignment, byte order, strings, and a writer for our own.

use super::definition::Primitive;

/// A message that its definition does not fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(crate) enum CdrError {
    /// Fewer bytes than the definition asks for.
    #[error("its bytes end early")]
    End,
    /// An encapsulation that is not plain CDR.
    #[error("its encapsulation {0:02x} {1:02x} is not plain CDR")]
    Encapsulation(u8, u8),
}

/// Reads along a message; positions and alignment count from behind the encapsulation.
#[derive(Debug)]
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
    most_align: usize,
}

impl<'a> Reader<'a> {
    /// Takes a message with its four bytes of encapsulation: XCDR1 or plain XCDR2, either byte order.
    ///
    /// # Errors
    /// [`CdrError`] for other encapsulations.
    pub(crate) fn new(message: &'a [u8]) -> Result<Self, CdrError> {
        let (head, bytes) = message.split_at_checked(4).ok_or(CdrError::End)?;
        let most_align = match (head[0], head[1]) {
            (0, 0 | 1) => 8,
            (0, 6 | 7) => 4,
            (a, b) => return Err(CdrError::Encapsulation(a, b)),
        };
        Ok(Self {
            bytes,
            at: 0,
            big_endian: head[1].is_multiple_of(2),
            most_align,
        })
    }

    /// Bytes not read yet.
    pub(crate) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], CdrError> {
        self.align(N);
        let rest = self.bytes.get(self.at..).ok_or(CdrError::End)?;
        let mut value = *rest.first_chunk::<N>().ok_or(CdrError::End)?;
        self.at += N;
        if self.big_endian {
            value.reverse();
        }
        Ok(value)
    }

    fn align(&mut self, size: usize) {
        let align = size.min(self.most_align);
        self.at = self.at.next_multiple_of(align).min(self.bytes.len());
    }

    /// Reads a number.
    ///
    /// # Errors
    /// [`CdrError::End`] past the end.
    pub(crate) fn number(&mut self, primitive: Primitive) -> Result<f64, CdrError> {
        Ok(match primitive {
            Primitive::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Primitive::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Primitive::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Primitive::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Primitive::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Primitive::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Primitive::U64 => u64::from_le_bytes(self.take()?) as f64,
            Primitive::I64 => i64::from_le_bytes(self.take()?) as f64,
            Primitive::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Primitive::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// Reads a length or count.
    ///
    /// # Errors
    /// [`CdrError::End`] past the end.
    pub(crate) fn count(&mut self) -> Result<u64, CdrError> {
        Ok(u64::from(u32::from_le_bytes(self.take()?)))
    }

    /// Passes over `count` numbers of `size` bytes; none of them needs no padding either.
    ///
    /// # Errors
    /// [`CdrError::End`] past the end.
    pub(crate) fn skip(&mut self, size: u8, count: u64) -> Result<(), CdrError> {
        if count == 0 {
            return Ok(());
        }
        self.align(usize::from(size));
        let bytes = count.checked_mul(u64::from(size)).ok_or(CdrError::End)?;
        if bytes > self.remaining() as u64 {
            return Err(CdrError::End);
        }
        self.at += bytes as usize;
        Ok(())
    }
}

/// Writes a message as plain little-endian XCDR1.
#[derive(Debug)]
pub(crate) struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    const HEAD: usize = 4;

    pub(crate) fn new() -> Self {
        Self {
            bytes: vec![0, 1, 0, 0],
        }
    }

    /// The message; the writer starts anew with the same memory.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Starts a new message in the same memory.
    pub(crate) fn restart(&mut self) {
        self.bytes.truncate(Self::HEAD);
    }

    fn align(&mut self, size: usize) {
        let written = self.bytes.len() - Self::HEAD;
        let padding = written.next_multiple_of(size) - written;
        self.bytes.resize(self.bytes.len() + padding, 0);
    }

    pub(crate) fn u8(&mut self, value: u8) {
        self.bytes.push(value);
    }

    pub(crate) fn u32(&mut self, value: u32) {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
    }

    pub(crate) fn f64(&mut self, value: f64) {
        self.align(8);
        self.bytes.extend(value.to_le_bytes());
    }

    pub(crate) fn f64s(&mut self, values: &[f64]) {
        for &value in values {
            self.f64(value);
        }
    }

    pub(crate) fn string(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.bytes.extend(text.as_bytes());
        self.bytes.push(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_byte_numbers_align_to_eight_and_in_xcdr2_to_four() {
        let mut writer = Writer::new();
        writer.u8(7);
        writer.f64(1.5);
        assert_eq!(writer.bytes().len(), 4 + 16);
        let mut reader = Reader::new(writer.bytes()).unwrap();
        assert_eq!(reader.number(Primitive::U8), Ok(7.0));
        assert_eq!(reader.number(Primitive::F64), Ok(1.5));

        let mut xcdr2 = vec![0, 7, 0, 0, 7, 0, 0, 0];
        xcdr2.extend(1.5_f64.to_le_bytes());
        let mut reader = Reader::new(&xcdr2).unwrap();
        assert_eq!(reader.number(Primitive::U8), Ok(7.0));
        assert_eq!(reader.number(Primitive::F64), Ok(1.5));
    }

    #[test]
    fn big_endian_is_read_and_other_encapsulations_are_refused() {
        let mut reader = Reader::new(&[0, 0, 0, 0, 0, 0, 1, 2]).unwrap();
        assert_eq!(reader.number(Primitive::U32), Ok(258.0));
        assert_eq!(
            Reader::new(&[0, 3, 0, 0]).unwrap_err(),
            CdrError::Encapsulation(0, 3)
        );
    }

    #[test]
    fn a_claimed_length_past_the_end_is_an_error() {
        let mut reader = Reader::new(&[0, 1, 0, 0, 255, 255, 255, 255]).unwrap();
        let claimed = reader.count().unwrap();
        assert_eq!(reader.skip(8, claimed), Err(CdrError::End));
        assert_eq!(reader.skip(8, u64::MAX), Err(CdrError::End));
    }
}
