//! How the messages of a channel are decoded, or why they are not.

use crate::{
    json, protobuf,
    record::{Channel, Schema},
    ros2::{
        definition::{self, Dialect, short_name},
        plan::{self, MOST_PADDING},
    },
};
use std::sync::Arc;

/// How messages are encoded, and which numbers of them are wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Codec(Plan);

#[derive(Debug, Clone, PartialEq)]
enum Plan {
    /// ROS 1 or ROS 2.
    Ros(plan::Plan),
    Json(json::Plan),
    Protobuf(protobuf::Plan),
}

/// A schema that outlives the record it came in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnedSchema {
    /// The type's name.
    pub name: String,
    /// How it is written: `ros2msg`, `protobuf`, …
    pub encoding: String,
    /// Shared by all channels that it describes.
    data: Arc<[u8]>,
}

impl From<Schema<'_>> for OwnedSchema {
    fn from(schema: Schema<'_>) -> Self {
        Self { name: schema.name, encoding: schema.encoding, data: schema.data.into() }
    }
}

impl OwnedSchema {
    /// Whether another schema has the same text.
    pub(crate) fn has_data(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.data, &other.data) || self.data == other.data
    }
}

impl Codec {
    /// Compiles the decoding of a channel for the numbers at some paths.
    ///
    /// Paths go down by points: `angular_velocity.z`. `objects[].id` gives a row for each element, `[0]` is one element of an array,
    /// `a|b` the one of two that there is, and a path that ends in `?` may be missing. Booleans are 0 and 1. A path to a text ends in `#`
    /// and gives its [`crate::name_number`].
    ///
    /// # Errors
    /// A sentence that says why this channel cannot be decoded.
    pub fn compile(
        channel: &Channel,
        schema: Option<&OwnedSchema>,
        wanted: &[&str],
    ) -> Result<Self, String> {
        let encoding = channel.encoding.as_str();
        let expected = match encoding {
            "cdr" => "ros2msg",
            "ros1" => "ros1msg",
            "protobuf" => "protobuf",
            "json" => return Ok(Self(Plan::Json(json::Plan::compile(wanted)))),
            _ => {
                return Err(format!(
                    "message encoding is `{encoding}`, expected cdr, ros1, json or protobuf"
                ));
            }
        };
        let Some(schema) = schema else {
            return Err(format!("its schema {} is missing", channel.schema_id));
        };
        if schema.encoding != expected {
            return Err(format!("schema encoding is `{}`, expected `{expected}`", schema.encoding));
        }
        if encoding == "protobuf" {
            let plan = protobuf::Plan::compile(&schema.name, &schema.data, wanted)?;
            return Ok(Self(Plan::Protobuf(plan)));
        }
        let dialect = if encoding == "ros1" { Dialect::Ros1 } else { Dialect::Ros2 };
        let text = std::str::from_utf8(&schema.data).map_err(|_| "its schema is not text")?;
        let definitions = definition::parse(&schema.name, text, dialect)?;
        plan::Plan::compile(&definitions, wanted, dialect).map(|plan| Self(Plan::Ros(plan)))
    }

    /// Reads a message: `row` is filled, and given to `each` for every element of the wanted sequence.
    ///
    /// Slots of fields that are missing hold NaN.
    ///
    /// # Errors
    /// A sentence that says why the message does not fit.
    pub fn run(
        &self,
        message: &[u8],
        row: &mut Vec<f64>,
        each: &mut dyn FnMut(&[f64]),
    ) -> Result<(), String> {
        match &self.0 {
            Plan::Ros(plan) => match plan.run(message, row, each) {
                Ok(_) => Ok(()),
                Err(e) => Err(e.to_string()),
            },
            Plan::Json(plan) => plan.run(message, row, each),
            Plan::Protobuf(plan) => plan.run(message, row, each),
        }
    }

    /// Whether a message fits as a whole; for a codec that wants nothing.
    ///
    /// # Errors
    /// A sentence that says why not.
    pub fn fits(&self, message: &[u8]) -> Result<(), String> {
        let misfit = |why: String| format!("its schema does not fit a message: {why}");
        match &self.0 {
            Plan::Ros(plan) => match plan.run(message, &mut Vec::new(), &mut |_| {}) {
                Ok(left) if left <= MOST_PADDING => Ok(()),
                Ok(left) => Err(format!("its schema leaves {left} bytes of a message over")),
                Err(e) => Err(misfit(e.to_string())),
            },
            Plan::Json(_) | Plan::Protobuf(_) => {
                self.run(message, &mut Vec::new(), &mut |_| {}).map_err(misfit)
            }
        }
    }
}

