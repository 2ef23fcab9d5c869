//! Records of the container, read without trusting a length that they claim.

use std::collections::BTreeMap;

/// Opcodes of the container.
pub(crate) mod op {
    pub(crate) use mcap::records::op::{
        CHANNEL, CHUNK, DATA_END, FOOTER, HEADER, MESSAGE, MESSAGE_INDEX, METADATA, SCHEMA,
        STATISTICS,
    };
    /// The lowest opcode of private records, which may hold anything.
    pub(crate) const FIRST_PRIVATE: u8 = 0x80;
    /// The highest opcode that the format has given out.
    pub(crate) const LAST_KNOWN: u8 = DATA_END;
}

/// Bytes before a record's content: opcode and length.
pub(crate) const HEAD: usize = 9;

/// Opcode and length of a record.
pub(crate) fn head_of([opcode, length @ ..]: [u8; HEAD]) -> (u8, u64) {
    (opcode, u64::from_le_bytes(length))
}

/// What a channel's bytes mean.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schema<'a> {
    /// Its number within the file.
    pub id: u16,
    /// The type's name.
    pub name: String,
    /// How it is written: `ros2msg`, `ros1msg`, `jsonschema`, `protobuf`, …
    pub encoding: String,
    /// Its text or descriptors.
    pub data: &'a [u8],
}

/// A stream of messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Its number within the file.
    pub id: u16,
    /// Number of its schema.
    pub schema_id: u16,
    /// As its publisher named it, such as `/odom`; several channels may share it.
    pub topic: String,
    /// How messages are encoded: `cdr`, `ros1`, `json`, `protobuf`, …
    pub encoding: String,
}

/// A message as it was recorded, not yet decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Message<'a> {
    /// Number of its channel.
    pub channel: u16,
    /// Time of receipt, in ns.
    pub log_ns: u64,
    /// Its bytes.
    pub data: &'a [u8],
}

/// Named text values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Metadata {
    /// What they are called together.
    pub name: String,
    /// The texts by name.
    pub values: BTreeMap<String, String>,
}

/// A record, as far as it says something about messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Record<'a> {
    /// The profile and the library that wrote the file.
    Header(String, String),
    /// What a channel's bytes mean.
    Schema(Schema<'a>),
    /// A stream of messages.
    Channel(Channel),
    /// What a channel carried at a time.
    Message(Message<'a>),
    /// Named texts.
    Metadata(Metadata),
    /// Of no interest here.
    Other,
}

/// Reads along the content of a record; `None` past its end.
#[derive(Debug)]
pub(crate) struct Fields<'a>(pub(crate) &'a [u8]);

impl<'a> Fields<'a> {
    fn bytes(&mut self, n: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(n)?;
        self.0 = rest;
        Some(head)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.bytes(N)?.first_chunk().copied()
    }

    pub(crate) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(crate) fn block(&mut self) -> Option<&'a [u8]> {
        let length = self.u32()?;
        self.bytes(usize::try_from(length).ok()?)
    }

    pub(crate) fn text(&mut self) -> Option<String> {
        self.block().map(|b| String::from_utf8_lossy(b).into_owned())
    }
}

/// Reads the content of a record; `None` where it does not hold what its opcode promises.
pub(crate) fn parse(opcode: u8, content: &[u8]) -> Option<Record<'_>> {
    let mut fields = Fields(content);
    Some(match opcode {
        op::HEADER => Record::Header(fields.text()?, fields.text()?),
        op::SCHEMA => Record::Schema(Schema {
            id: fields.u16()?,
            name: fields.text()?,
            encoding: fields.text()?,
            data: fields.block()?,
        }),
        op::CHANNEL => Record::Channel(Channel {
            id: fields.u16()?,
            schema_id: fields.u16()?,
            topic: fields.text()?,
            encoding: fields.text()?,
        }),
        op::MESSAGE => {
            let channel = fields.u16()?;
            fields.u32()?;
            let log_ns = fields.u64()?;
            fields.u64()?;
            Record::Message(Message { channel, log_ns, data: fields.0 })
        }
        op::METADATA => {
            let name = fields.text()?;
            let mut pairs = Fields(fields.block()?);
            let mut values = BTreeMap::new();
            while !pairs.0.is_empty() {
                values.insert(pairs.text()?, pairs.text()?);
            }
            Record::Metadata(Metadata { name, values })
        }
        _ => Record::Other,
    })
}

