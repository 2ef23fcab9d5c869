//! Channels: what each carries, how it is decoded, or why it is not.

use super::{
    record::{Channel, Schema},
    roles::{Reading, plain_name},
};
use crate::{
    mapping::MessageMapping,
    raw::{
        json, protobuf,
        ros2::{
            definition::{self, Dialect},
            plan::{self, MOST_PADDING},
        },
    },
};
use std::sync::Arc;

/// How a channel is decoded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Decoder {
    /// What it tells, if anything that we use.
    pub(crate) reading: Option<Reading>,
    /// Takes what the role needs; passes over whole messages where there is no role.
    pub(crate) codec: Codec,
}

/// How messages are encoded, and which numbers of them are wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Codec {
    /// ROS 1 or ROS 2.
    Ros(plan::Plan),
    /// JSON.
    Json(json::Plan),
    /// Protobuf.
    Protobuf(protobuf::Plan),
}

/// Compiles the decoder of a channel; `mapped` says what types mean that are not known.
///
/// # Errors
/// A sentence that says why this channel cannot be decoded.
pub(crate) fn decoder(
    channel: &Channel,
    schema: Option<&OwnedSchema>,
    mapped: &[MessageMapping],
) -> Result<Decoder, String> {
    let name = schema.map_or_else(String::new, |s| s.name.clone());
    let reading = Reading::of(&name, mapped);
    let paths = reading.as_ref().map_or(&[][..], |r| &r.paths);
    let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
    let codec = Codec::compile(channel, schema, &paths)?;
    Ok(Decoder { reading, codec })
}

/// A schema that outlives the record it came in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct OwnedSchema {
    pub(crate) name: String,
    pub(crate) encoding: String,
    /// Shared by all channels that it describes.
    data: Arc<[u8]>,
}

impl From<Schema<'_>> for OwnedSchema {
    fn from(schema: Schema<'_>) -> Self {
        Self {
            name: schema.name,
            encoding: schema.encoding,
            data: schema.data.into(),
        }
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
    /// # Errors
    /// A sentence that says why this channel cannot be decoded.
    pub(crate) fn compile(
        channel: &Channel,
        schema: Option<&OwnedSchema>,
        wanted: &[&str],
    ) -> Result<Self, String> {
        let encoding = channel.encoding.as_str();
        let expected = match encoding {
            "cdr" => "ros2msg",
            "ros1" => "ros1msg",
            "protobuf" => "protobuf",
            "json" => return Ok(Self::Json(json::Plan::compile(wanted))),
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
            return Err(format!(
                "schema encoding is `{}`, expected `{expected}`",
                schema.encoding
            ));
        }
        if encoding == "protobuf" {
            let plan = protobuf::Plan::compile(&schema.name, &schema.data, wanted)?;
            return Ok(Self::Protobuf(plan));
        }
        let dialect = if encoding == "ros1" {
            Dialect::Ros1
        } else {
            Dialect::Ros2
        };
        let text = std::str::from_utf8(&schema.data).map_err(|_| "its schema is not text")?;
        let definitions = definition::parse(&schema.name, text, dialect)?;
        plan::Plan::compile(&definitions, wanted, dialect).map(Self::Ros)
    }

    /// Reads a message: `row` is filled, and given to `each` for every element of the wanted sequence.
    ///
    /// Slots of fields that are missing hold NaN.
    ///
    /// # Errors
    /// A sentence that says why the message does not fit.
    pub(crate) fn run(
        &self,
        message: &[u8],
        row: &mut Vec<f64>,
        each: &mut dyn FnMut(&[f64]),
    ) -> Result<(), String> {
        match self {
            Self::Ros(plan) => match plan.run(message, row, each) {
                Ok(_) => Ok(()),
                Err(e) => Err(e.to_string()),
            },
            Self::Json(plan) => plan.run(message, row, each),
            Self::Protobuf(plan) => plan.run(message, row, each),
        }
    }

    /// Whether a message fits as a whole; for a codec that wants nothing.
    ///
    /// # Errors
    /// A sentence that says why not.
    pub(crate) fn fits(&self, message: &[u8]) -> Result<(), String> {
        let misfit = |why: String| format!("its schema does not fit a message: {why}");
        match self {
            Self::Ros(plan) => match plan.run(message, &mut Vec::new(), &mut |_| {}) {
                Ok(left) if left <= MOST_PADDING => Ok(()),
                Ok(left) => Err(format!("its schema leaves {left} bytes of a message over")),
                Err(e) => Err(misfit(e.to_string())),
            },
            other => other
                .run(message, &mut Vec::new(), &mut |_| {})
                .map_err(misfit),
        }
    }
}

/// Whether two type names mean the same type.
pub(crate) fn same_type(a: &str, b: &str) -> bool {
    plain_name(a) == plain_name(b)
}