/// `pkg/Type`, whether a name is written with `/msg/`, with a point or plain.
pub fn plain_name(name: &str) -> String {
    short_name(name).replace('.', "/")
}

/// Whether two type names mean the same type.
pub(crate) fn same_type(a: &str, b: &str) -> bool {
    plain_name(a) == plain_name(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    fn channel(encoding: &str) -> Channel {
        Channel { id: 1, schema_id: 3, topic: "/a".to_owned(), encoding: encoding.to_owned() }
    }

    fn schema(encoding: &str, text: &[u8]) -> OwnedSchema {
        OwnedSchema::from(Schema {
            id: 3,
            name: "lab/msg/X".to_owned(),
            encoding: encoding.to_owned(),
            data: text,
        })
    }

    #[test]
    fn each_encoding_is_read_by_its_own_schema() {
        let text = b"uint8 a\nfloat64 b";
        for (encoding, of, message) in [
            (
                "cdr",
                "ros2msg",
                [&[0, 1, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0][..], &2.5_f64.to_le_bytes()].concat(),
            ),
            ("ros1", "ros1msg", [&[5][..], &2.5_f64.to_le_bytes()].concat()),
            ("json", "jsonschema", b"{\"b\":2.5}".to_vec()),
        ] {
            let codec =
                Codec::compile(&channel(encoding), Some(&schema(of, text)), &["b"]).unwrap();
            let mut row = Vec::new();
            codec.run(&message, &mut row, &mut |_| panic!("no rows")).unwrap();
            assert_eq!(row, [2.5], "{encoding}");
            assert!(codec.run(&message[..message.len() - 1], &mut row, &mut |_| {}).is_err());
            if encoding == "json" {
                continue;
            }
            let why = |schema: Option<&OwnedSchema>| {
                Codec::compile(&channel(encoding), schema, &["b"]).unwrap_err()
            };
            assert_eq!(why(None), "its schema 3 is missing");
            let other = why(Some(&schema("ros3msg", text)));
            assert_eq!(other, format!("schema encoding is `ros3msg`, expected `{of}`"));
            assert_eq!(why(Some(&schema(of, &[0xff, 0xfe]))), "its schema is not text");
        }
        let why = Codec::compile(&channel("avro"), Some(&schema("avro", b"{}")), &[]).unwrap_err();
        assert_eq!(why, "message encoding is `avro`, expected cdr, ros1, json or protobuf");
    }

    #[test]
    fn a_schema_fits_a_message_that_it_leaves_no_more_than_padding_of() {
        let codec =
            Codec::compile(&channel("cdr"), Some(&schema("ros2msg", b"uint8 a")), &[]).unwrap();
        let message = |n: usize| [&[0, 1, 0, 0][..], &vec![0; 1 + n]].concat();
        assert_eq!(codec.fits(&message(0)), Ok(()));
        assert_eq!(codec.fits(&message(MOST_PADDING)), Ok(()));
        let over = codec.fits(&message(MOST_PADDING + 1)).unwrap_err();
        assert_eq!(over, "its schema leaves 8 bytes of a message over");
        let short = codec.fits(&message(0)[..4]).unwrap_err();
        assert_eq!(short, "its schema does not fit a message: its bytes end early");
        let json = Codec::compile(&channel("json"), None, &[]).unwrap();
        assert_eq!(json.fits(b"{}"), Ok(()));
        assert!(
            json.fits(b"{")
                .unwrap_err()
                .starts_with("its schema does not fit a message: it is no JSON")
        );
    }

    #[test]
    fn a_type_is_the_same_however_its_name_is_written() {
        assert_eq!(plain_name("lab.Cars"), "lab/Cars");
        assert!(same_type("lab/msg/Cars", "lab/Cars") && same_type("lab.Cars", "lab/msg/Cars"));
        assert!(!same_type("lab/Cars", "lab/Car"));
        let (a, b) = (schema("x", b"1"), schema("x", b"2"));
        assert!(a.has_data(&a.clone()) && a.has_data(&schema("y", b"1")) && !a.has_data(&b));
    }
}