/// Whether a record that is not read could be what its opcode says, by the start of its content.
pub(crate) fn is_plausible(opcode: u8, start: &[u8], length: u64) -> bool {
    match opcode {
        op::MESSAGE_INDEX => {
            let mut fields = Fields(start);
            let array = fields.u16().and_then(|_| fields.u32());
            array.is_some_and(|a| a % 16 == 0 && length >= 6 + u64::from(a))
        }
        op::FOOTER => length >= 20,
        op::FIRST_PRIVATE.. => true,
        _ => length >= 4,
    }
}

/// What a file says of itself: its footer, its statistics, the end of its data; none where that cannot be read.
pub(crate) fn account(opcode: u8, content: &[u8]) -> Option<mcap::records::Record<'_>> {
    mcap::parse_record(opcode, content).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claimed_length_past_the_end_gives_nothing() {
        assert_eq!(parse(op::SCHEMA, &[1, 0, 255, 255, 255, 255, b'x', 0, 0]), None);
        assert_eq!(parse(op::MESSAGE, &[0; 10]), None);
        assert_eq!(parse(op::FOOTER, &[]), Some(Record::Other));
    }

    #[test]
    fn every_kind_of_record_is_read_and_none_without_its_end() {
        let text = |t: &str| [&(t.len() as u32).to_le_bytes(), t.as_bytes()].concat();
        let header = [text("ros2"), text("lib")].concat();
        let schema = [&[7, 1][..], &text("T"), &text("ros2msg"), &text("x y")].concat();
        let channel = [&[8, 1, 7, 1][..], &text("/a"), &text("cdr")].concat();
        let pairs = [text("k"), text("v"), text("a"), text("b")].concat();
        let metadata = [text("n"), (pairs.len() as u32).to_le_bytes().to_vec(), pairs].concat();
        let message = [&[8, 1][..], &[9; 4], &5_u64.to_le_bytes(), &[6; 8], b"data"].concat();
        let values = [("k", "v"), ("a", "b")].map(|(k, v)| (k.to_owned(), v.to_owned()));
        let cases = [
            (op::HEADER, header, Record::Header("ros2".to_owned(), "lib".to_owned())),
            (
                op::SCHEMA,
                schema,
                Record::Schema(Schema {
                    id: 263,
                    name: "T".to_owned(),
                    encoding: "ros2msg".to_owned(),
                    data: b"x y",
                }),
            ),
            (
                op::CHANNEL,
                channel,
                Record::Channel(Channel {
                    id: 264,
                    schema_id: 263,
                    topic: "/a".to_owned(),
                    encoding: "cdr".to_owned(),
                }),
            ),
            (
                op::METADATA,
                metadata,
                Record::Metadata(Metadata { name: "n".to_owned(), values: BTreeMap::from(values) }),
            ),
        ];
        for (opcode, bytes, expected) in &cases {
            assert_eq!(parse(*opcode, bytes).as_ref(), Some(expected));
            assert!((0..bytes.len()).all(|n| parse(*opcode, &bytes[..n]).is_none()));
        }
        let Some(Record::Message(found)) = parse(op::MESSAGE, &message) else {
            panic!("a message");
        };
        assert_eq!((found.channel, found.log_ns, found.data), (264, 5, &b"data"[..]));
        assert!((0..22).all(|n| parse(op::MESSAGE, &message[..n]).is_none()));
        assert!(
            matches!(parse(op::MESSAGE, &message[..22]), Some(Record::Message(m)) if m.data.is_empty())
        );
    }

    #[test]
    fn a_record_that_is_not_read_is_plausible_by_its_length() {
        let index = |array: u32| [&[1, 0][..], &array.to_le_bytes()].concat();
        for (array, length, plausible) in [
            (0, 6, true),
            (32, 38, true),
            (32, 40, true),
            (32, 37, false),
            (33, 100, false),
            (16, 16, false),
        ] {
            let found = is_plausible(op::MESSAGE_INDEX, &index(array), length);
            assert_eq!(found, plausible, "{array} in {length}");
        }
        assert!(!is_plausible(op::MESSAGE_INDEX, &[1, 0, 0], 6));
        assert!(is_plausible(op::FOOTER, &[], 20) && !is_plausible(op::FOOTER, &[], 19));
        assert!(is_plausible(op::DATA_END, &[], 4) && !is_plausible(op::DATA_END, &[], 3));
    }
}
